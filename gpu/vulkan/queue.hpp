// SPDX-License-Identifier: Apache-2.0
// The one place where work reaches a Vulkan queue, of our own or a host's.
#pragma once

#include <functional>
#include <span>

#include "gpu/vulkan/functions.hpp"

namespace sunder::vulkan {

/// Vulkan wants one thread at a time in a queue. A host that uses its queue from other threads says
/// how to take and release it; empty: nobody else uses it.
struct QueueLock {
  std::function<void()> lock, unlock;
};

class Queue {
 public:
  /// Borrows device and queue; `vk` must outlive it.
  Queue(const DeviceFunctions& vk, VkDevice device, VkQueue queue, QueueLock lock = {});
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  /// Hands over `commands`, in their order, and returns. One submit at a time: wait() before the
  /// next.
  void submit(std::span<const VkCommandBuffer> commands);
  /// Hands over work that signals `done` itself; nobody waits for it here.
  void submit(const VkSubmitInfo& info, VkFence done);
  /// Until the last submit is done and its results are visible to the host.
  void wait();
  /// Waited-for submits so far.
  [[nodiscard]] std::size_t submits() const { return submits_; }

 private:
  const DeviceFunctions& vk_;
  VkDevice device_;
  VkQueue queue_;
  QueueLock lock_;
  VkFence done_ = VK_NULL_HANDLE;
  std::size_t submits_ = 0;
};

}  // namespace sunder::vulkan
