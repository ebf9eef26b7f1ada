// SPDX-License-Identifier: Apache-2.0
// events.csv, frames.csv and tips.csv.
#pragma once

#include <string>

#include "sunder/report.hpp"

namespace sunder::app {

/// Header and rows, each ending in a line feed.
[[nodiscard]] std::string events_header();
[[nodiscard]] std::string events_row(const DestroyedElement& record);
[[nodiscard]] std::string frames_header();
[[nodiscard]] std::string frames_row(const StepReport& report);
[[nodiscard]] std::string tips_header();
[[nodiscard]] std::string tips_row(int step, const TipState& tip);

}  // namespace sunder::app
