// SPDX-License-Identifier: Apache-2.0
// Geometry of a crack's path and its two faces (method.md 4, 5, 7).
#pragma once

#include <span>

#include "sunder/crack.hpp"
#include "sunder/types.hpp"

namespace sunder::fracture {

/// a [mm]: path length of an edge crack, half of it for an internal one.
[[nodiscard]] double crack_length(const Crack& crack);

struct PathPoint {
  Vec2 position;
  Vec2 direction;  ///< unit, along the path
};

/// Where a crack's normal is taken and its stations begin: the mouth, or the path's middle.
[[nodiscard]] PathPoint crack_origin(const Crack& crack);

/// +1 when p lies left of a path (seen from mouth or first tip), -1 right of it, 0 on it (within
/// `tolerance`, mm). The end segments are prolonged.
[[nodiscard]] int path_side(std::span<const Vec2> path, const Vec2& p, double tolerance);
[[nodiscard]] inline int path_side(const Crack& crack, const Vec2& p, double tolerance) {
  return path_side(std::span<const Vec2>(crack.path), p, tolerance);
}

/// n_up: unit normal at the crack's origin with n_up . e2 > 0, or n_up . e1 > 0 when the crack
/// stands upright (|n_up . e2| < 0.1).
[[nodiscard]] Vec2 upward_normal(const Crack& crack);

/// The upper face as a side label: +1 when n_up points to the left of the path.
[[nodiscard]] int upper_side(const Crack& crack);

/// +1 when the tip moves along the path, -1 for the first tip of an internal crack: what is left
/// of that tip is right of the path.
[[nodiscard]] inline int orientation(const Crack& crack, std::size_t tip) {
  return crack.kind == CrackKind::internal && tip == 0 ? -1 : 1;
}

/// Moves a tip by `advance` [mm] along unit direction g.
void advance_tip(Crack& crack, std::size_t tip, const Vec2& g, double advance);

}  // namespace sunder::fracture
