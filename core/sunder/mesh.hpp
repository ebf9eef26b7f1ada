// SPDX-License-Identifier: Apache-2.0
// Tetrahedral mesh with named volumes and surfaces. Coordinates in mm.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sunder/types.hpp"

namespace sunder {

struct NamedVolume {
  std::string name;
  int tag = 0;  ///< physical tag of the mesh file, written to result files
};

/// A named set of boundary (or inner) triangles; used to select nodes.
struct NamedSurface {
  std::string name;
  int tag = 0;
  std::vector<std::array<Index, 3>> triangles;
};

struct Mesh {
  std::vector<Vec3> nodes;
  std::vector<std::array<Index, 4>> tets;  ///< positive volume: (x1-x0) x (x2-x0) . (x3-x0) > 0
  std::vector<Index> volume_of;            ///< per tet: index into `volumes`
  std::vector<NamedVolume> volumes;
  std::vector<NamedSurface> surfaces;
  std::map<std::string, std::vector<Vec3>> fields;  ///< vectors per tet, by name

  [[nodiscard]] Index node_count() const { return static_cast<Index>(nodes.size()); }
  [[nodiscard]] Index tet_count() const { return static_cast<Index>(tets.size()); }
};

/// A triangle that belongs to exactly one tetrahedron, nodes ordered so that the normal
/// (x1-x0) x (x2-x0) points out of the body.
struct FreeFace {
  std::array<Index, 3> nodes;
  Index tet;
};

/// All free faces, ordered by tetrahedron and local face.
[[nodiscard]] std::vector<FreeFace> free_faces(const Mesh& mesh);

/// Throws InputError when the mesh has no tetrahedra, an id out of range, a coordinate that is not
/// finite, a repeated node, an inverted or a zero-volume element (named by its id), or two volumes
/// of one name. `where` (a file name, say) begins the message.
void validate(const Mesh& mesh, const std::string& where);

/// Swaps two corners of every element of negative volume; its id, place and nodes stay. Returns how
/// many there were, and the first. Elements that validate() refuses otherwise stay as they are.
struct Turned {
  Index count = 0;
  Index first = kNone;
};
Turned turn_inverted(Mesh& mesh);
/// The warning.
[[nodiscard]] std::string sentence(const Turned& turned);

/// Per node: 1 where a tetrahedron uses it.
[[nodiscard]] std::vector<std::uint8_t> used_nodes(const Mesh& mesh);

/// Removes nodes that no tetrahedron uses (ids close up, order kept; surface triangles that use
/// one are dropped) and returns how many there were.
Index drop_unused_nodes(Mesh& mesh);

}  // namespace sunder
