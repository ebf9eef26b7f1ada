// SPDX-License-Identifier: Apache-2.0
#include "app/mesh_board/structured_board.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sunder::app {
namespace {

// Rows of cells in each volume: a tenth of ny in a frame, the rest halved.
std::array<int, 4> rows_of_volumes(int ny) {
  const int frame = std::max(1, static_cast<int>(std::lround(ny / 10.0)));
  const int upper = (ny - 2 * frame) / 2;
  return {frame, ny - 2 * frame - upper, upper, frame};
}

// Places of the ny + 1 rows of nodes; volumes' borders exactly.
std::vector<double> row_places(int ny, std::vector<Index>& volume_of_row) {
  std::vector<double> places = {kBoardLayers[0]};
  const std::array<int, 4> rows = rows_of_volumes(ny);
  for (std::size_t v = 0; v < rows.size(); ++v) {
    const double begin = kBoardLayers[v], end = kBoardLayers[v + 1];
    for (int i = 1; i <= rows[v]; ++i) {
      places.push_back(i == rows[v] ? end : begin + (end - begin) * i / rows[v]);
      volume_of_row.push_back(static_cast<Index>(v));
    }
  }
  return places;
}

// Corners of a cell: bit 0 along x, bit 1 along y, bit 2 along z. Four corner tetrahedra and the
// one between them; the second form is the first one mirrored.
constexpr std::array<std::array<int, 4>, 5> kEven = {
    {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}}};

std::array<int, 4> corners(int tet, bool odd) {
  std::array<int, 4> result = kEven[static_cast<std::size_t>(tet)];
  if (!odd) return result;
  for (int& corner : result) corner ^= 1;  // mirror along x ...
  std::swap(result[2], result[3]);         // ... turns the orientation round
  return result;
}

}  // namespace

std::vector<NamedVolume> board_volumes() {
  return {{"bottom-frame", 1}, {"lower", 2}, {"upper", 3}, {"top-frame", 4}};
}

BoardCells cells_for(long long tets, double thickness) {
  const double cells = static_cast<double>(tets) / kTetsPerCell;
  const double side = std::cbrt(kBoardSide * kBoardSide * thickness / cells);
  const int middle = static_cast<int>(thickness / side);
  BoardCells best;
  double best_score = 0;
  for (int nz = std::max(1, middle); nz <= std::max(1, middle + 1); ++nz) {
    const double across = std::sqrt(cells / nz);
    const int most = std::max(4, static_cast<int>(std::ceil(across * 1.2)));
    for (int nx = std::max(1, static_cast<int>(across / 1.2)); nx <= most; ++nx) {
      const int ny = std::max(4, static_cast<int>(std::lround(cells / nz / nx)));
      const double ratio = static_cast<double>(std::max(nx, ny)) / std::min(nx, ny);
      if (ratio > 1.25 && nx != most) continue;
      const BoardCells candidate{nx, ny, nz};
      // The count decides; between equal counts the squarer cells.
      const double score =
          static_cast<double>(std::llabs(candidate.tets() - tets)) + 0.1 * (ratio - 1);
      if (best.nx == 0 || score < best_score) {
        best = candidate;
        best_score = score;
      }
    }
  }
  return best;
}

Mesh structured_board(const BoardCells& cells, double thickness) {
  const int nx = cells.nx, ny = cells.ny, nz = cells.nz;
  Mesh mesh;
  mesh.volumes = board_volumes();
  std::vector<Index> volume_of_row;
  const std::vector<double> rows = row_places(ny, volume_of_row);

  mesh.nodes.reserve(static_cast<std::size_t>(nx + 1) * static_cast<std::size_t>(ny + 1) *
                     static_cast<std::size_t>(nz + 1));
  for (int j = 0; j <= ny; ++j) {
    for (int k = 0; k <= nz; ++k) {
      for (int i = 0; i <= nx; ++i)
        mesh.nodes.emplace_back(kBoardSide * i / nx, rows[static_cast<std::size_t>(j)],
                                thickness * k / nz);
    }
  }

  mesh.tets.reserve(static_cast<std::size_t>(cells.tets()));
  mesh.volume_of.reserve(mesh.tets.capacity());
  const auto node = [&](int i, int j, int k) {
    return static_cast<Index>((j * (nz + 1) + k) * (nx + 1) + i);
  };
  for (int j = 0; j < ny; ++j) {
    for (int k = 0; k < nz; ++k) {
      for (int i = 0; i < nx; ++i) {
        for (int t = 0; t < kTetsPerCell; ++t) {
          std::array<Index, 4> tet{};
          const std::array<int, 4> local = corners(t, (i + j + k) % 2 != 0);
          for (std::size_t c = 0; c < 4; ++c)
            tet[c] = node(i + (local[c] & 1), j + ((local[c] >> 1) & 1), k + (local[c] >> 2));
          mesh.tets.push_back(tet);
          mesh.volume_of.push_back(volume_of_row[static_cast<std::size_t>(j)]);
        }
      }
    }
  }
  return mesh;
}

}  // namespace sunder::app
