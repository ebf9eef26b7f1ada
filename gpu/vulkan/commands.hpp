// SPDX-License-Identifier: Apache-2.0
// One command buffer: recorded, submitted as often as wanted, its passes timed on the device. A
// command waits for those before it whose bytes it reads or changes: a barrier is recorded where
// one is needed, and nowhere else.
#pragma once

#include <span>
#include <vector>

#include "gpu/vulkan/kernel.hpp"

namespace sunder::vulkan {

class Commands {
 public:
  explicit Commands(Device& device);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  /// Starts anew; forgets what was recorded.
  void begin();
  /// The host and every later command of the queue see what was written.
  void end();
  /// Waits, and adds its pass times to the device's sums. `then`: goes after it in the same submit.
  void submit(const Commands* then = nullptr);

  /// Names what follows, for pass_times(); `name` must live on. Only while the device times passes:
  /// lavapipe waits for all work at every time stamp (15 us).
  void pass(const char* name);
  /// More workgroups along x than the device takes are folded along z (vulkan/folded_groups.hpp).
  template <class Push>
  void dispatch(const Binding& binding, const Push& push, std::uint32_t x, std::uint32_t y = 1) {
    wait_for(binding.uses());
    bind(binding, &push, sizeof(Push));
    dispatch(binding.kernel(), x, y);
  }
  void dispatch(const Binding& binding, std::uint32_t x) {
    wait_for(binding.uses());
    bind(binding, nullptr, 0);
    dispatch(binding.kernel(), x, 1);
  }
  /// The size comes from three words of `arguments` at `offset`, which a kernel may have written.
  template <class Push>
  void dispatch_indirect(const Binding& binding, const Push& push, const Buffer& arguments,
                         std::size_t offset) {
    wait_for(binding, arguments, offset);
    bind(binding, &push, sizeof(Push));
    dispatch_indirect(arguments, offset);
  }
  void dispatch_indirect(const Binding& binding, const Buffer& arguments, std::size_t offset) {
    wait_for(binding, arguments, offset);
    bind(binding, nullptr, 0);
    dispatch_indirect(arguments, offset);
  }
  /// The next dispatch has other bytes of the buffers than those of the same kernel that came
  /// before it: it need not wait for them.
  void apart() { apart_ = true; }
  void copy(VkBuffer from, std::size_t from_offset, VkBuffer to, std::size_t to_offset,
            std::size_t bytes);
  void fill_zero(const Buffer& buffer, std::size_t offset, std::size_t bytes) {
    fill_zero(buffer.handle(), buffer.offset() + offset, bytes);
  }
  void fill_zero(VkBuffer to, std::size_t to_offset, std::size_t bytes);

  [[nodiscard]] VkCommandBuffer handle() const { return handle_; }
  /// Barriers between the commands that were recorded.
  [[nodiscard]] int barriers() const { return barriers_; }
  /// Of the last submit; passes of one name are added up. Empty where the queue has no clock.
  [[nodiscard]] std::vector<PassTime> pass_times() const;

 private:
  void wait_for(std::span<const MemoryUse> uses, std::span<const MemoryUse> size = {});
  void wait_for(const Binding& binding, const Buffer& arguments, std::size_t offset);
  void memory_barrier(VkPipelineStageFlags to_stages, VkAccessFlags to);
  void bind(const Binding& binding, const void* push, std::uint32_t bytes);
  void dispatch(const Kernel& kernel, std::uint32_t x, std::uint32_t y);
  void dispatch_indirect(const Buffer& arguments, std::size_t offset);
  void write_time();
  void count() const;

  Device& device_;
  VkCommandBuffer handle_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::vector<const char*> passes_;
  MemoryUses uses_;  // since the last barrier
  bool apart_ = false;
  int barriers_ = 0;
  std::size_t dispatches_ = 0;
};

}  // namespace sunder::vulkan
