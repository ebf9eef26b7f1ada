// SPDX-License-Identifier: Apache-2.0
#include "solver/stress_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "material/linear.hpp"

namespace sunder::solver {

/// |sigma|^2 <= c (sigma : eps) with c the largest eigenvalue of the elasticity of tensors, and
/// V (sigma : eps) is at most the energy u^T K u of the whole body.
double largest_stress_of_energy(const Problem& problem) {
  double largest = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    largest = std::max(largest, problem.small_strain(e).stiffest() / problem.shape(e).volume);
  }
  return std::sqrt(largest);
}

double stress_of_rounding(const Problem& problem, double largest_u) {
  double largest = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    largest = std::max(
        largest, elasticity(problem.small_strain(e)).norm() * problem.shape(e).gradient.norm());
  }
  return std::numeric_limits<double>::epsilon() / 2 * largest_u * largest;
}

}  // namespace sunder::solver
