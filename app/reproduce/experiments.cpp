// SPDX-License-Identifier: Apache-2.0
// Experiments 2 and 4.
#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"
#include "app/reproduce/models.hpp"
#include "app/reproduce/statements.hpp"

namespace sunder::app::reproduce {

const std::vector<KChoice>& both_k() {
  static const std::vector<KChoice> choices = {{"formula K", "fracture.sif=formula"},
                                               {"field K", "fracture.sif=field"}};
  return choices;
}

namespace {

/// Fig. 5(a) is the un-notched board (experiment 1); this is what the notch's crack does.
std::string notch_turns(const KChoice& k, const RunResult& run) {
  const GrownPath path = preset_path(run);
  if (path.points.size() < 2) return k.name + ": the notch's crack does not grow.";
  const Turns turns = turns_of(path);
  return k.name + ": from the notch the crack runs " + rounded(turns.rise_deg, 3) +
         " deg to its highest point, " + rounded(turns.highest, 3) + " mm up, and " +
         rounded(turns.fall_deg, 3) +
         " deg from there. Up then down (2a) is judged on the un-notched board, which Fig. 5(a) "
         "shows.";
}

}  // namespace

Statement tears_before_a(const Laboratory& lab, const KChoice& k, const std::optional<double>& a) {
  return {"2b", "On the notched board B starts to tear at a lower load than A.", k.name,
          judge_lower_force(critical_force(lab, "notch-b", {k.override}, true), a,
                            "critical force, B", "critical force, A"),
          "crack progression in a silicon rubber"};
}

Chapter notched_board(const Laboratory& lab) {
  lab.tell("experiment 2: notched board");
  const std::vector<Model> models = run_models(lab, "notch");
  Chapter chapter{"experiment-2",
                  "Experiment 2 (Fig. 5(b)): small notch in the middle of the right edge",
                  "Scenes notch-a and notch-b: notch of 4.04 mm at the border of the two tissues, "
                  "42 N at the lower right corner. The paper's specimen is silicone rubber.",
                  {},
                  {},
                  {},
                  {}};
  const auto a = critical_force(lab, "notch-a", {}, false);
  for (std::size_t i = 1; i < models.size(); ++i) {
    const KChoice& k = both_k()[i - 1];
    chapter.statements.push_back(tears_before_a(lab, k, a));
    chapter.findings.push_back(notch_turns(k, models[i].run));
  }
  const std::vector<Model> cracks(models.begin() + 1, models.end());
  chapter.tables = {path_table("experiment-2-paths", cracks),
                    events_table("experiment-2-fractures", models)};
  chapter.drawings.push_back({"experiment-2",
                              "Stress and destroyed elements after 5, 10, 20 and 40 fractures "
                              "behind the notch.",
                              picture("Notched board pulled at its lower right corner", models)});
  chapter.drawings.push_back(chart_drawing("experiment-2-path",
                                           "Path of the crack, the notch's tip at 0.",
                                           path_series(cracks), kPathAxes));
  return chapter;
}

std::vector<Statement> side_statements(const Laboratory& lab, const KChoice& k) {
  const std::string words = "the effect of rupture direction related to pressures";
  std::vector<Statement> statements;
  const std::vector<std::string> by = {k.override};
  const auto critical = [&](const std::string& scene) {
    return critical_growth(lab, {scene, by, nullptr, 1, {}});
  };
  const auto upper = critical("pressure-upper"), balanced = critical("pressure-balanced"),
             under = critical("pressure-under"), none = critical("notch-b");
  const auto angle = [](const std::optional<CriticalLoad>& c) {
    return c ? std::optional<double>(c->rise_deg) : std::nullopt;
  };
  const auto force = [&](const std::optional<CriticalLoad>& c, const std::string& scene) {
    return c ? std::optional<double>(c->factor * pull_of(lab, scene)) : std::nullopt;
  };
  const auto f_none = force(none, "notch-b");
  statements.push_back(
      {"4a",
       "The crack goes up, straight and down with pressure on the upper face, on both and "
       "on the under face.",
       k.name, judge_sides({angle(upper), angle(balanced), angle(under)}), words});
  statements.push_back(
      {"4b", "Balanced pressure tears earlier than none.", k.name,
       judge_lower_force(force(balanced, "pressure-balanced"), f_none,
                         "critical pull, balanced pressure", "critical pull, no pressure"),
       words});
  statements.push_back(
      {"4c", "Pressure with the expansion raises the stress, against it lowers it.", k.name,
       judge_side_forces({force(under, "pressure-under"), f_none, force(upper, "pressure-upper")}),
       words});
  return statements;
}

Chapter pressure_side(const Laboratory& lab) {
  lab.tell("experiment 4: pressure on one face and on both");
  Chapter chapter{
      "experiment-4",
      "Experiment 4 (Fig. 7): pressure on the upper face, on both, on the under face",
      "Scenes pressure-upper, pressure-balanced, pressure-under: 62 N at the lower right "
      "corner and 10 N on a face at x = 48 mm, growing together. Upwards is positive.",
      {},
      {},
      {},
      {}};
  const std::vector<std::string> sides = {"upper", "balanced", "under"};
  std::vector<Model> models;
  for (const KChoice& k : both_k()) {
    const std::vector<Statement> statements = side_statements(lab, k);
    chapter.statements.insert(chapter.statements.end(), statements.begin(), statements.end());
    const std::vector<Figure>& forces = statements.back().judgement.numbers;
    const auto f_none = forces.at(1).value, f_upper = forces.at(2).value;
    if (f_upper && f_none && *f_upper < *f_none)
      chapter.findings.push_back(k.name +
                                 ": a push on the upper face lowers the critical pull from " +
                                 rounded(*f_none, 3) + " to " + rounded(*f_upper, 3) +
                                 " N: against the expansion as it is, it opens the crack. Eq. 2 "
                                 "takes it off by its sign.");
    for (const std::string& side : sides)
      models.push_back({side + ", " + k.name,
                        lab.run({"pressure-" + side, {k.override}, nullptr, 1, kSnapshots})});
  }
  chapter.tables = {path_table("experiment-4-paths", models),
                    events_table("experiment-4-fractures", models)};
  std::vector<PanelRow> rows;
  for (std::size_t k = 0; k < both_k().size(); ++k) {
    PanelRow row{both_k()[k].name, {}};
    for (std::size_t side = 0; side < 3; ++side) {
      const Model& model = models[3 * k + side];
      const State& state =
          model.run.snapshots.empty() ? model.run.last : model.run.snapshots.back();
      row.panels.push_back(
          {&model.run, &state, sides[side] + ": " + panel_title(model.run, state)});
    }
    rows.push_back(std::move(row));
  }
  chapter.drawings.push_back(
      {"experiment-4", "The last of 5, 10, 20 and 40 fractures that each reached.",
       montage("Pressure on the upper face, on both, on the under face", rows)});
  chapter.drawings.push_back(
      chart_drawing("experiment-4-path-formula", "Paths, formula K; the notch's tip at 0.",
                    path_series({models.begin(), models.begin() + 3}), kPathAxes));
  chapter.drawings.push_back(
      chart_drawing("experiment-4-path-field", "Paths, field K; the notch's tip at 0.",
                    path_series({models.begin() + 3, models.end()}), kPathAxes));
  return chapter;
}

}  // namespace sunder::app::reproduce
