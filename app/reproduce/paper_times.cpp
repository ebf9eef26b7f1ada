// SPDX-License-Identifier: Apache-2.0
// Experiment 5: the paper's Tables 2 and 3 beside ours.
#include <algorithm>

#include "app/output/run_record.hpp"
#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/paper_times.hpp"

namespace sunder::app::reproduce {
namespace {

using Times = PaperTimes;

std::string shown(const std::optional<double>& ms) { return ms ? rounded(*ms, 3) : "-"; }

std::optional<double> sum(const Times& t) {
  if (!t.solve || !t.update) return std::nullopt;
  return *t.solve + *t.update;
}

DataTable table_2(const std::vector<Times>& t) {
  return {"table-2",
          "One reconstruction. The paper: s, 3.2 GHz Xeon, as printed. Ours: ms, median over the "
          "steps in which something broke.",
          {"", "paper A [s]", "paper B expansion [s]", "paper B expansion + pressure [s]",
           "ours A [ms]", "ours B expansion [ms]", "ours B expansion + pressure [ms]"},
          {{"stiffness matrix", "1.43", "1.40", "1.41", "-", "-", "-"},
           {"stress-displacement matrix", "9.37", "9.33", "9.70", "-", "-", "-"},
           {"inverse matrix (ours: update of what carries the damage)", "55.2", "54.8", "56.7",
            shown(t[0].update), shown(t[1].update), shown(t[2].update)},
           {"element update (ours: displacement anew)", "3.44", "3.48", "3.62", shown(t[0].solve),
            shown(t[1].solve), shown(t[2].solve)},
           {"total", "69.4", "69.0", "71.5", shown(sum(t[0])), shown(sum(t[1])), shown(sum(t[2]))},
           {"once, before the first frame: matrix, factor, inverse", "", "", "",
            shown(t[0].prepare), shown(t[1].prepare), shown(t[2].prepare)}},
          true};
}

DataTable table_3(const std::vector<Times>& t) {
  return {
      "table-3",
      "Deciding which element ruptures. The paper: s. Ours: ms, median.",
      {"", "paper A [s]", "paper B [s]", "ours A [ms]", "ours B formula [ms]", "ours B field [ms]"},
      {{"stress distribution", "", "0.03", shown(t[0].stress), shown(t[1].stress),
        shown(t[3].stress)},
       {"stress intensity, comparison, choice of elements", "", "2.83", shown(t[0].decide),
        shown(t[1].decide), shown(t[3].decide)},
       {"in all", "0.03", "2.86", shown(*t[0].stress + *t[0].decide),
        shown(*t[1].stress + *t[1].decide), shown(*t[3].stress + *t[3].decide)}},
      true};
}

}  // namespace

std::vector<PaperColumn> paper_columns() {
  return {
      {"A", {"board-pull-a", {}, nullptr, 1, {}}},
      {"B, expansion", {"notch-b", {both_k()[0].override}, nullptr, 1, {}}},
      {"B, expansion + pressure", {"pressure-balanced", {both_k()[0].override}, nullptr, 1, {}}},
      {"B, field", {"notch-b", {both_k()[1].override}, nullptr, 1, {}}}};
}

PaperTimes measure_paper_times(const Laboratory& lab, const RunPlan& plan) {
  const RunResult run = lab.run(plan);
  PaperTimes times{run.prepare_ms, {}, {}, {}, {}};
  const auto median = [&](double StageTimes::*stage, bool per_event) -> std::optional<double> {
    std::vector<double> values;
    for (std::size_t i = 0; i < run.steps.size(); ++i) {
      const int count = per_event ? run.steps[i].events : run.frames[i];
      if (run.steps[i].events > 0 && count > 0) values.push_back(run.steps[i].times.*stage / count);
    }
    if (values.empty()) return std::nullopt;
    return statistics(values).median;
  };
  times.solve = median(&StageTimes::solve, false);
  times.stress = median(&StageTimes::stress, false);
  times.decide = median(&StageTimes::decide, false);
  times.update = median(&StageTimes::update, true);
  return times;
}

Chapter paper_times(const Laboratory& lab) {
  lab.tell("experiment 5: times");
  Chapter chapter{
      "experiment-5",
      "Experiment 5 (Tables 2 and 3): times",
      "Scenes board-pull-a (A), notch-b (B, expansion) and pressure-balanced (B, "
      "expansion + pressure) with 1954 tetrahedra. Measured in this run, with whatever "
      "else this machine did meanwhile. Nothing here rebuilds the stiffness matrix, the "
      "stress-displacement matrix or the inverse: the first are made once, the inverse "
      "is never overwritten and a fracture is a correction of low rank on top of it.",
      {},
      {},
      {},
      {}};
  std::vector<Times> times;
  for (const PaperColumn& column : paper_columns()) {
    times.push_back(measure_paper_times(lab, column.plan));
  }
  if (std::any_of(times.begin(), times.end(), [](const Times& t) { return !t.stress; })) {
    chapter.findings.push_back("A run broke nothing: there is no time of a fracture.");
    return chapter;
  }
  const std::string words = "the calculation time required for the rupture model to run";
  for (const auto& [by, t] : {std::pair{"formula K", times[1]}, std::pair{"field K", times[3]}}) {
    chapter.statements.push_back(
        {"5a", "Deciding which element ruptures takes longer with B than with A.", by,
         judge_takes_longer(t.decide, times[0].decide, "decision, B", "decision, A"), words});
    chapter.statements.push_back(
        {"5b", "The reconstruction takes longer than the decision.", by,
         judge_takes_longer(sum(t), t.decide, "reconstruction", "decision"), words});
  }
  const std::string equal = "One reconstruction takes A and B the same time (Table 2's totals).";
  chapter.statements.push_back(
      {"5c", equal, "formula K",
       judge_equal_totals(std::vector<Figure>{{"A [ms]", sum(times[0])},
                                              {"B, expansion [ms]", sum(times[1])},
                                              {"B, expansion + pressure [ms]", sum(times[2])}}),
       words});
  chapter.statements.push_back(
      {"5c", equal, "field K",
       judge_equal_totals(
           std::vector<Figure>{{"A [ms]", sum(times[0])}, {"B, expansion [ms]", sum(times[3])}}),
       words});
  chapter.tables = {table_2(times), table_3(times)};
  return chapter;
}

}  // namespace sunder::app::reproduce
