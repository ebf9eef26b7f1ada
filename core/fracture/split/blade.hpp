// SPDX-License-Identifier: Apache-2.0
// What a blade opens of a body that splits: faces between elements on both sides of it, and the
// path of a crack through what has opened (method.md "Split cracks").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/face.hpp"
#include "fracture/split/split_body.hpp"

namespace sunder::fracture {

/// Shut faces between two elements that the triangles of a blade pass between: the straight line
/// between both centroids meets a triangle. The element on the side to which the first triangle's
/// normal points has the face; a centroid on the blade is on that side. `places`: of all nodes, new
/// ones too, as the body is deformed [mm]. Elements marked in `gone` have no faces. A few elements,
/// all of which the blade passes through, do not come loose by it: their faces stay shut. The
/// triangles must be finite; one without an area passes nothing.
[[nodiscard]] std::vector<PassedFace> passed_faces(const Problem& problem, const SplitBody& body,
                                                   std::span<const std::array<Vec3, 3>> blade,
                                                   std::span<const Vec3> places,
                                                   std::span<const std::uint8_t> gone);

/// Faces in groups that hang together by nodes of the mesh, by their first ones.
[[nodiscard]] std::vector<std::vector<PassedFace>> sheets(const SplitBody& body,
                                                          std::span<const PassedFace> faces);

/// The line along which the blade has passed a sheet, in the board's plane: at least two points,
/// from one end of it to the other; the elements that have the faces lie left of it.
[[nodiscard]] std::vector<Vec2> path_through(const Board& board, const SplitBody& body,
                                             std::span<const PassedFace> sheet);

/// Whether all faces lie as the blade does, in the deformed body.
[[nodiscard]] bool follow_blade(const SplitBody& body, std::span<const PassedFace> faces,
                                std::span<const std::array<Vec3, 3>> blade,
                                std::span<const Vec3> places);

/// Whether faces lie along the board's plane more than they stand on it.
[[nodiscard]] bool lies_flat(const Board& board, const SplitBody& body,
                             std::span<const PassedFace> sheet);

}  // namespace sunder::fracture
