// SPDX-License-Identifier: Apache-2.0
// The parts of a sweep that lie in a folder, and the one table of them (--merge).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/sweep/description.hpp"
#include "app/sweep/rows.hpp"

namespace sunder::app::sweep {

struct Merged {
  Description sweep;  ///< of all of them
  Rows rows;
  std::vector<std::string> missing;  ///< a sentence for each part that is not there or not done
};

/// Whether there is a part in it.
[[nodiscard]] bool has_parts(const std::filesystem::path& folder);

/// Throws UsageError where there is none, or they are not of one sweep.
[[nodiscard]] Merged merge_parts(const std::filesystem::path& folder);

}  // namespace sunder::app::sweep
