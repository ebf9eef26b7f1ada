// SPDX-License-Identifier: Apache-2.0
#include "fracture/stress_intensity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunder::fracture {

using std::numbers::pi;

double expansion_intensity(double factor, double cos_beta, double s0, double a) {
  return factor * cos_beta * cos_beta * std::max(s0, 0.0) * std::sqrt(pi * a);
}

double balanced_intensity(double upper, double lower, double distance) {
  return 2 * std::min(upper, lower) / std::sqrt(2 * pi * distance);
}

double one_sided_intensity(double upper, double lower, double distance) {
  return std::abs(upper - lower) / std::sqrt(2 * pi * distance);
}

double pressure_sign(const Vec3& opening, const Vec3& resultant) {
  constexpr double kNeither = 1e-9;  // of |resultant|
  const double along = opening.dot(resultant);
  return along < -kNeither * resultant.norm() ? -1.0 : 1.0;
}

double total_intensity(double k_a, double k_b, double k_c, double sign) {
  return std::max(k_a + k_b + sign * k_c, 0.0);
}

double growth_angle(const Vec2& d, const Vec2& v) {
  const double angle = std::atan2(d.x() * v.y() - d.y() * v.x(), d.dot(v));
  return std::clamp(angle, -pi / 2, pi / 2);
}

double zone_shape(double theta) {
  const double half = std::abs(theta) / 2;
  const double shape = std::cos(half) * (1 + std::sin(half));
  return shape * shape;
}

double reach(double k, double yield, double theta) {
  return k * k / (2 * pi * yield * yield) * zone_shape(theta);
}

Vec2 turned(const Vec2& d, double theta) {
  if (theta == 0) return d;
  const double c = std::cos(theta), s = std::sin(theta);
  return Vec2(c * d.x() - s * d.y(), s * d.x() + c * d.y()).normalized();
}

}  // namespace sunder::fracture
