// SPDX-License-Identifier: Apache-2.0
// What the board generator leaves to gmsh, in a child process.
#pragma once

#include <filesystem>

#include "sunder/mesh.hpp"

namespace sunder::app {

/// Unstructured board with `tets` tetrahedra within 3 %, or as near as the element size gets.
/// Deterministic. Throws Error when gmsh fails.
[[nodiscard]] Mesh unstructured_board(long long tets, double thickness);

/// Converts a mesh file to another format that gmsh writes.
void convert_with_gmsh(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace sunder::app
