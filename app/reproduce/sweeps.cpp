// SPDX-License-Identifier: Apache-2.0
// What one quantity does when another is varied.
#include <cmath>
#include <numbers>
#include <set>

#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"
#include "app/reproduce/notch_mesh.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kNotchPull = 42, kPress = 30, kSidePull = 62;  // N, of the scenes
constexpr double kRight = 50, kMiddle = 25, kMouth = 2;         // mm, of the notched board
constexpr double kLongNotch = 16;                               // mm
constexpr double kFineSize = 1.86;  // mm, of elements: nodes to press on every 1.6 mm or so

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

Chapter notch_length(const Laboratory& lab, const Effort& effort) {
  const std::vector<double> lengths = effort.quick
                                          ? std::vector<double>{4.04, 8, 16}
                                          : std::vector<double>{3, 4.04, 6, 8, 10, 12, 16, 20};
  Chapter chapter{
      "notch-length",
      "Effect of the preset crack's length",
      "Scene notch-b with the notch's length changed, element size 3.939 mm: the pull at "
      "which the crack grows, and the stress intensity per newton.",
      {},
      {},
      {},
      {}};
  DataTable table{"notch-length",
                  "",
                  {"length [mm]", "elements", "K", "critical force [N]", "K/force [MPa sqrt(mm)/N]",
                   "first growth [deg]"},
                  {},
                  true};
  Curves forces, factors;
  for (const double length : lengths) {
    lab.tell("notch length " + rounded(length, 3) + " mm");
    const auto mesh = mesh_notch({3.939, length, 5});
    for (std::size_t k = 0; k < both_k().size(); ++k) {
      const auto critical = critical_growth(
          lab, {"notch-b",
                {both_k()[k].override, "crack.0.tip=" + triple(kRight - length, kMiddle, 1)},
                mesh,
                1,
                {}});
      const auto force = times(critical, kNotchPull);
      const auto per_newton = force ? std::optional(critical->sif->k / *force) : std::nullopt;
      forces.add(k, length, force);
      factors.add(k, length, per_newton);
      table.rows.push_back({cell(length), std::to_string(mesh->tet_count()), both_k()[k].name,
                            cell(force), cell(per_newton),
                            cell(critical ? std::optional(critical->rise_deg) : std::nullopt)});
    }
  }
  chapter.tables = {table};
  chapter.drawings = {
      chart_drawing("notch-length-force", "Critical force over the notch's length.", forces.series,
                    {"length of the notch [mm]", "critical force [N]"}),
      chart_drawing("notch-length-k", "Stress intensity per newton of pull.", factors.series,
                    {"length of the notch [mm]", "K/force [MPa sqrt(mm)/N]"})};
  return chapter;
}

Chapter pressure_position(const Laboratory& lab, const Effort& effort) {
  const std::vector<double> distances =
      effort.quick ? std::vector<double>{3, 8, 15} : std::vector<double>{1, 3, 5, 7, 9, 11, 13, 15};
  Chapter chapter{"pressure-position",
                  "Critical force against the position of the pressure",
                  "A notch of 16 mm in a board of about 6,700 elements, its faces pressed apart by "
                  "equal forces and nothing else, at several distances from the tip. Eq. 4 says "
                  "force ~ sqrt(distance).",
                  {},
                  {},
                  {},
                  {}};
  DataTable table{"pressure-position",
                  "Force: on each face.",
                  {"wanted distance [mm]", "distance b' of Eq. 4 [mm]", "K", "critical force [N]",
                   "K by the formula [MPa sqrt(mm)]", "K from the field [MPa sqrt(mm)]"},
                  {},
                  true};
  lab.tell("pressure position");
  const auto mesh = mesh_notch({kFineSize, kLongNotch, 5});
  const double thickness = board_plane(*mesh, std::nullopt).thickness();
  Curves curves;
  std::set<std::pair<std::size_t, long long>> seen;  // two wishes may share their nearest nodes
  for (const double wanted : distances) {
    const double x = kRight - kLongNotch + wanted, half = kMouth / 2 * wanted / kLongNotch;
    for (std::size_t k = 0; k < both_k().size(); ++k) {
      const auto critical =
          critical_growth(lab, {"pressure-near",
                                {both_k()[k].override, "instrument.0.force=[0,0,0]",
                                 "crack.0.tip=" + triple(kRight - kLongNotch, kMiddle, 1),
                                 "instrument.1.at=" + triple(x, kMiddle + half, 1),
                                 "instrument.2.at=" + triple(x, kMiddle - half, 1)},
                                mesh,
                                1,
                                {}});
      std::optional<double> distance;
      if (critical && critical->sif->k_b > 0) {
        // Eq. 4 backwards: K_b = 2 P/sqrt(2 pi b').
        const double p = critical->factor * kPress / thickness;
        distance = 2 * p * p / (std::numbers::pi * critical->sif->k_b * critical->sif->k_b);
      }
      if (distance && !seen.insert({k, std::llround(*distance * 1e6)}).second) continue;
      if (distance) curves.add(k, *distance, times(critical, kPress));
      table.rows.push_back({cell(wanted), cell(distance), both_k()[k].name,
                            cell(times(critical, kPress)),
                            critical ? cell(critical->sif->k_formula) : "",
                            critical ? cell(critical->sif->k_field) : ""});
    }
  }
  for (std::size_t k = 0; k < both_k().size(); ++k)
    if (curves.series[k].points.size() > 1)
      chapter.findings.push_back(both_k()[k].name + ": critical force ~ distance^" +
                                 rounded(power(curves.series[k].points), 2) + " (Eq. 4: 0.5).");
  chapter.tables = {table};
  chapter.drawings = {chart_drawing(
      "pressure-position", "Critical force over the distance.", curves.series,
      {"distance of the pressure from the tip [mm]", "critical force on each face [N]"})};
  return chapter;
}

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
