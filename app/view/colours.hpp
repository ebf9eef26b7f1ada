// SPDX-License-Identifier: Apache-2.0
// What a picture colours the elements of a surface by.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/figure/shading.hpp"
#include "app/inputs/inputs.hpp"
#include "app/output/state.hpp"
#include "sunder/surface.hpp"

namespace sunder::app {

struct Paint {
  std::vector<Color> triangles;  ///< in the order of the surface's
  double maximum = 1;            ///< end of the scale, which begins at 0
  std::string label;             ///< quantity and unit; empty: nothing is computed yet
};

/// Shades of red from 0 to `colour.maximum`, or to a round number that nearly all of what is shown
/// stays below (a ratio to yield: to 1). What cannot break is grey where something else can.
[[nodiscard]] Paint paint(const Problem& problem, const State& state,
                          std::span<const SurfaceTriangle> triangles, const input::Colour& colour);

/// Largest principal strain by magnitude, of sym grad u (law linear) or of U - I; without sign.
[[nodiscard]] double largest_strain(const Problem& problem, const State& state, Index element);

}  // namespace sunder::app
