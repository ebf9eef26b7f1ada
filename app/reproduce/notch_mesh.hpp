// SPDX-License-Identifier: Apache-2.0
// The paper's board, whole or with a notch in the middle of its right edge, in other sizes and from
// other meshers than those that scenes/ holds.
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

struct BoardMesh {
  double size = 3.823;   ///< of elements [mm]; default: the board of 1954 elements
  int plane_mesher = 5;  ///< gmsh's Mesh.Algorithm
};

/// Meshes scenes/meshes/board1954.geo with these numbers in place of its own; else as mesh_notch().
[[nodiscard]] std::shared_ptr<const Mesh> mesh_board(const BoardMesh& wanted);
[[nodiscard]] std::string board_geometry(const BoardMesh& wanted);

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
