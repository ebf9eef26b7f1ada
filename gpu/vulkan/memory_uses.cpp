// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/memory_uses.hpp"

#include <algorithm>

namespace sunder::vulkan {
namespace {

bool conflict(const MemoryUse& a, const MemoryUse& b) {
  return a.buffer == b.buffer && a.begin < b.end && b.begin < a.end &&
         (a.use.writes || b.use.writes);
}

}  // namespace

bool MemoryUses::conflict(std::span<const MemoryUse> next, bool apart) const {
  return std::any_of(all_.begin(), all_.end(), [&](const MemoryUse& a) {
    return std::any_of(next.begin(), next.end(), [&](const MemoryUse& b) {
      return vulkan::conflict(a, b) && !(apart && a.kernel == b.kernel);
    });
  });
}

void MemoryUses::add(std::span<const MemoryUse> command) {
  all_.insert(all_.end(), command.begin(), command.end());
}

}  // namespace sunder::vulkan
