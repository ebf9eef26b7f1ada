// SPDX-License-Identifier: Apache-2.0
// From an order of points to one of their unknowns.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::linear_algebra {

/// place[i] is the row of unknown i where points are eliminated in this order, each with all of its
/// unknowns (kNone: fewer).
[[nodiscard]] inline std::vector<Index> places_of_unknowns(
    std::span<const Index> points, std::span<const std::array<Index, 3>> unknowns) {
  std::vector<Index> order;
  for (Index point : points) {
    for (Index i : unknowns[static_cast<std::size_t>(point)]) {
      if (i != kNone) order.push_back(i);
    }
  }
  std::vector<Index> place(order.size());
  for (std::size_t row = 0; row < order.size(); ++row) {
    place[static_cast<std::size_t>(order[row])] = static_cast<Index>(row);
  }
  return place;
}

}  // namespace sunder::linear_algebra
