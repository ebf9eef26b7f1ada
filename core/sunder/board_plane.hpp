// SPDX-License-Identifier: Apache-2.0
// The plane in which cracks live (method.md "Model B"): axes, outline, mean edge length h and
// thickness of the undeformed body. Figures and result files use it to place crack records.
#pragma once

#include <optional>

#include "sunder/mesh.hpp"
#include "sunder/types.hpp"

namespace sunder {

struct BoardPlane {
  Vec3 e1, e2, e3;                ///< unit, orthogonal; e1, e2 span the plane
  Vec2 outline_min, outline_max;  ///< bounding rectangle of the projection [mm]
  double bottom = 0, top = 0;     ///< extent along e3 [mm]
  double edge_length = 0;         ///< h [mm], mean projected edge length over all elements

  [[nodiscard]] double thickness() const { return top - bottom; }
  [[nodiscard]] Vec2 project(const Vec3& x) const { return {x.dot(e1), x.dot(e2)}; }
  /// An in-plane point as a point of space at mid-thickness.
  [[nodiscard]] Vec3 lift(const Vec2& p) const {
    return p.x() * e1 + p.y() * e2 + (bottom + top) / 2 * e3;
  }
  /// An in-plane direction as a direction in space.
  [[nodiscard]] Vec3 lift_direction(const Vec2& d) const { return d.x() * e1 + d.y() * e2; }
  /// Distance from p to the outline [mm]; negative outside.
  [[nodiscard]] double inside(const Vec2& p) const;
  /// Length of the whole chord of the outline through p along d [mm]; 0 when the line misses it.
  [[nodiscard]] double chord(const Vec2& p, const Vec2& d) const;
};

/// e1, e2: longest and second longest axis of the bounding box (ties: x before y before z), unless
/// `normal` is given. Throws InputError for a normal that is zero or not finite.
[[nodiscard]] BoardPlane board_plane(const Mesh& mesh, const std::optional<Vec3>& normal);

}  // namespace sunder
