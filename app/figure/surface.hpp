// SPDX-License-Identifier: Apache-2.0
// Which triangles of a damaged body can be seen: the surface of what is live, with the lips of its
// tears, and of what is destroyed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder::app {

/// A face of a tetrahedron, nodes ordered so that the normal points out of it.
struct BodyFace {
  std::array<Index, 3> nodes;
  Index tet;
  bool lip = false;  ///< a destroyed element lay on its other side, or a crack has split it off
  std::array<bool, 3>
      rim{};  ///< edge from node i to node i + 1: a lip meets the body's surface there
};

using Edge = std::array<Index, 2>;  ///< nodes, ascending

/// From node i of a face to node i + 1.
[[nodiscard]] Edge edge(const BodyFace& face, int i);

/// Neighbours of all tetrahedra across their faces; built once per mesh.
class FaceTable {
 public:
  explicit FaceTable(const Mesh& mesh);
  /// Of a body that split cracks have opened: faces that were joined in `intact` are lips.
  FaceTable(const Mesh& split, const FaceTable& intact);

  /// Faces of live elements with nothing, or a destroyed element, on the other side.
  [[nodiscard]] std::vector<BodyFace> surface(std::span<const std::uint8_t> destroyed) const;
  /// Faces of destroyed elements with nothing, or a live element, on the other side.
  [[nodiscard]] std::vector<BodyFace> removed(std::span<const std::uint8_t> destroyed) const;

 private:
  [[nodiscard]] std::vector<BodyFace> border(std::span<const std::uint8_t> destroyed,
                                             bool of_destroyed) const;

  const Mesh& mesh_;
  std::vector<std::array<Index, 4>> neighbour_;  ///< kNone: outside
  std::vector<std::array<Index, 4>> intact_;     ///< before cracks split the body; empty: likewise
};

}  // namespace sunder::app
