// SPDX-License-Identifier: Apache-2.0
#include "solver/frame_check.hpp"

#include <algorithm>
#include <cmath>

#include "solver/check_terms.hpp"
#include "solver/load_room.hpp"
#include "solver/stress_bounds.hpp"

namespace sunder::solver {
namespace {

// The stress that a residual is worth grows by less between full checks. Measured on boards of
// 2,000 elements over 640 fractures: on an intact base it falls to a fifth as the damage spreads,
// on a damaged one it stays within a third (tests/cpu_reference/frames/promise_test.cpp).
constexpr double kAllowance = 10;
// The deferred update refines once more when what it lacked was over this; a refinement gains three
// digits or more, and what is left after it is in the residual.
constexpr double kUnrefined = 1e-5;
// A displacement so many times that of the last full check needs another: the body has become
// softer, or a piece has come loose.
constexpr double kGrowth = 10;

}  // namespace

FrameCheck::FrameCheck(const Problem& problem, double promised)
    : promised_(std::min(promised, problem.scene().solver.tolerance / 10)),
      stress_of_energy_(solver::largest_stress_of_energy(problem)) {
  reserve(load_, problem);
}

void FrameCheck::checked(const Load& load, const Solution& solution, double stress, int bases) {
  load_ = load;
  solution_ = solution;
  // An exact solution says nothing about others.
  stress_of_residual_ = solution.residual > 0 ? stress / solution.residual : HUGE_VAL;
  bases_ = bases;
}

void FrameCheck::follow(int bases, const BaseCheck& check) {
  if (bases_ == 0 || bases == bases_ || !(check.stress_of_residual > 0) ||
      !multiple(check.load, load_)) {
    return;
  }
  stress_of_residual_ = check.stress_of_residual;
  bases_ = bases;
}

std::optional<double> FrameCheck::scale_of(const Load& load, int bases) const {
  if (bases != bases_) return std::nullopt;
  return multiple(load, load_);
}

double FrameCheck::energy_tolerance(double scale) const {
  const double e = kUnrefined * scale * solution_.largest_stress / stress_of_energy_;
  return e * e;
}

std::optional<double> FrameCheck::error(double scale, const Solution& solution) const {
  if (!(solution.largest_u <= kGrowth * scale * solution_.largest_u)) return std::nullopt;
  const double error =
      kAllowance * stress_of_residual_ * solution.residual / solution.largest_stress;
  if (!(error <= promised_)) return std::nullopt;
  return error;
}

}  // namespace sunder::solver
