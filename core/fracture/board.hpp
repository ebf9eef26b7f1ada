// SPDX-License-Identifier: Apache-2.0
// The undeformed body as cracks see it: its projection on the board's plane, who touches whom, and
// which faces are free (method.md 4, 7). Built once; queries cost what they return.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "body/node_elements.hpp"
#include "fracture/point_grid.hpp"
#include "sunder/board_plane.hpp"
#include "sunder/mesh.hpp"

namespace sunder::fracture {

/// Free faces are lateral when |normal . e3| is under this, else they lie on the top or the bottom
/// surface (method.md 4).
inline constexpr double kLateralNormal = 0.5;

class Board {
 public:
  Board(const Mesh& mesh, const std::optional<Vec3>& plane_normal);

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] const BoardPlane& plane() const { return plane_; }
  [[nodiscard]] double h() const { return plane_.edge_length; }
  [[nodiscard]] Vec2 node(Index n) const { return plane_.project(mesh_.nodes[n]); }
  [[nodiscard]] const Vec2& centroid(Index e) const { return centroids_.points()[e]; }
  [[nodiscard]] std::span<const Index> elements_of(Index n) const { return around_.of(n); }
  /// Elements whose projected centroid is at most `radius` from p, ascending, in place of what
  /// `elements` held.
  void elements_within(const Vec2& p, double radius, std::vector<Index>& elements) const {
    centroids_.within(p, radius, elements);
  }
  /// No neighbourhood of that radius has more elements than this.
  [[nodiscard]] std::size_t most_within(double radius) const {
    return centroids_.most_within(radius);
  }
  /// Mean projected length of an element's edges [mm]; h is the mean of all.
  [[nodiscard]] double edge_length(Index e) const;
  /// Largest distance between an element's projected centroid and one of its nodes [mm].
  [[nodiscard]] double largest_element() const { return largest_element_; }
  struct LateralFace {
    Index tet;
    Vec2 centroid;  ///< projected
  };
  /// The lateral free faces of element e.
  [[nodiscard]] std::span<const LateralFace> lateral_faces(Index e) const;
  [[nodiscard]] bool on_bottom(Index n) const { return surface_[n] & kBottom; }
  [[nodiscard]] bool on_top(Index n) const { return surface_[n] & kTop; }

 private:
  static constexpr std::uint8_t kBottom = 1, kTop = 2;

  void sort_free_faces();

  const Mesh& mesh_;
  BoardPlane plane_;
  NodeElements around_;
  PointGrid centroids_;
  double largest_element_ = 0;
  std::vector<LateralFace> lateral_;   // by tet
  std::vector<std::uint8_t> surface_;  // shape (nodes)
};

}  // namespace sunder::fracture
