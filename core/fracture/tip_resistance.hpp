// SPDX-License-Identifier: Apache-2.0
// What the tissue round a tip opposes to a crack, by the direction in which it would grow.
#pragma once

#include "sunder/board_plane.hpp"
#include "sunder/types.hpp"

namespace sunder::fracture {

struct TipResistance {
  double along = 0;            ///< mean K_c^2 of cracks along the fibres [MPa^2 mm]
  Mat3 across = Mat3::Zero();  ///< n . across n: what growth with the normal n takes beyond that
  const BoardPlane* plane = nullptr;

  /// K_c^2 of growth along a direction of the plane [MPa^2 mm].
  [[nodiscard]] double squared(const Vec2& direction) const {
    const Vec3 n = plane->lift_direction({-direction.y(), direction.x()});
    return along + n.dot(across * n);
  }
};

}  // namespace sunder::fracture
