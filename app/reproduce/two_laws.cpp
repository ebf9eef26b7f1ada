// SPDX-License-Identifier: Apache-2.0
// The paper's experiments by a law of finite rotations: how far the linear law is off, and which
// statements survive.
#include <algorithm>
#include <iterator>

#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"
#include "app/reproduce/models.hpp"
#include "app/reproduce/statements.hpp"
#include "app/reproduce/survival.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kPull = 98, kNotchPull = 42;  // N, of scenes board-pull-b and notch-b
constexpr int kMostBroken = 40;                // the last picture of Fig. 4
constexpr double kFollow = 2;                  // times the scene's forces
constexpr int kFollowSteps = 45;

/// One experiment by two laws.
class TwoLabs {
 public:
  TwoLabs(const Laboratory& lab)
      : linear(lab.with_law(MaterialLaw::linear)), finite(lab.with_law(MaterialLaw::corotated)) {}
  const Laboratory linear, finite;

  /// `make(lab)` gives statements; those of the linear law lead.
  template <typename Make>
  void compare(const Make& make) {
    const std::vector<Statement> by_linear = make(linear);
    const std::size_t before = finite.notes().size();
    pair(by_linear, make(finite), before);
  }
  void pair(const std::vector<Statement>& by_linear, const std::vector<Statement>& by_finite,
            std::size_t before) {
    for (std::size_t i = 0; i < by_linear.size(); ++i) {
      TwoVerdicts both{by_linear[i], by_finite[i], {}};
      for (std::size_t n = before; n < finite.notes().size(); ++n) {
        const RunNote& note = finite.notes()[n];
        if (note.k.empty() || note.k == both.linear.by) both.runs.push_back(note);
      }
      all.push_back(std::move(both));
    }
  }
  std::vector<TwoVerdicts> all;
};

/// The intact board, pulled so hard; none where it finds no equilibrium.
struct Pulled {
  std::optional<double> moved, strain, rotation;  ///< largest: mm, %, deg
};

Pulled pulled(const Laboratory& lab, double force) {
  const RunResult run = lab.run({"board-pull-b",
                                 {"time.steps=1", "instrument.0.ramp=[0,1]", "fracture.model=none"},
                                 nullptr,
                                 force / kPull,
                                 {}});
  if (run.steps.empty()) return {};
  double moved = 0;
  for (const Vec3& u : run.last.displacement) moved = std::max(moved, u.norm());
  Pulled found{moved, std::nullopt, std::nullopt};
  if (const auto& deformation = run.steps.back().deformation) {
    found.strain = 100 * deformation->strain;
    found.rotation = deformation->rotation_deg;
  }
  return found;
}

/// Where the laws part while nothing is torn.
DataTable displacement_table(const TwoLabs& labs) {
  DataTable table{"two-laws-displacement",
                  "The board of experiment 1, intact, pulled at its corner: where small strain and "
                  "finite rotations part. Strain: largest stretch less 1 (linear: of the strain "
                  "tensor).",
                  {"pull [N]", "largest displacement by linear [mm]", "corotated [mm]",
                   "linear over corotated [%]", "largest strain by linear [%]", "corotated [%]",
                   "largest rotation by linear [deg]", "corotated [deg]"},
                  {},
                  true,
                  true};
  for (const double force : {7.0, 11.0, 22.0, 36.0, 60.0, 84.0}) {
    const Pulled a = pulled(labs.linear, force), b = pulled(labs.finite, force);
    std::optional<double> over;
    if (a.moved && b.moved) over = 100 * (*a.moved / *b.moved - 1);
    table.rows.push_back({cell(force), cell(a.moved), cell(b.moved), cell(over), cell(a.strain),
                          cell(b.strain), cell(a.rotation), cell(b.rotation)});
  }
  return table;
}

/// Load and place of what breaks or grows first.
void add_first(const TwoLabs& labs, const std::string& what, const std::string& scene,
               const std::vector<std::string>& overrides, bool growth, DataTable& table) {
  const RunPlan plan{scene, overrides, nullptr, 1, {}};
  std::vector<std::string> forces, elements, places;
  for (const Laboratory* lab : {&labs.linear, &labs.finite}) {
    const auto first = growth ? critical_growth(*lab, plan) : critical_load(*lab, plan);
    forces.push_back(first ? cell(first->factor * pull_of(*lab, scene)) : "");
    elements.push_back(first ? std::to_string(first->element) : "");
    places.push_back(first ? rounded(first->place.x(), 3) + ", " + rounded(first->place.y(), 3) +
                                 ", " + rounded(first->place.z(), 2)
                           : "none");
  }
  table.rows.push_back(
      {what, scene, forces[0], forces[1], elements[0], elements[1], places[0], places[1]});
}

