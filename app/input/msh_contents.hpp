// SPDX-License-Identifier: Apache-2.0
// What has been read of a .msh file so far, and which element belongs to which volume or surface.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/input/raw_mesh.hpp"

namespace sunder::app {

/// One of gmsh's numbered element types.
struct MshType {
  enum class Shape { other, triangle, tetrahedron, hexahedron, prism, pyramid };
  int nodes = 0;
  Shape shape = Shape::other;

  [[nodiscard]] bool solid() const { return shape > Shape::triangle; }
  [[nodiscard]] std::string name() const;  ///< of a solid: "Hexahedron 8", as gmsh has it
};

constexpr int kLastMshType = 31;
constexpr std::size_t kMostMshNodes = 56;
/// nullptr when the number is not known.
[[nodiscard]] const MshType* msh_type(int number);

struct MshElement {
  std::uint64_t tag = 0;
  MshType type;
  std::span<const std::uint64_t> nodes;
  std::span<const int> groups;  ///< physical groups, ascending
  int entity = 0;               ///< of the geometry
};

struct MshContents {
  RawMesh mesh;
  std::vector<std::uint64_t> element_tags;  ///< of all elements, in the order of the file
  std::vector<int> tet_entity;
  std::set<int> volume_entities;
  /// Version 4.1: physical groups, ascending, by dimension and tag of the entity.
  std::map<std::pair<int, int>, std::vector<int>> groups_of_entity;
  bool grouped = false;  ///< 1, 2.2: an element has a group; 4.1: an entity of dimension 3 has one

  void add(const MshElement& element);
  /// The volumes of a file without groups are its entities, if there are several.
  void finish();
};

}  // namespace sunder::app
