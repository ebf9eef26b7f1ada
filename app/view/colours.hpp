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
  std::vector<float> values;  ///< of triangles, in the order of the surface's; empty: not wanted
  double maximum = 1;         ///< end of the scale, which begins at 0
  std::string label;          ///< quantity and unit; empty: nothing is computed yet
};

/// Where values are from: of the state, or from where the device has them, so that they are
/// computed here only if the scale depends on them, and not returned.
enum class Values { here, on_device };

/// For shades of red from 0 to `colour.maximum`, or to a round number that nearly all of what is
/// shown stays below (a ratio to yield: to 1).
[[nodiscard]] Paint paint(const Problem& problem, const State& state,
                          std::span<const SurfaceTriangle> triangles, const input::Colour& colour,
                          Values values = Values::here);

/// By element, 1: grey, for it cannot break where something else can. Empty: none.
[[nodiscard]] std::vector<std::uint8_t> unbreakable(const Problem& problem);

/// Largest principal strain by magnitude, of sym grad u (law linear) or of U - I; without sign.
[[nodiscard]] double largest_strain(const Problem& problem, const State& state, Index element);

}  // namespace sunder::app
