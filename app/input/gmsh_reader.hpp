// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "app/input/raw_mesh.hpp"

namespace sunder::app {

/// Reads a mesh file with gmsh, in this process. Throws InputError for what gmsh refuses; may
/// crash or hang: call it in a child (child_process.hpp).
[[nodiscard]] RawMesh read_with_gmsh(const std::string& path);

/// The mesh that gmsh holds at present.
[[nodiscard]] RawMesh read_model();

}  // namespace sunder::app
