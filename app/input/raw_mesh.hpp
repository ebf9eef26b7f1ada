// SPDX-License-Identifier: Apache-2.0
// A mesh as it was read, with the file's tags; and its way through the pipe from gmsh.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder::app {

struct RawGroup {
  int dimension = 0;
  int tag = 0;
  std::string name;  ///< "" when the file gives none
};

struct RawMesh {
  std::vector<std::uint64_t> node_tags;
  std::vector<double> coordinates;  ///< 3 per node
  std::vector<std::uint64_t> tet_tags;
  std::vector<std::uint64_t> tet_nodes;      ///< 4 corners per tetrahedron
  std::vector<int> tet_group;                ///< physical tag, 0: none
  std::vector<std::uint64_t> triangle_tags;  ///< of surfaces with a physical group
  std::vector<std::uint64_t> triangle_nodes;
  std::vector<int> triangle_group;
  std::vector<RawGroup> groups;  ///< of dimension 2 and 3
  std::uint64_t curved = 0;      ///< tetrahedra with more than four nodes in the file
  std::uint64_t other_solids = 0;
  std::string other_name;  ///< of the first of the other solids: "Hexahedron 8", ...
  std::map<std::string, std::vector<Vec3>> fields;  ///< Mesh::fields; not in the pipe
};

[[nodiscard]] std::string to_bytes(const RawMesh& mesh);
/// nullopt when the bytes are not those of a RawMesh.
[[nodiscard]] std::optional<RawMesh> from_bytes(std::string_view bytes);

/// Nodes and elements as they come, volumes and surfaces by tag. Drops unused nodes, validates.
/// Throws InputError; `name` begins messages.
[[nodiscard]] Mesh to_mesh(const RawMesh& raw, const std::string& name,
                           std::vector<std::string>* warnings);

/// Groups of the tetrahedra from elsewhere: tags[i] is that of the one with the i-th smallest tag.
/// Nothing happens when the numbers differ.
void set_groups_in_order(RawMesh& mesh, const std::vector<int>& tags);

}  // namespace sunder::app
