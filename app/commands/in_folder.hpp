// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "app/commands/interruption.hpp"
#include "app/output/result_folder.hpp"

namespace sunder::app {

/// Makes and locks the folder for results, which is released with what is returned. A signal in
/// between calls `besides`, takes the folder back and says `nothing` and its path. There is no
/// moment at which a signal would leave the folder behind. Throws UsageError as ResultFolder does.
[[nodiscard]] Expecting in_folder(Interruption& interruption, std::optional<ResultFolder>& folder,
                                  const std::filesystem::path& path, const std::string& nothing,
                                  std::function<void()> besides = {});

}  // namespace sunder::app
