// SPDX-License-Identifier: Apache-2.0
// Experiments 1 to 4.
#include <algorithm>
#include <cmath>

#include "app/figure/figure.hpp"
#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"
#include "app/reproduce/figures.hpp"

namespace sunder::app::reproduce {
namespace {

const std::vector<int> kSnapshots = {5, 10, 20, 40};  // fractures, as in the paper's Fig. 4

struct Model {
  std::string name;
  RunResult run;
};

/// A, and B with either K, of scenes `stem`-a and `stem`-b.
std::vector<Model> run_models(const Laboratory& lab, const std::string& stem) {
  std::vector<Model> models;
  models.push_back({"model A", lab.run({stem + "-a", {}, nullptr, 1, kSnapshots})});
  for (const KChoice& k : both_k())
    models.push_back(
        {"model B, " + k.name, lab.run({stem + "-b", {k.override}, nullptr, 1, kSnapshots})});
  return models;
}

std::string panel_title(const RunResult& run, const State& state) {
  int presets = 0;
  for (const DestroyedElement& row : run.destroyed) presets += row.cause == Cause::preset ? 1 : 0;
  const double scale = FigurePainter(*run.problem).displacement_scale(state);
  return counted(state.destroyed_count - presets, "fracture") + ", " +
         "t = " + rounded(state.load_factor, 3) +
         (scale == 1 ? "" : ", drawn x " + rounded(scale, 2));
}

PanelRow panel_row(const Model& model, std::size_t columns) {
  PanelRow row{model.name, {}};
  for (const State& state : model.run.snapshots)
    row.panels.push_back({&model.run, &state, panel_title(model.run, state)});
  const bool more = model.run.snapshots.empty() ||
                    model.run.snapshots.back().destroyed_count < model.run.last.destroyed_count;
  if (row.panels.size() < columns && more)
    row.panels.push_back(
        {&model.run, &model.run.last, "end: " + panel_title(model.run, model.run.last)});
  return row;
}

std::string picture(const std::string& title, const std::vector<Model>& models) {
  std::vector<PanelRow> rows;
  for (const Model& model : models) rows.push_back(panel_row(model, kSnapshots.size()));
  return montage(title, rows);
}

DataTable events_table(const std::string& name, const std::vector<Model>& models) {
  DataTable table{name,
                  "Every fracture of these runs, in order.",
                  {"run", "order", "step", "element", "criterion", "ratio", "load_factor"},
                  {},
                  false};
  for (const Model& model : models) {
    int order = 0;
    for (const DestroyedElement& row : model.run.fractures())
      table.rows.push_back({model.name, std::to_string(order++), std::to_string(row.step),
                            std::to_string(row.element), to_string(row.cause), cell(row.ratio),
                            cell(row.load_factor)});
  }
  return table;
}

std::optional<double> share_of_growth(const std::vector<DestroyedElement>& rows) {
  if (rows.empty()) return std::nullopt;
  const auto grown = std::count_if(rows.begin(), rows.end(), [](const DestroyedElement& row) {
    return row.cause == Cause::sif;
  });
  return static_cast<double>(grown) / static_cast<double>(rows.size());
}

std::optional<double> connected(const RunResult& run) {
  const auto rows = run.fractures();
  if (rows.empty()) return std::nullopt;
  return connected_share(run.problem->mesh(), rows);
}

std::vector<std::optional<double>> peaks(const RunResult& run) {
  std::vector<std::optional<double>> distances;
  for (const State& state : run.snapshots) distances.push_back(peak_to_tip(run, state));
  if (distances.empty() && !run.fractures().empty())
    distances.push_back(peak_to_tip(run, run.last));
  return distances;
}

/// Pull at the lower right corner of a scene, all of it [N].
double pull_of(const Laboratory& lab, const std::string& scene) {
  double force = 0;
  for (const Instrument& tool : lab.scene({scene, {}, nullptr, 1, {}}).instruments)
    if (const auto* pull = std::get_if<Pull>(&tool.action)) force += pull->force.norm();
  return force;
}

std::optional<double> critical_force(const Laboratory& lab, const std::string& scene,
                                     const std::vector<std::string>& overrides, bool growth) {
  const RunPlan plan{scene, overrides, nullptr, 1, {}};
  const auto critical = growth ? critical_growth(lab, plan) : critical_load(lab, plan);
  if (!critical) return std::nullopt;
  return critical->factor * pull_of(lab, scene);
}

DataTable path_table(const std::string& name, const std::vector<Model>& models) {
  DataTable table{name,
                  "Path of the notch's crack: distance along its first direction and height above "
                  "it [mm].",
                  {"run", "distance", "height"},
                  {},
                  false};
  for (const Model& model : models)
    for (const Vec2& p : preset_path(model.run).points)
      table.rows.push_back({model.name, cell(p.x()), cell(p.y())});
  return table;
}

std::vector<ChartSeries> path_series(const std::vector<Model>& models) {
  std::vector<ChartSeries> series;
  for (const Model& model : models) series.push_back({model.name, preset_path(model.run).points});
  return series;
}

const ChartAxes kPathAxes{"distance along the notch's direction [mm]", "height [mm]"};

}  // namespace

const std::vector<KChoice>& both_k() {
  static const std::vector<KChoice> choices = {{"formula K", "fracture.sif=formula"},
                                               {"field K", "fracture.sif=field"}};
  return choices;
}

Chapter pulled_board(const Laboratory& lab) {
  lab.tell("experiment 1: board pulled at its corner");
  const std::vector<Model> models = run_models(lab, "board-pull");
  Chapter chapter{
      "experiment-1",
      "Experiment 1 (Fig. 4): board pulled at its lower right corner",
      "Scenes board-pull-a and board-pull-b: 1954 tetrahedra, 98 N. Model B lets a new "
      "crack go through the thickness (birth = \"through\"); K from the paper's formula "
      "and K measured from the field.",
      {},
      {},
      {},
      {}};
  const auto a = models[0].run.fractures();
  for (std::size_t i = 1; i < models.size(); ++i) {
    const RunResult& run = models[i].run;
    const auto rows = run.fractures();
    const std::string by = both_k()[i - 1].name;
    chapter.statements.push_back(
        {"1a", "With B a rupture becomes a crack, and the fractures that follow belong to it.", by,
         judge_one_crack({connected(run), share_of_growth(rows)})});
    chapter.statements.push_back({"1b", "With B the stress concentrates at the crack's tip.", by,
                                  judge_peak_at_tip(peaks(run))});
    const std::size_t count = std::min({a.size(), rows.size(), std::size_t{40}});
    chapter.statements.push_back(
        {"1c", "A and B destroy different elements.", by,
         judge_models_differ(count == 0 ? std::optional<double>() : overlap(a, rows, count))});
  }
  DataTable first{"experiment-1-first-rupture",
                  "Force at which the first element ruptures.",
                  {"pulling points", "force each [N]", "force in all [N]"},
                  {},
                  true};
  for (const auto& [name, scene, points] :
       {std::tuple{"lower right", "board-pull-b", 1.0},
        std::tuple{"lower left and right", "board-pull-two-points-b", 2.0}}) {
    const auto force = critical_force(lab, scene, {}, false);
    first.rows.push_back(
        {name, cell(force ? std::optional(*force / points) : std::nullopt), cell(force)});
  }
  chapter.tables = {first, events_table("experiment-1-fractures", models)};
  chapter.drawings.push_back(
      {"experiment-1",
       "Stress and destroyed elements after 5, 10, 20 and 40 fractures, or at the "
       "first event beyond; one event of B may pass two of these. t: scene "
       "time; x: displacements drawn smaller than they are.",
       picture("Board pulled at its lower right corner", models)});
  return chapter;
}

Chapter notched_board(const Laboratory& lab) {
  lab.tell("experiment 2: notched board");
  const std::vector<Model> models = run_models(lab, "notch");
  Chapter chapter{"experiment-2",
                  "Experiment 2 (Fig. 5): small notch in the middle of the right edge",
                  "Scenes notch-a and notch-b: notch of 4.04 mm at the border of the two tissues, "
                  "42 N at the lower right corner. The paper's specimen is silicone rubber.",
                  {},
                  {},
                  {},
                  {}};
  const auto a = critical_force(lab, "notch-a", {}, false);
  for (std::size_t i = 1; i < models.size(); ++i) {
    const KChoice& k = both_k()[i - 1];
    const GrownPath path = preset_path(models[i].run);
    chapter.statements.push_back(
        {"2a", "The crack runs first up, then down.", k.name,
         judge_up_then_down(path.points.size() > 1 ? std::optional(turns_of(path))
                                                   : std::nullopt)});
    chapter.statements.push_back(
        {"2b", "On the notched board B starts to tear at a lower load than A.", k.name,
         judge_lower_force(critical_force(lab, "notch-b", {k.override}, true), a,
                           "critical force, B", "critical force, A")});
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

Chapter pressure_distance(const Laboratory& lab) {
  lab.tell("experiment 3: pressure near the tip and far from it");
  Chapter chapter{"experiment-3",
                  "Experiment 3 (Fig. 6): pressure near the tip and far from it",
                  "Scenes pressure-near and pressure-far: two instruments press the notch's faces "
                  "apart with 30 N each, at x = 46.5 mm and at its mouth, while a third pulls with "
                  "30 N. The paper takes the pressure \"from the stress distribution\"; here it is "
                  "the applied force. Eq. 4 is the K of a pair of forces on a crack in an infinite "
                  "body; on a board the pair bends the halves open the more the farther it is.",
                  {},
                  {},
                  {},
                  {}};
  std::vector<Model> models;
  for (const KChoice& k : both_k()) {
    const std::vector<std::string> by = {k.override};
    models.push_back({"near, " + k.name, lab.run({"pressure-near", by, nullptr, 1, kSnapshots})});
    models.push_back({"far, " + k.name, lab.run({"pressure-far", by, nullptr, 1, kSnapshots})});
    const RunResult &near = models[models.size() - 2].run, &far = models.back().run;
    chapter.statements.push_back(
        {"3a", "Pressed nearer to the tip, the crack starts at a lower force.", k.name,
         judge_lower_force(critical_force(lab, "pressure-near", by, true),
                           critical_force(lab, "pressure-far", by, true),
                           "critical force, near the tip", "critical force, far from it")});
    chapter.statements.push_back(
        {"3b", "Pressed nearer to the tip, the crack goes further.", k.name,
         judge_goes_further(preset_path(near).advance(), preset_path(far).advance())});
  }
  chapter.tables = {path_table("experiment-3-paths", models),
                    events_table("experiment-3-fractures", models)};
  chapter.drawings.push_back({"experiment-3",
                              "Stress and destroyed elements after 5, 10, 20 and 40 fractures.",
                              picture("Notch pressed open near its tip and far from it", models)});
  return chapter;
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
    chapter.statements.push_back(
        {"4a",
         "The crack goes up, straight and down with pressure on the upper face, on both and "
         "on the under face.",
         k.name, judge_sides({angle(upper), angle(balanced), angle(under)})});
    chapter.statements.push_back(
        {"4b", "Balanced pressure tears earlier than none.", k.name,
         judge_lower_force(force(balanced, "pressure-balanced"), f_none,
                           "critical pull, balanced pressure", "critical pull, no pressure")});
    chapter.statements.push_back(
        {"4c", "Pressure with the expansion raises the stress, against it lowers it.", k.name,
         judge_side_forces(
             {force(under, "pressure-under"), f_none, force(upper, "pressure-upper")})});
    const auto f_upper = force(upper, "pressure-upper");
    if (f_upper && f_none && *f_upper < *f_none)
      chapter.findings.push_back(k.name +
                                 ": a push on the upper face lowers the critical pull from " +
                                 rounded(*f_none, 3) + " to " + rounded(*f_upper, 3) +
                                 " N: against the expansion as it is, it opens the crack. Eq. 2 "
                                 "takes it off by its sign.");
    for (const std::string& side : sides)
      models.push_back(
          {side + ", " + k.name, lab.run({"pressure-" + side, by, nullptr, 1, kSnapshots})});
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
