// SPDX-License-Identifier: Apache-2.0
// A board of cubes cut into six tetrahedra each (Kuhn), built in code.
#pragma once

#include <array>
#include <functional>
#include <random>
#include <string>

#include "sunder/mesh.hpp"

namespace sunder::test {

struct BoardShape {
  Index nx = 10, ny = 10, nz = 1;             ///< cells
  double width = 10, height = 10, depth = 1;  ///< [mm]
};

/// Node of grid position (i, j, k): x runs fastest, then y, then z.
inline Index grid_node(const BoardShape& s, Index i, Index j, Index k) {
  return i + (s.nx + 1) * (j + (s.ny + 1) * k);
}

/// Cell (i, j, k) holds the elements 6 c to 6 c + 5 with c = i + nx (j + ny k). `volume_at` names
/// the volume of a cell by its centre; volumes are listed in order of appearance.
inline Mesh structured_board(
    const BoardShape& s, const std::function<std::string(const Vec3&)>& volume_at =
                             [](const Vec3&) { return std::string("board"); }) {
  Mesh mesh;
  const Vec3 step(s.width / s.nx, s.height / s.ny, s.depth / s.nz);
  for (Index k = 0; k <= s.nz; ++k)
    for (Index j = 0; j <= s.ny; ++j)
      for (Index i = 0; i <= s.nx; ++i) mesh.nodes.push_back(Vec3(i, j, k).cwiseProduct(step));

  const auto volume_index = [&](const std::string& name) {
    for (std::size_t v = 0; v < mesh.volumes.size(); ++v)
      if (mesh.volumes[v].name == name) return static_cast<Index>(v);
    mesh.volumes.push_back({name, static_cast<int>(mesh.volumes.size()) + 1});
    return static_cast<Index>(mesh.volumes.size()) - 1;
  };
  // Six paths from corner 000 to corner 111 along the axes; odd permutations swap two nodes so
  // that every volume is positive.
  static constexpr std::array<std::array<int, 3>, 6> kPaths{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (Index k = 0; k < s.nz; ++k) {
    for (Index j = 0; j < s.ny; ++j) {
      for (Index i = 0; i < s.nx; ++i) {
        const Index volume =
            volume_index(volume_at((Vec3(i, j, k) + Vec3::Constant(0.5)).cwiseProduct(step)));
        for (std::size_t p = 0; p < kPaths.size(); ++p) {
          std::array<Index, 3> at{i, j, k};
          std::array<Index, 4> tet{};
          tet[0] = grid_node(s, at[0], at[1], at[2]);
          for (int step_index = 0; step_index < 3; ++step_index) {
            ++at[kPaths[p][step_index]];
            tet[step_index + 1] = grid_node(s, at[0], at[1], at[2]);
          }
          if (p >= 3) std::swap(tet[1], tet[2]);
          mesh.tets.push_back(tet);
          mesh.volume_of.push_back(volume);
        }
      }
    }
  }
  return mesh;
}

/// 4 x 3 x 2 mm of cells of 1 mm, "stiff" below y = 1 and "soft" above, inner nodes moved.
inline Mesh shaken_block() {
  Mesh mesh = structured_board({4, 3, 2, 4, 3, 2},
                               [](const Vec3& x) { return x.y() < 1 ? "stiff" : "soft"; });
  std::mt19937 generator(8);
  std::uniform_real_distribution<double> any(-0.2, 0.2);
  for (Vec3& x : mesh.nodes) {
    const bool inside = x.x() > 0 && x.x() < 4 && x.y() > 0 && x.y() < 3 && x.z() > 0 && x.z() < 2;
    if (inside) x += Vec3(any(generator), any(generator), any(generator));
  }
  return mesh;
}

}  // namespace sunder::test
