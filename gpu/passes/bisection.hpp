// SPDX-License-Identifier: Apache-2.0
// Parts of points by halves along the longest side of their box (recursive coordinate bisection;
// Berger and Bokhari, IEEE Trans. Computers 36, 1987).
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::gpu {

/// Adds `count` parts of these points, in proportion to the parts on either side of a cut; fewer
/// than twice `fewest` are not cut again; `count`: at most the points. `x`: of every point. The
/// order of `points` is lost.
inline void bisect(std::span<Index> points, Index count, std::size_t fewest,
                   const std::vector<Vec3>& x, std::vector<std::vector<Index>>& parts) {
  if (count <= 1 || points.size() < 2 * fewest) {
    parts.emplace_back(points.begin(), points.end());
    std::ranges::sort(parts.back());
    return;
  }
  Vec3 low = x[points.front()], high = low;
  for (Index n : points) {
    low = low.cwiseMin(x[n]);
    high = high.cwiseMax(x[n]);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const Index below = count / 2;
  const std::size_t cut =
      points.size() * static_cast<std::size_t>(below) / static_cast<std::size_t>(count);
  std::nth_element(
      points.begin(), points.begin() + static_cast<std::ptrdiff_t>(cut), points.end(),
      [&](Index a, Index b) { return x[a][axis] != x[b][axis] ? x[a][axis] < x[b][axis] : a < b; });
  bisect(points.first(cut), below, fewest, x, parts);
  bisect(points.subspan(cut), count - below, fewest, x, parts);
}

}  // namespace sunder::gpu
