// SPDX-License-Identifier: Apache-2.0
// What a viewer in front of the board sees of a body's surface, back to front.
#pragma once

#include <array>
#include <vector>

#include "app/figure/pose.hpp"
#include "app/figure/surface.hpp"

namespace sunder::app {

struct VisibleFace {
  std::array<Vec2, 3> corners;  ///< in the plane, mm
  double depth;                 ///< towards the viewer, mm
  BodyFace face;
  /// Edges from corner i to i + 1 to be drawn as a lip's: its rim, and its contours (beyond them it
  /// turns away from the viewer).
  std::array<bool, 3> outlined{};
};

/// Twice the area of a triangle in the plane; positive where its corners turn counter-clockwise.
[[nodiscard]] double turn(const std::array<Vec2, 3>& corners);

/// Faces that look at the viewer, the farthest first. The elements that the linear theory turns
/// inside out show theirs from both sides, so that none of them leaves a hole like a tear's.
[[nodiscard]] std::vector<VisibleFace> visible_faces(const Mesh& mesh, const BoardPlane& plane,
                                                     const Pose& pose,
                                                     const std::vector<BodyFace>& faces);

}  // namespace sunder::app
