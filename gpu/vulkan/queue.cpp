// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/queue.hpp"

#include <cstdint>
#include <sstream>

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

[[noreturn]] void throw_silent(std::chrono::nanoseconds patience) {
  std::ostringstream text;
  text << "the Vulkan device does not answer: what it was given "
       << std::chrono::duration<double>(patience).count()
       << " s ago is not done; it counts as lost, and what it held is gone";
  throw DeviceLost(text.str());
}

}  // namespace

Queue::Queue(const DeviceFunctions& vk, VkDevice device, VkQueue queue, QueueLock lock,
             std::chrono::nanoseconds patience)
    : vk_(vk), device_(device), queue_(queue), lock_(std::move(lock)), patience_(patience) {
  VkFenceCreateInfo fence{};
  fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  check(vk_.CreateFence(device_, &fence, nullptr, &done_), "vkCreateFence");
}

Queue::~Queue() { vk_.DestroyFence(device_, done_, nullptr); }

void Queue::check_answers() const {
  if (silent_) throw_silent(patience_);
}

void Queue::submit(std::span<const VkCommandBuffer> commands, bool answer) {
  check_answers();
  VkSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  info.commandBufferCount = static_cast<std::uint32_t>(commands.size());
  info.pCommandBuffers = commands.data();
  check(vk_.ResetFences(device_, 1, &done_), "vkResetFences");
  const Hold hold(lock_);
  check(vk_.QueueSubmit(queue_, 1, &info, answer ? done_ : VK_NULL_HANDLE), "vkQueueSubmit");
}

void Queue::submit(const VkSubmitInfo& info, VkFence done) {
  check_answers();
  const Hold hold(lock_);
  check(vk_.QueueSubmit(queue_, 1, &info, done), "vkQueueSubmit");
}

void Queue::wait() {
  wait(done_);
  ++submits_;
}

void Queue::wait(VkFence done) {
  const auto nanoseconds = static_cast<std::uint64_t>(patience_.count());
  const VkResult result = vk_.WaitForFences(device_, 1, &done, VK_TRUE, nanoseconds);
  silent_ = silent_ || result == VK_TIMEOUT;
  check_answers();
  check(result, "vkWaitForFences");
}

}  // namespace sunder::vulkan
