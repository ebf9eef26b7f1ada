// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/queue.hpp"

#include <cstdint>

#include "gpu/vulkan/check.hpp"

namespace sunder::vulkan {
namespace {

/// Holds a host's queue for the length of one call.
class Hold {
 public:
  explicit Hold(const QueueLock& lock) : lock_(lock) {
    if (lock_.lock) lock_.lock();
  }
  ~Hold() {
    if (lock_.unlock) lock_.unlock();
  }
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;

 private:
  const QueueLock& lock_;
};

}  // namespace

Queue::Queue(const DeviceFunctions& vk, VkDevice device, VkQueue queue, QueueLock lock)
    : vk_(vk), device_(device), queue_(queue), lock_(std::move(lock)) {
  VkFenceCreateInfo fence{};
  fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  check(vk_.CreateFence(device_, &fence, nullptr, &done_), "vkCreateFence");
}

Queue::~Queue() { vk_.DestroyFence(device_, done_, nullptr); }

void Queue::submit(std::span<const VkCommandBuffer> commands) {
  VkSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  info.commandBufferCount = static_cast<std::uint32_t>(commands.size());
  info.pCommandBuffers = commands.data();
  check(vk_.ResetFences(device_, 1, &done_), "vkResetFences");
  const Hold hold(lock_);
  check(vk_.QueueSubmit(queue_, 1, &info, done_), "vkQueueSubmit");
}

void Queue::submit(const VkSubmitInfo& info, VkFence done) {
  const Hold hold(lock_);
  check(vk_.QueueSubmit(queue_, 1, &info, done), "vkQueueSubmit");
}

void Queue::wait() {
  check(vk_.WaitForFences(device_, 1, &done_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  ++submits_;
}

}  // namespace sunder::vulkan