DataTable first_table(const TwoLabs& labs, bool quick) {
  DataTable table{"two-laws-first-rupture",
                  "What breaks first, under which pull, and where (its centroid, mm).",
                  {"", "scene", "pull by linear [N]", "corotated [N]", "element by linear",
                   "corotated", "place by linear", "corotated"},
                  {},
                  true,
                  true};
  add_first(labs, "first rupture", "board-pull-b", {}, false, table);
  if (quick) return table;
  add_first(labs, "first rupture", "board-pull-two-points-b", {}, false, table);
  add_first(labs, "first rupture", "notch-a", {}, false, table);
  for (const KChoice& k : both_k())
    add_first(labs, "first growth, " + k.name, "notch-b", {k.override}, true, table);
  return table;
}

/// K of the resting notch over load, none may break.
std::vector<std::string> k_over_load(const Laboratory& lab, const KChoice& k, double length) {
  RunPlan plan =
      notched(lab, kCoarseNotch, length,
              {k.override, "time.steps=8", "instrument.0.ramp=[0,1]", "material.upper.yield=1e6",
               "material.lower.yield=1e6", "material.preset-crack.yield=1e6"});
  plan.load = 40 / kNotchPull;
  plan.tips = true;
  std::vector<std::string> cells;
  for (const auto& tips : lab.run(plan).tips) {
    if (tips.empty())
      cells.emplace_back();
    else
      cells.push_back(tips.front().k ? cell(tips.front().k) : std::string(tips.front().field_note));
  }
  return cells;
}

