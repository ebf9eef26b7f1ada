// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_minimiser.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "material/fibres.hpp"

namespace sunder::solver {
namespace {

// Share of the slope that a step must win (Nocedal and Wright 2006, 3.1).
constexpr double kArmijo = 1e-4;
constexpr double kEnergyRounding = 1e-13;  // of an energy that is summed over all elements
constexpr double kLeastPart = 1e-7;        // of a step, before the line search gives up
constexpr double kForceRounding = 1e-14;   // of a residual: no iteration wins more
// The error of stress is looked at where the residual is not far above the tolerance: on the
// 1954-element board it is a tenth of the residual in the median.
constexpr double kResidualPerStress = 100;
// A measured contraction above the most says nothing, one below the least is luck: the next one is
// not (bench_finite_stability prints what reported errors are worth).
constexpr double kLeastContraction = 0.4, kMostContraction = 0.9;
// One good estimate ends a step of so few iterations; later ones, whose contraction wanders, have
// to be good twice in a row.
constexpr int kFewBackSolves = 2;
constexpr double kLeaving = 2;  // times the residual, against a negative stiffness
// Where the residual has grown since by more than this, small changes tell of no contraction: the
// iteration has turned into another direction, along which more may be left.
constexpr double kMostRegrown = 2;

// Of the largest shear modulus: stress that is as good as none, and what rounding may leave of it.
constexpr double kNoStress = 1e-9, kStressRounding = 1e-13;
// Nor is it more than this of the smallest one: soft tissue in a stiff frame has stress of its own,
// as long as it is some times what rounding leaves.
constexpr double kNoStressOfSoft = 1e-6, kOverRounding = 10;
// Of the sum of shear modulus and volume: an energy is what terms of that size leave.
constexpr double kSumRounding = 2e-16;

}  // namespace

FiniteScale finite_scale(const Problem& problem) {
  double stiffest = 0, softest = HUGE_VAL, sum = 0, volume = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const double shear = shear_scale(problem.small_strain(e));
    stiffest = std::max(stiffest, shear);
    softest = std::min(softest, shear);
    volume += problem.shape(e).volume;
    sum += shear * problem.shape(e).volume;
  }
  const double face = std::pow(volume / std::max(1, problem.tet_count()), 2.0 / 3);
  const double none = std::max(std::min(kNoStress * stiffest, kNoStressOfSoft * softest),
                               kOverRounding * kStressRounding * stiffest);
  return {kNoStress * stiffest * face, none, kStressRounding * stiffest * face,
          kStressRounding * stiffest, kSumRounding * sum};
}

double FiniteMinimiser::residual(const FiniteState& state) const {
  return residual({state.potential, state.r.norm(), state.acting});
}

double FiniteMinimiser::residual(const FinitePoint& at) const {
  return at.residual <= scale_.force_rounding ? 0 : at.residual / std::max(at.acting, scale_.force);
}

/// Of where the trial begins, if where it ends were right.
double FiniteMinimiser::stress_error(const FiniteTrial& trial) const {
  return trial.change / std::max(trial.largest, scale_.stress);
}

double FiniteMinimiser::energy_rounding(const FinitePoint& at) const {
  return scale_.energy_rounding + kEnergyRounding * std::abs(at.potential);
}

/// By the potential, and where rounding hides what it says by the residual.
bool FiniteMinimiser::is_better(const FinitePoint& point, const FinitePoint& than) const {
  const double rounding = energy_rounding(than);
  if (point.potential < than.potential - rounding) return true;
  return point.potential <= than.potential + rounding && point.residual < than.residual;
}

/// Halves the step from the whole of it until the potential falls; false: it does not.
bool FiniteMinimiser::line_search(FiniteSteps& steps, bool with_stress, const FinitePoint& from,
                                  FiniteTrial& trial) const {
  if (!(trial.slope < 0)) return false;
  const double slope = trial.slope;
  const double rounding = energy_rounding(from);
  for (double part = 1; part > kLeastPart; part /= 2) {
    if (part < 1) trial = steps.part(part, with_stress);
    if (trial.at.potential <= from.potential + kArmijo * part * slope + rounding) return true;
  }
  return false;
}

