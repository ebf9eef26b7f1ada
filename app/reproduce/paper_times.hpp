// SPDX-License-Identifier: Apache-2.0
// Experiment 5 in numbers: the stages of a frame in which something breaks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/reproduce/laboratory.hpp"

namespace sunder::app::reproduce {

/// One run of a column of Tables 2 and 3; times in ms, none: it did not happen.
struct PaperColumn {
  std::string name;
  RunPlan plan;
};

/// A; B with expansion; B with expansion and pressure; B with K from the field, which Table 3 adds.
[[nodiscard]] std::vector<PaperColumn> paper_columns();

struct PaperTimes {
  double prepare = 0;  ///< once, before the first frame: matrix, factor, inverse
  /// Median over the steps in which something broke: one frame's stages, one event's update.
  std::optional<double> solve, stress, decide, update;
};

[[nodiscard]] PaperTimes measure_paper_times(const Laboratory& lab, const RunPlan& plan);

}  // namespace sunder::app::reproduce
