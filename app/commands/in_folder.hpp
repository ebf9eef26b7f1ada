// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "app/commands/interruption.hpp"
#include "app/output/result_folder.hpp"

namespace sunder::app {

/// Makes and locks the folder for results. A signal finds it, and takes it back, or finds that it
/// does not exist: `nothing` and the path are said then, and `besides` is called first. Throws
/// UsageError as ResultFolder does.
[[nodiscard]] Expecting in_folder(Interruption& interruption, std::optional<ResultFolder>& folder,
                                  const std::filesystem::path& path, const std::string& nothing,
                                  std::function<void()> besides = {});

}  // namespace sunder::app
