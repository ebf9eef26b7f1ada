// SPDX-License-Identifier: Apache-2.0
// Points of a plane in square cells, so that a neighbourhood costs what lies in it.
#pragma once

#include <cstddef>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::fracture {

class PointGrid {
 public:
  /// `cell`: side of a cell [mm]; enlarged when the points would spread over far more cells than
  /// there are points.
  PointGrid(std::vector<Vec2> points, double cell);

  [[nodiscard]] const std::vector<Vec2>& points() const { return points_; }
  /// Ids of the points at most `radius` from p, ascending, in place of what `found` held.
  void within(const Vec2& p, double radius, std::vector<Index>& found) const;
  /// No neighbourhood of that radius has more points than this.
  [[nodiscard]] std::size_t most_within(double radius) const;

 private:
  [[nodiscard]] Index cell_index(double offset, Index count) const;

  std::vector<Vec2> points_;
  Vec2 origin_ = Vec2::Zero();
  double cell_ = 1;
  Index columns_ = 1, rows_ = 1;
  std::vector<std::size_t> begin_;  // shape (cells + 1)
  std::vector<Index> ids_;          // shape (points), by cell
};

}  // namespace sunder::fracture
