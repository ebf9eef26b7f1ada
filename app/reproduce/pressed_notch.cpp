// SPDX-License-Identifier: Apache-2.0
// Experiment 3: pressure near the tip and far from it, and what lies between.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"
#include "app/reproduce/models.hpp"
#include "app/reproduce/statements.hpp"
#include "app/reproduce/tada_pair.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kPress = 30;                            // N, of the scenes pressure-*
constexpr double kRight = 50, kMiddle = 25, kMouth = 2;  // mm, of the notched board
constexpr double kNotch = 8;       // mm: several h, so that near and far are different places
constexpr double kLongNotch = 16;  // mm
constexpr double kNear = 1.6;      // mm from the tip: the nearest pair of nodes that faces it
constexpr double kMore = 1.05;     // of the force that both need: both tears go on

/// Of elements [mm].
double fine(const Effort& effort) { return effort.quick ? kPressedNotch : 1.6; }

std::string triple(double x, double y, double z) {
  return "[" + number(x) + "," + number(y) + "," + number(z) + "]";
}

/// A notch of this length, pressed apart at this distance from its tip and not pulled.
RunPlan pressed(const Laboratory& lab, const KChoice& k, double size, double length,
                double distance) {
  const double x = kRight - length + distance, half = kMouth / 2 * distance / length;
  return {"pressure-near",
          {k.override, "instrument.0.force=[0,0,0]",
           "crack.0.tip=" + triple(kRight - length, kMiddle, 1),
           "instrument.1.at=" + triple(x, kMiddle + half, 1),
           "instrument.2.at=" + triple(x, kMiddle - half, 1)},
          lab.notch({size, length, 5}),
          1,
          {}};
}

std::optional<double> force_of(const std::optional<CriticalLoad>& critical) {
  return critical ? std::optional(critical->factor * kPress) : std::nullopt;
}

/// What one event adds to the notch under `factor` times the plan's forces.
NextRupture next_rupture(const Laboratory& lab, RunPlan plan, std::optional<double> factor) {
  if (!factor) return {};
  plan.load = *factor;
  const RunResult run = lab.run(one_event(lab, std::move(plan)));
  NextRupture next{preset_path(run).advance(), std::nullopt};
  for (const DestroyedElement& row : run.fractures())
    if (row.sif) next.reach = std::max(next.reach.value_or(0), row.sif->reach);
  return next;
}

/// The paper's picture: a short notch, 1.5 h, torn on to the end of the scenes.
DataTable short_notch(const Laboratory& lab, const std::vector<Model>& models) {
  DataTable table{"experiment-3-short-notch",
                  "The scenes' own notch of 4.04 mm is 1.5 h long: near and far are neighbouring "
                  "nodes, and what counts is where the tear runs afterwards. Force: the pull at "
                  "which the crack starts; each press exerts as much.",
                  {"scene", "K", "force [N]", "grown to the end [mm]"},
                  {},
                  true};
  for (std::size_t i = 0; i < models.size(); ++i) {
    const KChoice& k = both_k()[i / 2];
    const std::string scene = i % 2 == 0 ? "pressure-near" : "pressure-far";
    table.rows.push_back({scene, k.name, cell(critical_force(lab, scene, {k.override}, true)),
                          cell(preset_path(models[i].run).advance())});
  }
  return table;
}

/// Eq. 4 backwards: K_b = 2 P/sqrt(2 pi b').
std::optional<double> distance_of(const std::optional<CriticalLoad>& critical, double thickness) {
  if (!critical || !(critical->sif->k_b > 0)) return std::nullopt;
  const double p = critical->factor * kPress / thickness;
  return 2 * p * p / (std::numbers::pi * critical->sif->k_b * critical->sif->k_b);
}

/// One notch pressed at several places: K per newton over b'/a.
class Curve {
 public:
  Curve(const Laboratory& lab, double size, double length)
      : lab_(lab), size_(size), length_(length) {}

  void measure(double wanted, DataTable& table) {
    for (const KChoice& k : both_k()) {
      const RunPlan plan = pressed(lab_, k, size_, length_, wanted);
      const double thickness = board_plane(*plan.mesh, std::nullopt).thickness();
      const auto critical = critical_growth(lab_, plan);
      const auto distance = distance_of(critical, thickness), force = force_of(critical);
      if (!distance) continue;
      // Two wishes may share their nearest nodes.
      if (!seen_.insert({k.name, std::llround(*distance * 1e6)}).second) continue;
      const double formula = critical->sif->k_formula.value_or(0) / *force,
                   field = critical->sif->k_field.value_or(0) / *force;
      std::optional<double> strip;
      if (*distance < length_) strip = tada_pair(*distance, length_, kRight) / thickness;
      if (&k == &both_k().back()) {
        const double share = *distance / length_;
        formula_.emplace_back(share, formula);
        field_.emplace_back(share, field);
        if (strip) strip_.emplace_back(share, *strip);
      }
      table.rows.push_back({cell(length_), cell(wanted), cell(distance), cell(*distance / length_),
                            k.name, cell(force), cell(formula), cell(field), cell(strip)});
    }
  }

  /// Where the field's K is least: nearer and farther places tear at a lower force.
  [[nodiscard]] std::string finding() const {
    if (field_.size() < 2) return {};
    const auto least = std::min_element(field_.begin(), field_.end(),
                                        [](const Vec2& a, const Vec2& b) { return a.y() < b.y(); });
    const auto at = [](const Vec2& p) {
      return rounded(p.y(), 3) + " at b' = " + rounded(p.x(), 2) + " a";
    };
    std::string text = "Notch of " + rounded(length_, 3) + " mm: K per newton by the field is " +
                       at(field_.front()) + ", " + at(*least) + " and " + at(field_.back()) +
                       " [MPa sqrt(mm)/N]. ";
    text += least + 1 == field_.end()
                ? "It falls all the way to the mouth: nearer is always easier"
                : "Nearer is easier up to " + rounded(least->x(), 2) + " a, beyond it turns";
    return text + "; Tada's strip turns at " + rounded(tada_turn(length_, kRight), 2) +
           " a, Eq. 4 never.";
  }
  [[nodiscard]] std::vector<ChartSeries> series() const {
    return {{"Eq. 4", formula_}, {"field", field_}, {"Tada's strip", strip_}};
  }

