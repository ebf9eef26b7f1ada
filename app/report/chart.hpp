// SPDX-License-Identifier: Apache-2.0
// Small charts as inline SVG. Colours come from the page's style sheet (classes s0, s1, ...), so
// that they follow its light or dark scheme.
#pragma once

#include <string>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::app {

struct ChartSeries {
  std::string name;
  std::vector<Vec2> points;
  bool steps = false;  ///< a value holds until the next point
};

struct ChartAxes {
  std::string x, y;          ///< titles
  bool logarithmic = false;  ///< y; points at or below zero are left out
};

[[nodiscard]] std::string line_chart(const std::vector<ChartSeries>& series, const ChartAxes& axes);

/// One bar per position, parts stacked in the order of `names`; many bars are joined by summing
/// neighbours.
[[nodiscard]] std::string stacked_bars(const std::vector<std::string>& names,
                                       const std::vector<std::vector<double>>& bars,
                                       const ChartAxes& axes);

}  // namespace sunder::app
