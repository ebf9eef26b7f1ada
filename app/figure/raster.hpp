// SPDX-License-Identifier: Apache-2.0
// Pixels: a drawing as PNG, and many triangles as one image.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::app {

struct Color {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// A triangle in drawing coordinates (x right, y down).
struct PaintedTriangle {
  std::array<Vec2, 3> corners;
  Color fill;
  std::array<bool, 3> rim{};  ///< edge from corner i to corner i + 1: drawn as the rim of a lip
};

constexpr Color kRimColor{17, 17, 17};

/// False in a build without librsvg, whose pictures are SVG alone: what makes PNG throws
/// OutputError.
[[nodiscard]] bool draws_pixels() noexcept;

/// Renders an SVG document at `zoom` pixels per unit. Throws OutputError when it cannot be drawn.
[[nodiscard]] std::string png_of_svg(std::string_view svg, double zoom);

/// An opaque image, 4 bytes a pixel (red, green, blue, any), rows from above.
struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// As PNG, with an SVG document drawn over it, one unit a pixel; empty: nothing over it.
[[nodiscard]] std::string png_of_pixels(const Pixels& pixels, std::string_view svg_over = {});

/// Paints triangles in their order, rims `rim_width` units wide, onto a transparent image that
/// shows the rectangle from `corner` with `size`, at `zoom` pixels per unit.
[[nodiscard]] std::string png_of_triangles(const std::vector<PaintedTriangle>& triangles,
                                           const Vec2& corner, const Vec2& size, double zoom,
                                           double rim_width);

}  // namespace sunder::app
