// SPDX-License-Identifier: Apache-2.0
// Rotations as hosts give them: x, y, z, w, of any length above 0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sunder/types.hpp"

namespace sunder {

[[nodiscard]] inline bool names_a_turn(const std::array<double, 4>& q) {
  const bool finite = std::ranges::all_of(q, [](double v) { return std::isfinite(v); });
  return finite && std::ranges::any_of(q, [](double v) { return v != 0; });
}

/// R - I of a rotation; exactly 0 where it turns nothing. `q` must name a turn.
[[nodiscard]] inline Mat3 turn_by(std::array<double, 4> q) {
  double largest = 0, squares = 0;
  for (double v : q) largest = std::max(largest, std::abs(v));
  for (double& v : q) {
    v /= largest;  // squares neither overflow nor vanish
    squares += v * v;
  }
  for (double& v : q) v /= std::sqrt(squares);
  Mat3 cross;
  cross << 0, -q[2], q[1], q[2], 0, -q[0], -q[1], q[0], 0;
  return 2 * (q[3] * cross + cross * cross);
}

}  // namespace sunder
