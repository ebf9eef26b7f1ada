// SPDX-License-Identifier: Apache-2.0
// The one place where work reaches a Vulkan queue, of our own or a host's.
#pragma once

#include <chrono>
#include <functional>
#include <span>

#include "gpu/vulkan/functions.hpp"

namespace sunder::vulkan {

/// Vulkan wants one thread at a time in a queue. A host that uses its queue from other threads says
/// how to take and release it; empty: nobody else uses it.
struct QueueLock {
  std::function<void()> lock, unlock;
};

/// So long a submit may take before its device counts as lost. A driver ends a GPU's work that
/// hangs after some seconds; a processor that emulates one takes its time.
inline constexpr std::chrono::nanoseconds kPatience = std::chrono::minutes(1),
                                          kPatienceWithAProcessor = std::chrono::minutes(30);

class Queue {
 public:
  /// Borrows device and queue; `vk` must outlive it.
  Queue(const DeviceFunctions& vk, VkDevice device, VkQueue queue, QueueLock lock = {},
        std::chrono::nanoseconds patience = kPatience);
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  /// Hands over `commands`, in their order, and returns. One submit at a time: wait() before the
  /// next. `answer`: false in tests, where the device is never heard of again. Throws DeviceLost.
  void submit(std::span<const VkCommandBuffer> commands, bool answer = true);
  /// Hands over work that signals `done` itself; nobody waits for it here.
  void submit(const VkSubmitInfo& info, VkFence done);
  /// Until the last submit is done and its results are visible to the host. Throws DeviceLost, also
  /// where that takes too long.
  void wait();
  /// Likewise, until work is done that signals `done`.
  void wait(VkFence done);
  void set_patience(std::chrono::nanoseconds patience) { patience_ = patience; }
  /// It has not answered in time: what it was given may still be at work.
  [[nodiscard]] bool silent() const { return silent_; }
  /// Throws DeviceLost where it is silent: nothing that it may have at work can be used again.
  void check_answers() const;
  /// Waited-for submits so far.
  [[nodiscard]] std::size_t submits() const { return submits_; }

 private:
  const DeviceFunctions& vk_;
  VkDevice device_;
  VkQueue queue_;
  QueueLock lock_;
  std::chrono::nanoseconds patience_;
  VkFence done_ = VK_NULL_HANDLE;
  std::size_t submits_ = 0;
  bool silent_ = false;
};

}  // namespace sunder::vulkan
