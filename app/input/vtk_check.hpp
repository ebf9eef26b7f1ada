// SPDX-License-Identifier: Apache-2.0
// Is a legacy .vtk file whole? Reads points, cells and cell data of an unstructured grid, and the
// volumes' tags, which gmsh does not keep.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sunder::app {

struct VtkContents {
  std::uint64_t points = 0;
  std::uint64_t tetrahedra = 0;   ///< of first or second order (VTK's types 10 and 24)
  std::uint64_t first_order = 0;  ///< of these
  std::uint64_t unread = 0;       ///< of VTK's types 71 and 78, which gmsh does not know
  /// Per tetrahedron, in the order of the cells, from the first integer cell data of one component
  /// named CellEntityIds, gmsh:physical, volume, region, material, cell_tags or medit:ref; empty
  /// when there is none.
  std::vector<int> tet_tags;
};

/// Does cell data of this name tell the volumes?
[[nodiscard]] bool names_volumes(std::string_view name);

/// Throws InputError; `name` (the file) begins messages, with the line in ascii files.
[[nodiscard]] VtkContents check_vtk(std::string_view bytes, const std::string& name);

}  // namespace sunder::app
