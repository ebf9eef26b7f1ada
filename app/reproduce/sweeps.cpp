// SPDX-License-Identifier: Apache-2.0
// What one quantity does when another is varied.
#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kNotchPull = 42, kSidePull = 62;  // N, of the scenes

std::string triple(double x, double y, double z) {
  return "[" + number(x) + "," + number(y) + "," + number(z) + "]";
}

/// A value per K choice over one abscissa.
struct Curves {
  std::vector<ChartSeries> series;
  Curves() {
    for (const KChoice& k : both_k()) series.push_back({k.name, {}});
  }
  void add(std::size_t k, double x, const std::optional<double>& y) {
    if (y) series[k].points.emplace_back(x, *y);
  }
};

std::optional<double> times(const std::optional<CriticalLoad>& critical, double force) {
  return critical ? std::optional(critical->factor * force) : std::nullopt;
}

}  // namespace

Chapter pressure_angle(const Laboratory& lab, const Effort& effort) {
  const std::vector<double> presses =
      effort.quick ? std::vector<double>{-10, 0, 10}
                   : std::vector<double>{-30, -20, -10, -5, -2.5, 0, 2.5, 5, 10, 20, 30};
  Chapter chapter{
      "pressure-angle",
      "Angle against one-sided pressure",
      "62 N at the lower right corner and a pressure on one face of the notch at x = 48 "
      "mm, growing together: angle of the first growth, upwards positive.",
      {},
      {},
      {},
      {}};
  DataTable table{"pressure-angle",
                  "Pressure: positive on the upper face, negative on the under face.",
                  {"pressure/pull", "K", "first growth [deg]", "critical pull [N]"},
                  {},
                  true};
  Curves angles, forces;
  lab.tell("angle against one-sided pressure");
  for (const double press : presses) {
    for (std::size_t k = 0; k < both_k().size(); ++k) {
      RunPlan plan{press < 0 ? "pressure-under" : "pressure-upper",
                   {both_k()[k].override, "instrument.1.force=" + triple(0, press, 0)},
                   nullptr,
                   1,
                   {}};
      if (press == 0)
        plan = {"notch-b", {both_k()[k].override, "instrument.0.force=[0,-62,0]"}, nullptr, 1, {}};
      const auto critical = critical_growth(lab, plan);
      const auto angle = critical ? std::optional(critical->rise_deg) : std::nullopt;
      angles.add(k, press / kSidePull, angle);
      forces.add(k, press / kSidePull, times(critical, kSidePull));
      table.rows.push_back({cell(press / kSidePull), both_k()[k].name, cell(angle),
                            cell(times(critical, kSidePull))});
    }
  }
  chapter.tables = {table};
  chapter.drawings = {
      chart_drawing("pressure-angle", "Angle of the first growth.", angles.series,
                    {"pressure on the upper (+) or under (-) face / pull", "angle [deg]"}),
      chart_drawing("pressure-angle-force", "Pull at which the crack grows.", forces.series,
                    {"pressure on the upper (+) or under (-) face / pull", "critical pull [N]"})};
  return chapter;
}

Chapter k_along_crack(const Laboratory& lab) {
  lab.tell("K along a growing crack");
  Chapter chapter{"k-along-crack",
                  "Formula and field K along a growing crack",
                  "Scene notch-b, the crack driven by either K; both are measured from the same "
                  "states, before each advance. K is divided by the pull of that moment.",
                  {},
                  {},
                  {},
                  {}};
  DataTable table{"k-along-crack",
                  "One row per advance.",
                  {"driven by", "length a [mm]", "pull [N]", "formula K [MPa sqrt(mm)]",
                   "field K [MPa sqrt(mm)]", "K_I [MPa sqrt(mm)]", "K_II [MPa sqrt(mm)]",
                   "angle by formula K [deg]", "angle by field K [deg]", "field's note"},
                  {},
                  true};
  for (const KChoice& k : both_k()) {
    const RunResult run = lab.run({"notch-b", {k.override}, nullptr, 1, {}});
    const Instrument& pull = run.problem->scene().instruments.at(0);
    std::vector<ChartSeries> series = {{"formula", {}}, {"field", {}}};
    int event = kNone;
    for (const DestroyedElement& row : run.fractures()) {
      if (!row.sif || row.crack != 0 || row.event == event) continue;
      event = row.event;
      const double force = kNotchPull * pull.factor(row.load_factor);
      if (row.sif->k_formula)
        series[0].points.emplace_back(row.sif->a, *row.sif->k_formula / force);
      if (row.sif->k_field) series[1].points.emplace_back(row.sif->a, *row.sif->k_field / force);
      table.rows.push_back({k.name, cell(row.sif->a), cell(force), cell(row.sif->k_formula),
                            cell(row.sif->k_field), cell(row.sif->k_1), cell(row.sif->k_2),
                            cell(row.sif->theta_formula), cell(row.sif->theta_field),
                            std::string(row.sif->field_note)});
    }
    chapter.drawings.push_back(chart_drawing(
        k.override.ends_with("field") ? "k-along-crack-field" : "k-along-crack-formula",
        "K per newton of pull along the crack that the " + k.name + " drives.", series,
        {"length of the crack [mm]", "K/pull [MPa sqrt(mm)/N]"}));
    if (!series[0].points.empty() && !series[1].points.empty()) {
      const auto ratio = [&](std::size_t i) {
        return rounded(series[0].points[i].y() / series[1].points[i].y(), 3);
      };
      const std::size_t last = std::min(series[0].points.size(), series[1].points.size()) - 1;
      chapter.findings.push_back("Driven by the " + k.name + ": the formula gives " + ratio(0) +
                                 " of the field's K at the notch and " + ratio(last) +
                                 " of it at a = " + rounded(series[1].points[last].x(), 3) +
                                 " mm.");
    }
  }
  chapter.tables = {table};
  return chapter;
}

}  // namespace sunder::app::reproduce
