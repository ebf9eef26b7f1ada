// SPDX-License-Identifier: Apache-2.0
// What stands over a picture of a body: words, scales, force arrows, tips, fibres. Plain shapes on
// the picture [px, y down], which a file gets as SVG and a window by its own pen.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/view/camera.hpp"
#include "app/view/colours.hpp"
#include "app/view/look.hpp"
#include "app/view/shown.hpp"

namespace sunder::app {

struct Overlay {
  struct Line {
    Vec2 from, to;
    double width = 1;
    Color color;
  };
  struct Polygon {
    std::vector<Vec2> corners;
    Color fill;
  };
  struct Text {
    enum class Anchor { left, middle, right };
    Vec2 at;  ///< of its base line
    std::string words;
    double size = 13;
    Anchor anchor = Anchor::left;
    bool bold = false;
  };
  std::vector<Polygon> polygons;  ///< in this order: polygons, lines, texts
  std::vector<Line> lines;
  std::vector<Text> texts;
};

constexpr Color kBackground{38, 44, 54}, kInk{236, 238, 241}, kForce{255, 205, 60},
    kTip{90, 220, 255};
/// Strokes along fibres, by family.
constexpr std::array<Color, 2> kFibrePens{{{70, 150, 255}, {60, 200, 120}}};

[[nodiscard]] Overlay overlay(const Problem& problem, const Shown& shown, const Paint& paint,
                              const Look& look, const Camera& camera);

/// An SVG document of that size, one unit a pixel.
[[nodiscard]] std::string svg_of(const Overlay& overlay, const PictureSize& size);

}  // namespace sunder::app
