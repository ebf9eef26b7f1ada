// SPDX-License-Identifier: Apache-2.0
// The page of a figure: title above, drawing, colour bar at the right, caption below.
#pragma once

#include <limits>
#include <string>
#include <string_view>

#include "sunder/types.hpp"

namespace sunder::app {

/// Bounding rectangle of what is drawn, in the plane [mm].
struct Bounds {
  Vec2 min = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 max = Vec2::Constant(-std::numeric_limits<double>::infinity());
  void add(const Vec2& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
};

/// Height of three lines of caption, and of four with the inset beside them [px].
constexpr double kCaption = 100, kTornCaption = 140;

class Canvas {
 public:
  /// `caption`: height of the room below the drawing, px.
  explicit Canvas(const Bounds& bounds, double caption = kCaption);

  /// From the plane [mm, y up] to the page [px, y down].
  [[nodiscard]] Vec2 map(const Vec2& p) const;
  /// A length of the plane [mm] on the page [px].
  [[nodiscard]] double length(double mm) const { return mm * scale_; }
  /// Drawing area on the page.
  [[nodiscard]] Vec2 corner() const { return corner_; }
  [[nodiscard]] Vec2 size() const { return size_; }
  [[nodiscard]] double page_width() const;
  [[nodiscard]] double page_height() const;

  /// A picture beside the caption, right-aligned with the page.
  [[nodiscard]] Vec2 inset_corner() const;
  [[nodiscard]] Vec2 inset_size() const;

  /// Opening tag, white page, title.
  [[nodiscard]] std::string open(std::string_view title) const;

 private:
  Bounds bounds_;
  Vec2 corner_, size_;
  double scale_ = 1;  ///< px per mm
  double caption_;
};

}  // namespace sunder::app
