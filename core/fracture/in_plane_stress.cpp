// SPDX-License-Identifier: Apache-2.0
#include "fracture/in_plane_stress.hpp"

#include <cmath>

#include "sunder/stress_measures.hpp"

namespace sunder::fracture {

InPlane in_plane(const Voigt& stress, const BoardPlane& plane) {
  Eigen::Matrix<double, 3, 2> axes;
  axes << plane.e1, plane.e2;
  return axes.transpose() * tensor(stress) * axes;
}

Principal principal(const InPlane& stress) {
  constexpr double kEqual = 1e-12;  // of the largest component: rounding of the averages
  const double mean = (stress(0, 0) + stress(1, 1)) / 2;
  const double half_difference = (stress(0, 0) - stress(1, 1)) / 2;
  const double shear = (stress(0, 1) + stress(1, 0)) / 2;
  const double radius = std::hypot(half_difference, shear);
  if (!(radius > kEqual * stress.cwiseAbs().maxCoeff())) return {mean + radius, Vec2::UnitY()};
  const double angle = std::atan2(shear, half_difference) / 2;  // of n1 from e1
  return {mean + radius, Vec2(std::cos(angle), std::sin(angle))};
}

}  // namespace sunder::fracture