 private:
  const Laboratory& lab_;
  double size_, length_;
  std::vector<Vec2> formula_, field_, strip_;  // K/force over b'/a, in order of the wishes
  std::set<std::pair<std::string, long long>> seen_;
};

std::vector<double> places(double length, bool quick) {
  if (quick) return {kNear, length};
  std::vector<double> all;
  for (double share : {0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0}) all.push_back(share * length);
  return all;
}

}  // namespace

std::vector<Statement> next_rupture_statements(const Laboratory& lab, const KChoice& k,
                                               double size) {
  std::vector<Statement> statements;
  const RunPlan near = pressed(lab, k, size, kNotch, kNear),
                far = pressed(lab, k, size, kNotch, kNotch);
  const auto of_near = critical_growth(lab, near), of_far = critical_growth(lab, far);
  const std::string words =
      "the length of rupture progression resulting from the same force applied to different "
      "positions";
  statements.push_back({"3a", "Pressed nearer to the tip, the next rupture needs a lower force.",
                        k.name,
                        judge_lower_force(force_of(of_near), force_of(of_far),
                                          "force on each face at the next rupture, near the tip",
                                          "force on each face at the next rupture, far from it"),
                        words});
  std::optional<double> both;
  if (of_near && of_far) both = kMore * std::max(of_near->factor, of_far->factor);
  statements.push_back(
      {"3b", "Pressed nearer to the tip with the same force, the next rupture is longer.", k.name,
       judge_goes_further(next_rupture(lab, near, both), next_rupture(lab, far, both)), words});
  return statements;
}

Chapter pressure_distance(const Laboratory& lab, const Effort& effort) {
  lab.tell("experiment 3: pressure near the tip and far from it");
  const double h = board_plane(*lab.notch({fine(effort), kNotch, 5}), std::nullopt).edge_length;
  Chapter chapter{"experiment-3",
                  "Experiment 3 (Fig. 6): pressure near the tip and far from it",
                  "The statements are about the next rupture: a notch of 8 mm in a board of "
                  "elements of " +
                      rounded(fine(effort), 2) + " mm (h = " + rounded(h, 3) +
                      " mm), its faces pressed apart by equal forces 1.6 mm from the tip and at "
                      "its mouth, with no pull; the length is that of one event, under 1.05 times "
                      "the larger of the two forces. The pictures are scenes pressure-near and "
                      "pressure-far, whose notch of 4.04 mm is 1.5 h long. The paper takes the "
                      "pressure \"from the stress distribution\"; here it is the applied force.",
                  {},
                  {},
                  {},
                  {}};
  std::vector<Model> models;
  for (const KChoice& k : both_k()) {
    for (const std::string place : {"near", "far"})
      models.push_back({place + ", " + k.name,
                        lab.run({"pressure-" + place, {k.override}, nullptr, 1, kSnapshots})});
    const auto statements = next_rupture_statements(lab, k, fine(effort));
    chapter.statements.insert(chapter.statements.end(), statements.begin(), statements.end());
  }
  chapter.tables = {short_notch(lab, models), path_table("experiment-3-paths", models),
                    events_table("experiment-3-fractures", models)};
  chapter.drawings.push_back({"experiment-3",
                              "Stress and destroyed elements after 5, 10, 20 and 40 fractures.",
                              picture("Notch pressed open near its tip and far from it", models)});
  return chapter;
}

Chapter pressure_position(const Laboratory& lab, const Effort& effort) {
  Chapter chapter{
      "pressure-position",
      "Critical force against the position of the pressure",
      "Notches of 8 and 16 mm (quick version: 8), elements of 1.6 mm (2.6), their faces "
      "pressed apart by equal forces and nothing else, at several distances b' from "
      "the tip. Eq. 4, the K of a pair of forces on a crack in an infinite body, says "
      "force ~ sqrt(b'). On a board the pair also bends the halves open, the more the "
      "farther it is: Tada's K of a pair on an edge crack in a strip (one material, "
      "straight sides) has both.",
      {},
      {},
      {},
      {}};
  DataTable table{
      "pressure-position",
      "Force: on each face. K per newton [MPa sqrt(mm)/N] at that place.",
      {"notch a [mm]", "wanted distance [mm]", "distance b' of Eq. 4 [mm]", "b'/a", "K",
       "critical force [N]", "formula K/force", "field K/force", "Tada's strip K/force"},
      {},
      true};
  lab.tell("pressure position");
  const std::vector<double> lengths =
      effort.quick ? std::vector<double>{kNotch} : std::vector<double>{kNotch, kLongNotch};
  for (const double length : lengths) {
    Curve curve(lab, fine(effort), length);
    for (const double wanted : places(length, effort.quick)) curve.measure(wanted, table);
    if (std::string text = curve.finding(); !text.empty())
      chapter.findings.push_back(std::move(text));
    const std::string mm = rounded(length, 3);
    chapter.drawings.push_back(chart_drawing(
        "pressure-position-" + mm, "K of the pair per newton, notch of " + mm + " mm.",
        curve.series(), {"b' / length of the notch", "K/force [MPa sqrt(mm)/N]"}));
  }
  chapter.tables = {table};
  return chapter;
}

}  // namespace sunder::app::reproduce
