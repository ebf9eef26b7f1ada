// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "sunder/backends.hpp"

namespace sunder::bench {

/// Whether rows of the Vulkan backend can run here; a CPU-type device counts.
[[nodiscard]] inline bool has_vulkan() {
  const auto all = devices();
  return std::any_of(all.begin(), all.end(),
                     [](const DeviceInfo& device) { return device.backend == "vulkan"; });
}

}  // namespace sunder::bench