DataTable k_table(const TwoLabs& labs) {
  DataTable table{"two-laws-k",
                  "K of the notch at rest [MPa sqrt(mm)] by load and by the notch's length, "
                  "elements of 3.939 mm. By the field beyond small strain, law corotated: "
                  "sqrt(J E').",
                  {"notch [mm]", "pull [N]", "formula K by linear", "formula K by corotated",
                   "field K by linear", "field K by corotated"},
                  {},
                  true,
                  true};
  for (const double length : {4.04, 8.0, 16.0}) {
    std::vector<std::vector<std::string>> columns;
    for (const KChoice& k : both_k())
      for (const Laboratory* lab : {&labs.linear, &labs.finite})
        columns.push_back(k_over_load(*lab, k, length));
    for (const std::size_t step : {0U, 1U, 3U, 7U}) {
      std::vector<std::string> row = {cell(length), cell(5.0 * static_cast<double>(step + 1))};
      for (const auto& column : columns)
        row.push_back(step < column.size() ? column[step] : "the run ends before it");
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

/// A scene's run by the other law goes on where the linear law's run has ended: by its own first
/// rupture, the load of the scene may be too small for any growth.
RunPlan followed(const Laboratory& lab, RunPlan plan, const RunResult& linear) {
  const int broken = static_cast<int>(linear.fractures().size());
  plan.until = std::clamp(broken, 1, kMostBroken);
  plan.load = kFollow;
  const std::size_t tools = lab.scene(plan).instruments.size();
  for (std::size_t i = 0; i < tools; ++i)
    plan.overrides.push_back("instrument." + std::to_string(i) + ".ramp=[0,1]");
  plan.overrides.push_back("time.steps=" + std::to_string(kFollowSteps));
  return plan;
}

std::vector<Statement> of_experiment_1(const std::vector<Model>& models) {
  std::vector<Statement> statements = pulled_statements(models);
  for (std::size_t i = 0; i < both_k().size(); ++i)
    statements.push_back(up_then_down(models[i + 1].run, both_k()[i]));
  return statements;
}

void compare_experiment_1(TwoLabs& labs) {
  labs.linear.tell("finite rotations: experiment 1");
  const std::vector<Model> by_linear = run_models(labs.linear, "board-pull");
  const std::size_t before = labs.finite.notes().size();
  std::vector<Model> by_finite;
  for (std::size_t i = 0; i < by_linear.size(); ++i) {
    RunPlan plan{i == 0 ? "board-pull-a" : "board-pull-b", {}, nullptr, 1, kSnapshots};
    if (i > 0) plan.overrides.push_back(both_k()[i - 1].override);
    by_finite.push_back(
        {by_linear[i].name, labs.finite.run(followed(labs.finite, plan, by_linear[i].run))});
  }
  labs.pair(of_experiment_1(by_linear), of_experiment_1(by_finite), before);
}

void compare_several(TwoLabs& labs, const KChoice& k) {
  labs.compare([&](const Laboratory& lab) { return std::vector{growth_first(lab, k)}; });
  const RunPlan plan{"two-instruments", {k.override}, nullptr, 1, {}};
  const RunResult by_linear = labs.linear.run(plan);
  const std::size_t before = labs.finite.notes().size();
  const RunResult by_finite = labs.finite.run(followed(labs.finite, plan, by_linear));
  labs.pair({several_at_once(by_linear, k)}, {several_at_once(by_finite, k)}, before);
}

void compare_notch(TwoLabs& labs, const KChoice& k) {
  labs.compare([&](const Laboratory& lab) {
    return std::vector{tears_before_a(lab, k, critical_force(lab, "notch-a", {}, false))};
  });
}

void compare_all(TwoLabs& labs) {
  compare_experiment_1(labs);
  for (const KChoice& k : both_k()) {
    labs.linear.tell("finite rotations: experiment 2, " + k.name);
    compare_notch(labs, k);
    labs.linear.tell("finite rotations: experiment 3, " + k.name);
    labs.compare(
        [&](const Laboratory& lab) { return next_rupture_statements(lab, k, kCoarseNotch); });
    labs.linear.tell("finite rotations: experiment 4, " + k.name);
    labs.compare([&](const Laboratory& lab) { return side_statements(lab, k); });
    labs.linear.tell("finite rotations: several cracks, length of the notch, " + k.name);
    compare_several(labs, k);
    labs.compare([&](const Laboratory& lab) {
      std::vector<std::vector<std::string>> rows;
      return std::vector{final_lengths(lab, k, kCoarseNotch, rows)};
    });
  }
  std::stable_sort(
      labs.all.begin(), labs.all.end(),
      [](const TwoVerdicts& a, const TwoVerdicts& b) { return a.linear.id < b.linear.id; });
}

/// Runs that found no equilibrium, in the words of the run.
std::vector<std::string> failures(const std::vector<RunNote>& notes) {
  std::vector<std::string> sentences;
  for (const RunNote& note : notes)
    if (!note.failure.empty())
      sentences.push_back(
          "Scene " + note.scene + (note.k.empty() ? "" : ", " + note.k) + ", after " +
          std::to_string(note.steps) + " of " + counted(note.all, "step") + " and " +
          counted(note.fractures, "fracture") + ", at " + rounded(note.load, 3) +
          " times the scene's forces, ends with exit code 5: " + note.failure + ".");
  return sentences;
}

}  // namespace

Chapter two_laws(const Laboratory& lab, const Effort& effort) {
  lab.tell("finite rotations: where the laws part");
  Chapter chapter{
      "finite-rotations",
      "Which statements survive finite rotations",
      "The same experiments with all materials of law corotated (small strain about each element's "
      "own rotation), stress cauchy, on backend cpu. Statements 1 and 6b: the scene's forces rise "
      "to their double in 45 steps, until as many elements broke as by the linear law, at most 40. "
      "2 to 4: the load of the first rupture or growth, found by trials. 3 and 7a in elements of "
      "3.939 mm, by both laws; by formula K 3 knows no law: Eq. 4 is made of forces and the "
      "undeformed crack. 5 asks for times, not for a law. Quick version: 2b by formula K alone.",
      {},
      {},
      {},
      {}};
  TwoLabs labs(lab);
  chapter.tables.push_back(displacement_table(labs));
  chapter.tables.push_back(first_table(labs, effort.quick));
  if (effort.quick) {
    compare_notch(labs, both_k().front());
  } else {
    chapter.tables.push_back(k_table(labs));
    compare_all(labs);
  }
  chapter.tables.push_back(survival_table(labs.all));
  chapter.tables.push_back(figures_table(labs.all));
  chapter.tables.push_back(runs_table(labs.finite.notes()));
  chapter.findings = survival_findings(labs.all);
  std::ranges::copy(failures(labs.finite.notes()), std::back_inserter(chapter.findings));
  return chapter;
}

}  // namespace sunder::app::reproduce
