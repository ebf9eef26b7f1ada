// SPDX-License-Identifier: Apache-2.0
#include "fracture/geometry_factor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunder::fracture {
namespace {

constexpr double kPolynomialEnd = 0.6;

double clamped(double x) { return std::clamp(x, 0.0, kLargestRelativeLength); }

}  // namespace

double edge_factor_polynomial(double x) {
  return 1.12 + x * (-0.231 + x * (10.55 + x * (-21.72 + x * 30.39)));
}

double edge_factor_tada(double x) {
  const double angle = std::numbers::pi * x / 2;
  const double slack = 1 - std::sin(angle);
  return std::sqrt(std::tan(angle) / angle) * (0.752 + 2.02 * x + 0.37 * slack * slack * slack) /
         std::cos(angle);
}

double edge_factor(double x) {
  x = clamped(x);
  return x <= kPolynomialEnd ? edge_factor_polynomial(x) : edge_factor_tada(x);
}

double internal_factor(double x) {
  x = clamped(x);
  const double x2 = x * x;
  return std::sqrt(1 / std::cos(std::numbers::pi * x / 2)) * (1 - 0.025 * x2 + 0.06 * x2 * x2);
}

}  // namespace sunder::fracture
