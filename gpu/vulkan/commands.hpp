// SPDX-License-Identifier: Apache-2.0
// One command buffer: recorded, submitted as often as wanted, its passes timed on the device.
#pragma once

#include <string>
#include <vector>

#include "gpu/vulkan/kernel.hpp"

namespace sunder::vulkan {

struct PassTime {
  std::string pass;
  double milliseconds = 0;
};

class Commands {
 public:
  explicit Commands(Device& device);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  /// Starts anew; forgets what was recorded.
  void begin();
  void end();
  void submit();

  /// Names what follows, for pass_times().
  void pass(const char* name);
  template <class Push>
  void dispatch(const Binding& binding, const Push& push, std::uint32_t x, std::uint32_t y = 1) {
    bind(binding, &push, sizeof(Push));
    dispatch(x, y);
  }
  /// The size comes from three words of `arguments` at `offset`, which a kernel may have written.
  template <class Push>
  void dispatch_indirect(const Binding& binding, const Push& push, const Buffer& arguments,
                         std::size_t offset) {
    bind(binding, &push, sizeof(Push));
    dispatch_indirect(arguments, offset);
  }
  /// What was written before is seen by what follows.
  void barrier();
  void copy(VkBuffer from, std::size_t from_offset, VkBuffer to, std::size_t to_offset,
            std::size_t bytes);
  void fill_zero(const Buffer& buffer);

  /// Of the last submit; passes of one name are added up. Empty where the queue has no clock.
  [[nodiscard]] std::vector<PassTime> pass_times() const;

 private:
  void bind(const Binding& binding, const void* push, std::uint32_t bytes);
  void dispatch(std::uint32_t x, std::uint32_t y);
  void dispatch_indirect(const Buffer& arguments, std::size_t offset);
  void write_time();

  Device& device_;
  VkCommandBuffer handle_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::vector<std::string> passes_;
};

}  // namespace sunder::vulkan
