// SPDX-License-Identifier: Apache-2.0
// Meshes from files: .msh and .vtu by readers of our own (msh_reader.hpp, vtu_reader.hpp), the
// others through gmsh. gmsh may crash, hang or accept half a file, so it runs in a child process
// with limits, and what can be checked of a file is checked before.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder::app {

/// Whether the extension is that of a file which import_mesh() reads.
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& path);

struct ImportLimits {
  std::chrono::milliseconds timeout{0};  ///< of gmsh; 0: 30 s and 1 s for each MB of the file
  std::size_t memory_bytes = 0;          ///< of gmsh; 0: 2 GiB and 64 times the file's size
};

/// Reads the tetrahedra of .msh (1, 2.2 and 4.1, ascii and binary), .vtk (legacy), .vtu, .mesh,
/// .unv, .bdf and .nas files, corner nodes only; nodes and elements in the order of the file.
///
/// Volumes are the physical groups of dimension 3, ordered by tag; a group without name is
/// "volume-<tag>", tetrahedra of no group form the volume "volume" (tag 0). In a file without such
/// groups but several entities (.mesh references, .bdf properties) these are the volumes, as
/// "volume-<entity>". Surfaces are the
/// physical groups of dimension 2. A .vtk file's volumes are "volume-<tag>" by its cell data
/// (vtk_check.hpp), a .vtu file's the same with the names of its field data (vtu_reader.hpp). Nodes
/// that no tetrahedron uses are dropped with a warning, inverted elements turned with one.
/// Throws InputError.
[[nodiscard]] Mesh import_mesh(const std::filesystem::path& path,
                               std::vector<std::string>* warnings = nullptr,
                               const ImportLimits& limits = {});

}  // namespace sunder::app
