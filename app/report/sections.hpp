// SPDX-License-Identifier: Apache-2.0
// The parts of the report, each a piece of HTML.
#pragma once

#include <string>
#include <vector>

#include "app/output/run_record.hpp"

namespace sunder::app {

[[nodiscard]] std::string header(const RunRecord& run);
[[nodiscard]] std::string key_figures(const RunRecord& run);
/// Failure, interruption and warnings; empty when there are none.
[[nodiscard]] std::string findings(const RunRecord& run);
/// Cracks and the history of events.
[[nodiscard]] std::string fracture(const RunRecord& run);
/// What grew over the steps; residual and error.
[[nodiscard]] std::string curves(const RunRecord& run);
[[nodiscard]] std::string times(const RunRecord& run);
/// Device, route and why, what was left out.
[[nodiscard]] std::string engine(const RunRecord& run);
[[nodiscard]] std::string forces(const RunRecord& run);
[[nodiscard]] std::string file_list(const std::vector<std::string>& files);

}  // namespace sunder::app
