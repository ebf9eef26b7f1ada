// SPDX-License-Identifier: Apache-2.0
// What a figure shows besides the body: instruments, crack paths, supports, scale and caption.
#pragma once

#include <string>
#include <vector>

#include "app/figure/canvas.hpp"
#include "app/figure/pose.hpp"
#include "app/figure/shading.hpp"
#include "app/figure/surface.hpp"

namespace sunder::app {

/// An instrument's force, in the plane [mm].
struct Arrow {
  Vec2 from, to;
  std::vector<Vec2> dots;  ///< where its nodes are drawn
};

/// Lengths are in proportion to the forces, the longest a fixed share of the body. Instruments
/// that do not act have none.
[[nodiscard]] std::vector<Arrow> instrument_arrows(const BoardPlane& plane, const Pose& pose,
                                                   const State& state);
[[nodiscard]] std::string draw(const std::vector<Arrow>& arrows, const Canvas& canvas);

/// Dashed bounding rectangle of the undeformed body.
[[nodiscard]] std::string undeformed_outline(const BoardPlane& plane, const Canvas& canvas);

/// Edges of the surface whose both ends a support holds.
[[nodiscard]] std::string held_edges(const Problem& problem, const BoardPlane& plane,
                                     const Pose& pose, const State& state,
                                     const std::vector<BodyFace>& faces, const Canvas& canvas);

/// Where a point of a crack is drawn, in the plane [mm]. Crack records are undeformed: the point
/// moves with the crack's destroyed elements and open faces around it, weighted by a bell of width
/// h, so that an opened crack's path runs in the middle of its opening.
[[nodiscard]] Vec2 drawn_point(const Problem& problem, const BoardPlane& plane, const Pose& pose,
                               const State& state, const Crack& crack, const Vec2& point);

/// Paths and tips of all cracks, deformed.
[[nodiscard]] std::string crack_paths(const Problem& problem, const BoardPlane& plane,
                                      const Pose& pose, const State& state, const Canvas& canvas);

[[nodiscard]] std::string color_bar(const StressScale& scale, const Canvas& canvas);

[[nodiscard]] std::string caption(const Problem& problem, const Pose& pose, const State& state,
                                  const Canvas& canvas);

}  // namespace sunder::app
