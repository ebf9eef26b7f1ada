// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/frame_check.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::cpu_reference {
namespace {

// What double precision promises along a crack, or a tenth of the scene's tolerance.
constexpr double kEnough = 1e-8;
// The stress that a residual is worth grows by less between full checks. Measured on boards of
// 2,000 elements over 640 fractures: on an intact base it falls to a fifth as the damage spreads,
// on a damaged one it stays within a third (tests/cpu_reference/engine/promise_test.cpp).
constexpr double kAllowance = 10;
// The deferred update refines once more when what it lacked was over this; a refinement gains three
// digits or more, and what is left after it is in the residual.
constexpr double kUnrefined = 1e-5;
// A displacement so many times that of the last full check needs another: the body has become
// softer, or a piece has come loose.
constexpr double kGrowth = 10;

/// |sigma|^2 <= c (sigma : eps) with c the largest eigenvalue of the elasticity of tensors, and
/// V (sigma : eps) is at most the energy u^T K u of the whole body.
double largest_stress_per_energy(const Problem& problem) {
  double largest = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& m = problem.material(e);
    const double c = std::max(m.young / (1 - 2 * m.poisson), m.young / (1 + m.poisson));
    largest = std::max(largest, c / problem.shape(e).volume);
  }
  return std::sqrt(largest);
}

bool proportional(std::span<const double> a, std::span<const double> b, double s) {
  return std::ranges::equal(a, b, [s](double x, double y) {
    return std::abs(x - s * y) <= 1e-15 * std::abs(x);  // a ramp's rounding
  });
}

/// a = s b, s > 0; nothing: another direction.
std::optional<double> multiple(const Load& a, const Load& b) {
  if (a.force_dofs != b.force_dofs) return std::nullopt;
  const auto ratio = [](std::span<const double> x, std::span<const double> y) {
    for (std::size_t i = 0; i < y.size(); ++i) {
      if (y[i] != 0) return x[i] / y[i];
    }
    return 0.0;
  };
  const double s = std::max(ratio(a.forces, b.forces), ratio(a.displacements, b.displacements));
  if (!(s > 0) || !proportional(a.forces, b.forces, s) ||
      !proportional(a.displacements, b.displacements, s)) {
    return std::nullopt;
  }
  return s;
}

}  // namespace

FrameCheck::FrameCheck(const Problem& problem)
    : problem_(problem), stress_of_energy_(largest_stress_per_energy(problem)) {}

void FrameCheck::checked(const Load& load, const Solution& solution, double stress, int bases) {
  load_ = load;
  solution_ = solution;
  // An exact solution says nothing about others.
  stress_of_residual_ = solution.residual > 0 ? stress / solution.residual : HUGE_VAL;
  bases_ = bases;
}

void FrameCheck::follow(const InverseRoute& route) {
  const BaseCheck& check = route.base_check();
  if (bases_ == 0 || route.bases() == bases_ || !(check.stress_of_residual > 0) ||
      !multiple(check.load, load_)) {
    return;
  }
  stress_of_residual_ = check.stress_of_residual;
  bases_ = route.bases();
}

std::optional<double> FrameCheck::scale_of(const Load& load, const InverseRoute& route) const {
  if (route.bases() != bases_) return std::nullopt;
  return multiple(load, load_);
}

double FrameCheck::enough(double scale) const {
  const double e = kUnrefined * scale * solution_.largest_stress / stress_of_energy_;
  return e * e;
}

std::optional<double> FrameCheck::error(double scale, const Solution& solution) const {
  if (!(solution.largest_u <= kGrowth * scale * solution_.largest_u)) return std::nullopt;
  const double error =
      kAllowance * stress_of_residual_ * solution.residual / solution.largest_stress;
  if (!(error <= std::min(kEnough, problem_.scene().solver.tolerance / 10))) return std::nullopt;
  return error;
}

}  // namespace sunder::cpu_reference
