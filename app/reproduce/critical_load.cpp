// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/critical_load.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunder::app::reproduce {
namespace {

constexpr double kMostLoad = 4096, kRaise = 4;
constexpr double kRadians = std::numbers::pi / 180;

void scale(SifTerms& terms, double factor) {
  for (double SifTerms::*k :
       {&SifTerms::k, &SifTerms::k_a, &SifTerms::k_b, &SifTerms::k_c, &SifTerms::sigma0})
    terms.*k *= factor;
  for (std::optional<double> SifTerms::*k :
       {&SifTerms::k_1, &SifTerms::k_2, &SifTerms::k_3, &SifTerms::k_formula, &SifTerms::k_field})
    if (terms.*k) *(terms.*k) *= factor;
  terms.reach *= factor * factor;
}

/// Forward direction of the crack before its first growth, turned by theta.
double rise(const Laboratory& lab, const RunPlan& plan, const BoardPlane& plane, int crack,
            double theta_deg) {
  const Scene scene = lab.scene(plan);
  if (crack < 0 || static_cast<std::size_t>(crack) >= scene.cracks.size()) return 0;
  const PresetCrack& preset = scene.cracks[static_cast<std::size_t>(crack)];
  if (!preset.mouth) return 0;
  const Vec2 d = plane.project(preset.tips[0] - *preset.mouth);
  const double angle = std::atan2(d.y(), d.x()) + theta_deg * kRadians;
  return std::asin(std::clamp(std::sin(angle), -1.0, 1.0)) / kRadians;
}

std::optional<CriticalLoad> first_rupture(const Laboratory& lab, RunPlan plan, bool growth) {
  plan.overrides.insert(plan.overrides.end(), {"time.steps=1", "fracture.max_events=1"});
  plan.snapshots.clear();
  const double begin = plan.load;
  for (double raise = 1; raise <= kMostLoad; raise *= kRaise) {
    plan.load = begin * raise;
    const RunResult result = lab.run(plan);
    const std::vector<DestroyedElement> rows = result.fractures();
    if (rows.empty() || (growth && rows.front().cause != Cause::sif)) continue;
    const DestroyedElement& first = rows.front();
    const double less = first.cause == Cause::sif ? 1 / std::sqrt(*first.ratio) : 1 / *first.ratio;
    CriticalLoad critical{raise * less, first.cause, first.sif, 0, result.plane.edge_length};
    if (critical.sif) {
      scale(*critical.sif, less);
      critical.rise_deg = rise(lab, plan, result.plane, first.crack, critical.sif->theta);
    }
    return critical;
  }
  return std::nullopt;
}

}  // namespace

std::optional<CriticalLoad> critical_load(const Laboratory& lab, RunPlan plan) {
  return first_rupture(lab, std::move(plan), false);
}

std::optional<CriticalLoad> critical_growth(const Laboratory& lab, RunPlan plan) {
  return first_rupture(lab, std::move(plan), true);
}

}  // namespace sunder::app::reproduce
