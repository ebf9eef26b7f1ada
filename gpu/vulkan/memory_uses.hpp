// SPDX-License-Identifier: Apache-2.0
// What the commands since the last barrier read and write: whether the next one must wait for them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gpu/vulkan/functions.hpp"
#include "gpu/vulkan/shader_uses.hpp"

namespace sunder::vulkan {

/// What a command does with a range of bytes of a buffer.
struct MemoryUse {
  VkBuffer buffer = VK_NULL_HANDLE;
  std::size_t begin = 0, end = 0;
  Use use;
  const void* kernel = nullptr;  ///< of a dispatch
};

class MemoryUses {
 public:
  /// Whether a command of these uses reads what has been written since the last barrier, or writes
  /// what has been read or written. `apart`: it has other bytes than dispatches of its kernel.
  [[nodiscard]] bool conflict(std::span<const MemoryUse> next, bool apart = false) const;
  void add(std::span<const MemoryUse> command);
  /// After a barrier, and where a command buffer begins.
  void clear() { all_.clear(); }

 private:
  std::vector<MemoryUse> all_;
};

}  // namespace sunder::vulkan
