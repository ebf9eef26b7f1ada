// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/critical_load.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunder::app::reproduce {
namespace {

constexpr double kMostLoad = 4096, kRaise = 4;
// Where loads are tried.
constexpr double kRise = 1.25, kMostOfLinear = 2.5, kApart = 1.02, kJustAbove = 1.01;
constexpr int kMostTries = 10, kMostFailures = 2;
constexpr int kPatience = 1;  // steps on a way to rest
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

Vec3 centroid(const RunResult& result, Index e) {
  Vec3 sum = Vec3::Zero();
  for (const Index node : result.problem->mesh().tets[e])
    sum += result.problem->mesh().nodes[node] / 4;
  return sum;
}

/// One step under `factor` times the plan's forces.
struct Trial {
  RunResult result;
  std::optional<CriticalLoad> found;  ///< where ratios say that it begins; none: nothing broke
};

Trial try_load(const Laboratory& lab, RunPlan plan, double factor, bool growth) {
  plan.load *= factor;
  Trial trial{lab.run(one_event(lab, plan)), std::nullopt};
  const std::vector<DestroyedElement> rows = trial.result.fractures();
  if (rows.empty() || (growth && rows.front().cause != Cause::sif)) return trial;
  const DestroyedElement& first = rows.front();
  const double less = first.cause == Cause::sif ? 1 / std::sqrt(*first.ratio) : 1 / *first.ratio;
  const BoardPlane& plane = trial.result.plane;
  trial.found = CriticalLoad{factor * less,
                             first.cause,
                             first.sif,
                             0,
                             plane.edge_length,
                             first.element,
                             centroid(trial.result, first.element)};
  if (first.sif) {
    scale(*trial.found->sif, less);
    trial.found->rise_deg = rise(lab, plan, plane, first.crack, first.sif->theta);
  }
  return trial;
}

std::optional<CriticalLoad> raised(const Laboratory& lab, const RunPlan& plan, bool growth) {
  for (double raise = 1; raise <= kMostLoad; raise *= kRaise)
    if (Trial trial = try_load(lab, plan, raise, growth); trial.found) return trial.found;
  return std::nullopt;
}

/// Loads, in units of the plan's forces, between which something breaks first.
struct Bracket {
  double rests = 0;
  std::optional<double> breaks;  ///< or bears no equilibrium
  std::optional<CriticalLoad> best;

  [[nodiscard]] bool closed() const {
    return breaks && (*breaks <= kApart * rests || (best && *breaks <= kApart * best->factor));
  }
  /// Just above where the last ratios say, or half way.
  [[nodiscard]] double next() const {
    const double guess = best ? kJustAbove * best->factor : 0;
    return guess > rests && guess < *breaks ? guess : 0.5 * (rests + *breaks);
  }
};

std::optional<CriticalLoad> searched(const Laboratory& lab, const RunPlan& plan, bool growth) {
  const auto linear = raised(lab.with_law(MaterialLaw::linear), plan, growth);
  if (!linear) return std::nullopt;
  Bracket bracket;
  double load = linear->factor;
  int failures = 0;
  for (int i = 0; i < kMostTries && load <= kMostOfLinear * linear->factor; ++i) {
    const Trial trial = try_load(lab, plan, load, growth);
    if (trial.found) bracket.best = trial.found;
    const bool broke = trial.found || !trial.result.failure.empty();
    if (broke)
      bracket.breaks = load;
    else
      bracket.rests = load;
    failures += trial.result.failure.empty() ? 0 : 1;
    if (bracket.closed() || failures == kMostFailures) break;
    load = bracket.breaks ? bracket.next() : kRise * load;
  }
  if (bracket.best) bracket.best->factor = std::max(bracket.best->factor, bracket.rests);
  return bracket.best;
}

std::optional<CriticalLoad> first_rupture(const Laboratory& lab, RunPlan plan, bool growth) {
  plan.snapshots.clear();
  return lab.linear() ? raised(lab, plan, growth) : searched(lab, plan, growth);
}

}  // namespace

RunPlan one_event(const Laboratory& lab, RunPlan plan) {
  plan.overrides.emplace_back("fracture.max_events=1");
  if (lab.linear()) {
    plan.overrides.emplace_back("time.steps=1");
    return plan;
  }
  // The last step of a scene would wait for rest far longer.
  plan.patience = kPatience;
  plan.until = 1;
  plan.overrides.push_back("time.steps=" + std::to_string(kPatience + 1));
  const std::size_t tools = lab.scene(plan).instruments.size();
  for (std::size_t i = 0; i < tools; ++i)
    plan.overrides.push_back("instrument." + std::to_string(i) + ".ramp=[0,0]");
  return plan;
}

std::optional<CriticalLoad> critical_load(const Laboratory& lab, RunPlan plan) {
  return first_rupture(lab, std::move(plan), false);
}

std::optional<CriticalLoad> critical_growth(const Laboratory& lab, RunPlan plan) {
  return first_rupture(lab, std::move(plan), true);
}

}  // namespace sunder::app::reproduce
