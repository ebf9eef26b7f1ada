// SPDX-License-Identifier: Apache-2.0
// What a picture colours elements by: stress in shades of red, frame grey.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/figure/raster.hpp"
#include "app/output/state.hpp"

namespace sunder::app {

/// The stress scale of a picture: `value / maximum` runs from pale to dark red.
struct StressScale {
  std::vector<double> value;  ///< per element
  double maximum = 1;
  std::string label;  ///< quantity and unit
};

/// Yield ratio, 0 to 1, where tissue can break; else maximum shear stress in MPa up to a round
/// number that all but the highest half percent stay below. None when stress was not computed.
[[nodiscard]] std::optional<StressScale> stress_scale(const Problem& problem, const State& state);

/// A round number that all values but the highest half percent stay below.
[[nodiscard]] double round_maximum(std::vector<double> values);

/// What cannot break where something else can; what nothing is known of yet.
inline constexpr Color kFrame{176, 180, 184}, kPlain{246, 216, 205};

/// Of strokes along fibres, by family.
inline constexpr std::array<Color, 2> kFibres{{{40, 60, 110}, {30, 105, 70}}};

/// The scale's shades of red, evenly from 0 to 1; between two lies a straight mix of them.
[[nodiscard]] std::span<const Color> reds();
/// Shade of red for a share of the scale (clamped to 0 to 1).
[[nodiscard]] Color red(double share);

/// Unbreakable elements are grey, unless the whole body is.
[[nodiscard]] bool shows_frame(const Problem& problem);

/// Whether strength can break something: a ratio to yield has a meaning.
[[nodiscard]] bool breaks_by_strength(const Problem& problem);

/// Colour of each live element.
[[nodiscard]] std::vector<Color> element_colors(const Problem& problem, const State& state,
                                                const std::optional<StressScale>& scale);

/// The same colour in the shade: for faces that a tear has laid open.
[[nodiscard]] Color shaded(Color color);

[[nodiscard]] std::string hex(Color color);

}  // namespace sunder::app
