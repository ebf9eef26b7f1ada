// SPDX-License-Identifier: Apache-2.0
#include "fracture/point_grid.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::fracture {

PointGrid::PointGrid(std::vector<Vec2> points, double cell)
    : points_(std::move(points)), cell_(cell) {
  Vec2 extent = Vec2::Zero();
  if (!points_.empty()) {
    Vec2 hi = origin_ = points_.front();
    for (const Vec2& p : points_) {
      origin_ = origin_.cwiseMin(p);
      hi = hi.cwiseMax(p);
    }
    extent = hi - origin_;
  }
  const double most_cells = 4.0 * static_cast<double>(points_.size()) + 16;
  while ((extent.x() / cell_ + 1) * (extent.y() / cell_ + 1) > most_cells) cell_ *= 2;
  columns_ = static_cast<Index>(extent.x() / cell_) + 1;
  rows_ = static_cast<Index>(extent.y() / cell_) + 1;

  const auto cell_of = [&](const Vec2& p) {
    const Vec2 offset = p - origin_;
    return static_cast<std::size_t>(cell_index(offset.y(), rows_)) *
               static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(cell_index(offset.x(), columns_));
  };
  begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const Vec2& p : points_) ++begin_[cell_of(p) + 1];
  for (std::size_t c = 0; c + 1 < begin_.size(); ++c) begin_[c + 1] += begin_[c];
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  ids_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i)
    ids_[next[cell_of(points_[i])]++] = static_cast<Index>(i);
}

Index PointGrid::cell_index(double offset, Index count) const {
  const double cell = std::floor(offset / cell_);
  return static_cast<Index>(std::clamp(cell, 0.0, static_cast<double>(count - 1)));
}

std::size_t PointGrid::most_within(double radius) const {
  std::size_t fullest = 0;
  for (std::size_t c = 0; c + 1 < begin_.size(); ++c)
    fullest = std::max(fullest, begin_[c + 1] - begin_[c]);
  const auto across = static_cast<std::size_t>(2 * radius / cell_) + 2;
  const auto cells = std::min(across, static_cast<std::size_t>(columns_)) *
                     std::min(across, static_cast<std::size_t>(rows_));
  return std::min(cells * fullest, points_.size());
}

void PointGrid::within(const Vec2& p, double radius, std::vector<Index>& found) const {
  found.clear();
  const Vec2 offset = p - origin_;
  const Index first_row = cell_index(offset.y() - radius, rows_);
  const Index last_row = cell_index(offset.y() + radius, rows_);
  const Index first_column = cell_index(offset.x() - radius, columns_);
  const Index last_column = cell_index(offset.x() + radius, columns_);
  for (Index row = first_row; row <= last_row; ++row) {
    const std::size_t start = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    const std::size_t begin = begin_[start + static_cast<std::size_t>(first_column)];
    const std::size_t end = begin_[start + static_cast<std::size_t>(last_column) + 1];
    // Every one is written down, and the next one over it where it lies too far: no branch to
    // guess.
    std::size_t count = found.size();
    found.resize(count + (end - begin));
    for (std::size_t k = begin; k < end; ++k) {
      found[count] = ids_[k];
      count += (points_[ids_[k]] - p).norm() <= radius ? 1 : 0;
    }
    found.resize(count);
  }
  std::sort(found.begin(), found.end());
}

}  // namespace sunder::fracture
