// SPDX-License-Identifier: Apache-2.0
#include "body/finite_deformation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "body/deformation.hpp"
#include "material/singular_values.hpp"

namespace sunder::fem {
namespace {

/// Angle of R = U V^T [deg]: its trace has the digits of large angles, its axial vector those of
/// small ones.
double angle_deg(const Mat3& r) {
  const Vec3 axial(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  return std::atan2(axial.norm(), r.trace() - 1) * 180 / std::numbers::pi;
}

}  // namespace

Deformation finite_deformation(const Problem& problem, std::span<const double> u,
                               const std::function<bool(Index)>& counts) {
  Deformation most;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!counts(e)) continue;
    const SingularValues f =
        singular_values(Mat3::Identity() + displacement_gradient(problem, e, u));
    for (const double stretch : f.s) {
      if (std::abs(stretch - 1) > std::abs(most.strain)) most.strain = stretch - 1;
    }
    most.rotation_deg = std::max(most.rotation_deg, angle_deg(f.u * f.v.transpose()));
    if (f.s.prod() <= 0) ++most.inverted;
  }
  return most;
}

}  // namespace sunder::fem
