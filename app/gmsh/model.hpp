// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/input/raw_mesh.hpp"

namespace sunder::app {

/// The mesh that gmsh holds at present. Throws std::string, as gmsh does.
[[nodiscard]] RawMesh read_model();

}  // namespace sunder::app
