// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/models.hpp"

#include "app/figure/figure.hpp"
#include "app/output/text.hpp"
#include "app/reproduce/critical_load.hpp"

namespace sunder::app::reproduce {
namespace {

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

}  // namespace

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

}  // namespace sunder::app::reproduce
