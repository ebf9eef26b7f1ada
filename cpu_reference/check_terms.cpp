// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/check_terms.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::cpu_reference {
namespace {

bool proportional(std::span<const double> a, std::span<const double> b, double s) {
  return std::ranges::equal(a, b, [s](double x, double y) {
    return std::abs(x - s * y) <= 1e-15 * std::abs(x);  // a ramp's rounding
  });
}

/// By the first entry of b that is not 0.
double ratio(std::span<const double> a, std::span<const double> b) {
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (b[i] != 0) return a[i] / b[i];
  }
  return 0.0;
}

}  // namespace

/// |sigma|^2 <= c (sigma : eps) with c the largest eigenvalue of the elasticity of tensors, and
/// V (sigma : eps) is at most the energy u^T K u of the whole body.
double largest_stress_of_energy(const Problem& problem) {
  double largest = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& m = problem.material(e);
    const double c = std::max(m.young / (1 - 2 * m.poisson), m.young / (1 + m.poisson));
    largest = std::max(largest, c / problem.shape(e).volume);
  }
  return std::sqrt(largest);
}

std::optional<double> multiple(const Load& a, const Load& b) {
  if (a.force_dofs != b.force_dofs) return std::nullopt;
  const double s = std::max(ratio(a.forces, b.forces), ratio(a.displacements, b.displacements));
  if (!(s > 0) || !proportional(a.forces, b.forces, s) ||
      !proportional(a.displacements, b.displacements, s)) {
    return std::nullopt;
  }
  return s;
}

}  // namespace sunder::cpu_reference
