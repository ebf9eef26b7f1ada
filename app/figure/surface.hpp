// SPDX-License-Identifier: Apache-2.0
// Which triangles of a damaged body can be seen: the surface of what is live, and of what is
// destroyed.
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
};

/// Neighbours of all tetrahedra across their faces; built once per mesh.
class FaceTable {
 public:
  explicit FaceTable(const Mesh& mesh);

  /// Faces between live and destroyed (from both sides) or live or destroyed and outside.
  [[nodiscard]] std::vector<BodyFace> surface(std::span<const std::uint8_t> destroyed) const;

 private:
  const Mesh& mesh_;
  std::vector<std::array<Index, 4>> neighbour_;  ///< kNone: outside
};

}  // namespace sunder::app
