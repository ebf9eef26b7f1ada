// SPDX-License-Identifier: Apache-2.0
// Meshes out of gmsh's own files (.msh), which need no gmsh: versions 1, 2.2 and 4.1, ascii and
// binary.
#pragma once

#include <string>
#include <string_view>

#include "app/input/raw_mesh.hpp"

namespace sunder::app {

/// Nodes, tetrahedra and the triangles of named surfaces in the order of the file. All of the file
/// is read: every section closed, every count met, every id in range, every node of an element
/// there. Throws InputError; `name` (the file) begins messages, with the line where there is one.
[[nodiscard]] RawMesh read_msh(std::string_view bytes, const std::string& name);

}  // namespace sunder::app
