// SPDX-License-Identifier: Apache-2.0
// Unstructured meshes from gmsh: strips W wide, 6 W high, one element size thick, and square
// boards.
#pragma once

#include "core/field_sif/cracked_body.hpp"

namespace sunder::test {

/// gmsh's way to mesh the plane: same size, another mesh.
enum class PlaneMesh { delaunay = 5, frontal = 6, mesh_adapt = 1 };

/// W = `n` element sizes of 1 mm, unit stress at top and bottom. With `notch` cells > 0 the edge
/// crack is a volume of its own, notch x 1 mm, taken out: its end is where the crack ends. With 0
/// the strip is whole and waits for a crack to grow.
[[nodiscard]] CrackedBody gmsh_strip(int n, int notch, PlaneMesh how);

/// The same strip with an edge crack grown straight through its elements by rule 10 (method.md).
[[nodiscard]] CrackedBody grown_strip(int n, double length, PlaneMesh how);

inline constexpr double kGmshBoardSide = 50;  ///< mm

/// A square board, 2 mm thick, x and y from 0.
struct GmshBoard {
  double size = 1;  ///< of elements [mm]
  double notch =
      0;  ///< length of a volume of its own, one size high, at half height from x = 0 [mm]
  /// Radius of a hole in the middle, where there is no notch [mm]; elements grow from 4 mm beside
  /// it.
  double hole = 0;
};
[[nodiscard]] Mesh gmsh_board(const GmshBoard& wanted);

}  // namespace sunder::test
