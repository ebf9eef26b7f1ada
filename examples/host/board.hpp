// SPDX-License-Identifier: Apache-2.0
// The body as the host has it: arrays, and the scene made of them.
#pragma once

#include <sunder/sunder.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

/// Throws the library's sentence.
inline void check(sunder_status status) {
  if (status != SUNDER_OK) throw std::runtime_error(sunder_last_error());
}

/// 50 x 50 x 2 mm, one layer of cubes of six tetrahedra; stiff frames along top and bottom.
struct Board {
  Board();
  std::vector<double> nodes;              ///< (nodes x 3) [mm]
  std::vector<std::int32_t> tets;         ///< (tets x 4)
  std::vector<std::int32_t> material_of;  ///< per tet
  std::int32_t pulled_node = 0;           ///< lower right corner, front

  [[nodiscard]] std::size_t tet_count() const { return tets.size() / 4; }
};

/// Held at the top, pulled down by a grip at the lower right corner, further from step to step.
[[nodiscard]] sunder_scene make_scene(const Board& board, std::int32_t steps);