FiniteMinimiser::Result FiniteMinimiser::minimise(const FiniteTarget& target, FiniteBase* base,
                                                  const Stop& stop, int most, FiniteState& state) {
  FiniteDevice* device = potential_.device();
  const auto needs = device ? device->needs() : FiniteDevice::Needs::host;
  const bool there = needs == FiniteDevice::Needs::nothing ||
                     (needs == FiniteDevice::Needs::inverse && base->has_inverse());
  FiniteSteps& steps = there ? *device : static_cast<FiniteSteps&>(host_);
  const FinitePoint from = steps.begin(target, base, state);
  const Result result = minimise(steps, stop, most, from);
  steps.end();
  return result;
}

FiniteMinimiser::Result FiniteMinimiser::minimise(FiniteSteps& steps, const Stop& stop, int most,
                                                  FinitePoint at) const {
  Result result;
  double before = 0;                       // error of the last state but one
  double ratio_before = 0;                 // of that to the one before
  bool good = false, good_before = false;  // the last two estimates
  bool rounding = false;                   // may be all that the last one is
  double least = HUGE_VAL;                 // residual so far
  for (;;) {
    result.residual = residual(at);
    if (!std::isfinite(result.residual)) return result;
    if (result.residual <= kForceRounding ||
        (stop.tolerance == 0 && result.residual <= stop.residual)) {
      result.at_rest = true;
      result.error = 0;  // rounding, or not asked for
      return result;
    }
    if (result.back_solves == most) {  // one good estimate may be luck here too
      result.at_rest =
          good && (good_before || most <= kFewBackSolves) && result.residual <= stop.residual;
      return result;
    }
    least = std::min(least, result.residual);
    const bool near =
        stop.tolerance > 0 && result.residual <= std::min(1.0, kResidualPerStress * stop.tolerance);
    FiniteTrial trial = steps.whole(near);
    ++result.back_solves;
    if (near && !std::isfinite(trial.at.potential)) {
      // Beyond what the law knows: such a change of stress says nothing.
      before = ratio_before = 0;
      good = good_before = rounding = false;
    } else if (near) {
      const double change = stress_error(trial);
      const double ratio = before > 0 ? change / before : kLeastContraction;
      result.contraction =
          std::clamp(std::max(ratio, ratio_before), kLeastContraction, kMostContraction);
      result.error = change / (1 - result.contraction);
      rounding = trial.change <= scale_.stress_rounding;
      // What rounding may leave is that once it falls no more.
      if (rounding && before > 0 && ratio > kMostContraction) result.error = 0;
      before = change;
      ratio_before = ratio;
      good_before =
          std::exchange(good, result.error <= stop.tolerance && result.residual <= stop.residual &&
                                  (result.error == 0 || result.residual <= kMostRegrown * least));
      if (good && (good_before || result.back_solves <= kFewBackSolves)) {
        const bool better = is_better(trial.at, at);
        // A base that overshoots so small a step is not to leave the body where it drifts.
        if (!stop.takes_last || better || good_before) {
          result.at_rest = true;
          if (stop.takes_last && better) {
            steps.take();
            result.residual = residual(trial.at);
          }
          return result;
        }
      }
    }
    if (!line_search(steps, near, at, trial)) {
      result.at_rest = near && (good || (rounding && result.residual <= stop.residual));
      if (result.at_rest && rounding) result.error = 0;  // nothing better is to be had
      return result;
    }
    // An unstable rest is left by what rounding has put into it: let who calls choose the side.
    if ((good || good_before) && trial.winding < 0 && trial.at.residual > kLeaving * at.residual) {
      return result;
    }
    steps.take();
    at = trial.at;
  }
}

}  // namespace sunder::solver
