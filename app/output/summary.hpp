// SPDX-License-Identifier: Apache-2.0
// summary.json.
#pragma once

#include <string>

#include "app/output/run_record.hpp"

namespace sunder::app {

[[nodiscard]] std::string summary_json(const RunRecord& run);

}  // namespace sunder::app
