// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sunder::app {

/// Meshes the board of Fig. 4(b) with about so many tetrahedra, as gmsh's current model. gmsh must
/// be initialised; it throws std::string.
void mesh_board(double tets, double thickness);

}  // namespace sunder::app
