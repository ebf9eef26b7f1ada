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

std::optional<double> FrameCheck::scale_of(const Load& load, const InverseRoute& route) const {
  if (route.bases() != bases_ || load.force_dofs != load_.force_dofs) return std::nullopt;
  const auto ratio = [](std::span<const double> a, std::span<const double> b) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (b[i] != 0) return a[i] / b[i];
    }
    return 0.0;
  };
  const double s =
      std::max(ratio(load.forces, load_.forces), ratio(load.displacements, load_.displacements));
  if (!(s > 0) || !proportional(load.forces, load_.forces, s) ||
      !proportional(load.displacements, load_.displacements, s)) {
    return std::nullopt;
  }
  return s;
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
