// SPDX-License-Identifier: Apache-2.0
#include "solver/check_terms.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::solver {
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

std::optional<double> multiple(const Load& a, const Load& b) {
  if (a.force_dofs != b.force_dofs || a.displacements.size() != b.displacements.size()) {
    return std::nullopt;
  }
  const double s = std::max(ratio(a.forces, b.forces), ratio(a.displacements, b.displacements));
  if (!(s > 0) || !proportional(a.forces, b.forces, s) ||
      !proportional(a.displacements, b.displacements, s)) {
    return std::nullopt;
  }
  return s;
}

}  // namespace sunder::solver
