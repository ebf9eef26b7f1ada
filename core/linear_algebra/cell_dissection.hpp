// SPDX-License-Identifier: Apache-2.0
// Order of elimination where cells of many points couple all of their points: by nested dissection
// of the cells. A plane through the points would have a layer as thick as a cell beside it as its
// separator; cells on one side and on the other share only the points between them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::linear_algebra {

struct CoupledCells {
  std::span<const Vec3> points;
  std::span<const std::array<Index, 3>> unknowns;  ///< of each point, kNone: fewer
  std::span<const std::vector<Index>> cells;       ///< every two points of one are coupled
};

/// place[i] is the row of the factor that unknown i becomes; a point's unknowns stay together. Each
/// point with unknowns must be in a cell.
[[nodiscard]] std::vector<Index> cell_dissection(const CoupledCells& of);

}  // namespace sunder::linear_algebra
