// SPDX-License-Identifier: Apache-2.0
#include "solver/frame_check.hpp"

#include <algorithm>
#include <cmath>

#include "solver/stress_bounds.hpp"

namespace sunder::solver {
namespace {

// The stress that a residual is worth grows by less between full checks. Measured on boards of
// 2,000 elements over 640 fractures: on an intact base it falls to a fifth as the damage spreads,
// on a damaged one it stays within a third (tests/cpu_reference/frames/promise_test.cpp).
constexpr double kAllowance = 10;
// While no event comes only the shares of the loads change: their residuals lie elsewhere.
constexpr double kSpread = 3;
// The deferred update refines once more when what it lacked was over this; a refinement gains three
// digits or more, and what is left after it is in the residual.
constexpr double kUnrefined = 1e-5;
// A displacement so many times that of the last full check needs another: the body has become
// softer, or a piece has come loose.
constexpr double kGrowth = 10;

}  // namespace

FrameCheck::FrameCheck(const Problem& problem, double promised)
    : promised_(std::min(promised, problem.scene().solver.tolerance / 10)),
      stress_of_energy_(solver::largest_stress_of_energy(problem)),
      known_(problem) {}

void FrameCheck::checked(const Load& load, const Solution& solution, double stress, int bases) {
  // An exact solution says nothing about others.
  const double worth = solution.residual > 0 ? stress / solution.residual : HUGE_VAL;
  known_.checked(
      load, {stress / solution.largest_stress, worth, solution.largest_u, solution.largest_stress},
      bases);
}

double FrameCheck::energy_tolerance(const CheckedLoads::Sum& expected) const {
  const double e = kUnrefined * expected.largest_stress / stress_of_energy_;
  return e * e;
}

std::optional<double> FrameCheck::error(const CheckedLoads::Sum& expected,
                                        const Solution& solution) const {
  if (!(solution.largest_u <= kGrowth * expected.largest_u)) return std::nullopt;
  const bool cancels = !(expected.largest_stress <= kGrowth * solution.largest_stress);
  if (cancels && !expected.alone) return std::nullopt;
  const double error = (expected.fresh() ? kSpread : kAllowance) * expected.stress_of_residual *
                       solution.residual / solution.largest_stress;
  if (!(error <= promised_)) return std::nullopt;
  return error;
}

}  // namespace sunder::solver
