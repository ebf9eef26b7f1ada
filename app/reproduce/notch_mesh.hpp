// SPDX-License-Identifier: Apache-2.0
// Boards with a notch in the middle of the right edge, in other sizes and from other meshers than
// the one that scenes/ holds.
#pragma once

#include <memory>
#include <string>

#include "sunder/mesh.hpp"

namespace sunder::app::reproduce {

struct NotchMesh {
  double size = 3.939;   ///< of elements [mm]; default: the board of 1954 elements
  double length = 4.04;  ///< of the notch [mm]
  int plane_mesher = 5;  ///< gmsh's Mesh.Algorithm: 1 MeshAdapt, 5 Delaunay, 6 Frontal-Delaunay
};

/// Meshes scenes/meshes/board1954_notch.geo with these numbers in place of its own. Deterministic
/// for one version of gmsh. Throws sunder::Error when gmsh fails.
[[nodiscard]] std::shared_ptr<const Mesh> mesh_notch(const NotchMesh& wanted);

/// The geometry with these numbers. Throws std::logic_error when it has no such number.
[[nodiscard]] std::string notch_geometry(const NotchMesh& wanted);

/// An embedded .msh file.
[[nodiscard]] Mesh read_embedded_mesh(const std::string& file);

/// Removes what the functions above have on the disk while they run, where they do not go on.
void remove_temporary_files();

}  // namespace sunder::app::reproduce
