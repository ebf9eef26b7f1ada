// SPDX-License-Identifier: Apache-2.0
// In-plane part of a stress and its principal values and directions (method.md 4, 5).
#pragma once

#include <Eigen/Core>

#include "sunder/board_plane.hpp"
#include "sunder/types.hpp"

namespace sunder::fracture {

using InPlane = Eigen::Matrix2d;  ///< components along e1, e2 [MPa]

[[nodiscard]] InPlane in_plane(const Voigt& stress, const BoardPlane& plane);

struct Principal {
  double s1 = 0;            ///< the larger in-plane principal stress [MPa]
  Vec2 n1 = Vec2::UnitY();  ///< its unit direction, up to sign; e2 when both are equal
};

/// Principals closer than 1e-12 of the tensor's size are equal: n1 = e2, so that a crack born
/// there runs along e1 (method.md 4).
[[nodiscard]] Principal principal(const InPlane& stress);

}  // namespace sunder::fracture
