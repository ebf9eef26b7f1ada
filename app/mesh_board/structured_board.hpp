// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "sunder/mesh.hpp"

namespace sunder::app {

inline constexpr double kBoardSide = 50.0;  ///< mm
/// Where the volumes meet, mm along y.
inline constexpr std::array<double, 5> kBoardLayers = {0.0, 5.0, 25.0, 45.0, 50.0};
inline constexpr int kTetsPerCell = 5;

struct BoardCells {
  int nx = 0, ny = 0, nz = 0;
  [[nodiscard]] long long tets() const {
    return static_cast<long long>(kTetsPerCell) * nx * ny * nz;
  }
};

/// Cells whose tetrahedra are nearest to `tets` in number while cells stay near cubes (sides along
/// x and y within 5:4 of each other).
[[nodiscard]] BoardCells cells_for(long long tets, double thickness);

/// Five tetrahedra per cell, mirrored from cell to cell like a chess board: conforming and without
/// a preferred diagonal. ny >= 4.
[[nodiscard]] Mesh structured_board(const BoardCells& cells, double thickness);

/// The four volumes, tags 1 to 4.
[[nodiscard]] std::vector<NamedVolume> board_volumes();

}  // namespace sunder::app
