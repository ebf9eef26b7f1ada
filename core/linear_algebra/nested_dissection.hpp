// SPDX-License-Identifier: Apache-2.0
// Order of elimination of unknowns that belong to points in space. Nested dissection (George 1973)
// leaves a factor with about as many entries as minimum degree on a thin board, a third of the
// operations on a thick one, and elimination paths half as long: an event reads those.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::linear_algebra {

/// Points with up to three unknowns each; every two points of a group are coupled.
struct CoupledPoints {
  std::span<const Vec3> points;
  std::span<const std::array<Index, 3>> unknowns;  ///< of each point, kNone: fewer
  std::span<const std::array<Index, 4>> groups;
};

/// place[i] is the row of the factor that unknown i becomes. Planes across the points separate
/// them, small pieces are ordered by minimum degree; a point's unknowns stay together.
[[nodiscard]] std::vector<Index> nested_dissection(const CoupledPoints& of);

}  // namespace sunder::linear_algebra
