// SPDX-License-Identifier: Apache-2.0
// Boards of 50 x 50 mm in four volumes from bottom to top (tags 1 to 4): bottom-frame (y 0 to 5
// mm), lower (5 to 25), upper (25 to 45), top-frame (45 to 50); z from 0 to the thickness.
#pragma once

#include <filesystem>
#include <optional>

#include "sunder/mesh.hpp"

namespace sunder::app {

struct BoardOptions {
  // Structured: cells along x, y, z, five tetrahedra each. What is left out follows from the
  // others so that cells are near cubes; nothing given: 20 x 20 x 1.
  std::optional<int> nx, ny, nz;
  std::optional<long long> tets;  ///< instead: the nearest count (unstructured: within 3 %)
  bool unstructured = false;      ///< meshed by gmsh; needs `tets`
  double thickness = 2.0;         ///< mm
  bool ascii = false;             ///< .msh as text (default: binary); no other file
};

struct BoardReport {
  Index nodes = 0, tets = 0;
  int nx = 0, ny = 0, nz = 0;  ///< 0 when unstructured
};

/// Throws UsageError (in one sentence) for options that do not fit.
[[nodiscard]] Mesh make_board(const BoardOptions& options, BoardReport* report = nullptr);

/// Writes .msh (version 4.1), .vtk, .mesh, .unv or .bdf; the file appears complete or not at
/// all. Throws UsageError for another extension, and for text that is not .msh.
BoardReport write_board(const BoardOptions& options, const std::filesystem::path& file);

/// Removes what a write_board() of this process that does not go on has left beside the file.
void remove_half_written(const std::filesystem::path& file);

}  // namespace sunder::app
