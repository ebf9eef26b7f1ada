// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/display.hpp"

#include <algorithm>

#include "gpu/vulkan/check.hpp"
#include "gpu/vulkan/host_commands.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {

DisplayBytes display_bytes(const Problem& problem) {
  const auto nodes = static_cast<std::uint64_t>(problem.node_count());
  const auto elements = static_cast<std::uint64_t>(problem.tet_count());
  return {16 * nodes, 8 * elements, 4 * elements};
}

Display::Display(const KernelFactory& kernels, const Problem& problem, const Fields& fields,
                 bool has_stress, const DisplayTargets& targets, bool timeline)
    : device_(kernels.device()),
      push_{static_cast<std::uint32_t>(problem.node_count()),
            static_cast<std::uint32_t>(problem.tet_count()), has_stress ? 1u : 0u},
      timeline_(timeline),
      displacement_(
          target(targets.displacement, display_bytes(problem).displacement, "displacement")),
      stress_(target(targets.stress, display_bytes(problem).stress, "stress")),
      live_(target(targets.live, display_bytes(problem).live, "liveness")),
      kernel_(kernels.make("display")) {
  const vulkan::Buffer* buffers[] = {&fields.nodal(Field::displacement),
                                     &fields.stress(),
                                     &fields.facts(),
                                     &displacement_,
                                     &stress_,
                                     &live_};
  binding_ = std::make_unique<vulkan::Binding>(device_, *kernel_, buffers);
}

Display::~Display() {
  const auto& vk = device_.vk();
  try {
    finish();
  } catch (const DeviceError&) {  // nobody is left to be told
  }
  vk.DestroyFence(device_.handle(), done_, nullptr);
  if (own_) vk.FreeCommandBuffers(device_.handle(), device_.command_pool(), 1, &own_);
}

vulkan::Buffer Display::target(const DisplayTarget& given, std::size_t bytes,
                               const char* what) const {
  if (!given.buffer) return {device_, bytes, vulkan::Placement::device};
  if (given.bytes < bytes) {
    throw DeviceError(std::string("the host's buffer for ") + what + " has " +
                      std::to_string(given.bytes) + " bytes; " + std::to_string(bytes) +
                      " are needed");
  }
  if (given.offset % kDisplayAlignment != 0) {
    throw DeviceError(std::string("the host's buffer for ") + what + " begins at byte " +
                      std::to_string(given.offset) + "; it must begin at a multiple of " +
                      std::to_string(kDisplayAlignment));
  }
  return vulkan::Buffer::lent(given.buffer, given.offset, bytes);
}

void Display::record(VkCommandBuffer commands) const {
  vulkan::HostCommands out(device_, commands);
  const std::uint32_t count = std::max(push_.nodes, push_.elements);
  out.dispatch(*binding_, push_, round_up(count, shaders::kGroup) / shaders::kGroup);
  out.end();
}

void Display::create_own_commands() {
  const auto& vk = device_.vk();
  VkFenceCreateInfo fence{};
  fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  vulkan::check(vk.CreateFence(device_.handle(), &fence, nullptr, &done_), "vkCreateFence");
  VkCommandBufferAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  info.commandPool = device_.command_pool();
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  vulkan::check(vk.AllocateCommandBuffers(device_.handle(), &info, &own_),
                "vkAllocateCommandBuffers");
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  vulkan::check(vk.BeginCommandBuffer(own_, &begin), "vkBeginCommandBuffer");
  record(own_);
  vulkan::check(vk.EndCommandBuffer(own_), "vkEndCommandBuffer");
}

void Display::submit(const DisplaySignals& signals) {
  if (!timeline_ && (signals.wait || signals.signal)) {
    throw DeviceError(
        "the host did not enable the feature timelineSemaphore, which a submit with semaphores "
        "needs");
  }
  finish();
  if (!own_) create_own_commands();
  const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
  VkTimelineSemaphoreSubmitInfo values{};
  values.sType = VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO;
  VkSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  info.pNext = &values;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &own_;
  info.pWaitDstStageMask = &stage;
  if (signals.wait) {
    info.waitSemaphoreCount = values.waitSemaphoreValueCount = 1;
    info.pWaitSemaphores = &signals.wait;
    values.pWaitSemaphoreValues = &signals.wait_value;
  }
  if (signals.signal) {
    info.signalSemaphoreCount = values.signalSemaphoreValueCount = 1;
    info.pSignalSemaphores = &signals.signal;
    values.pSignalSemaphoreValues = &signals.signal_value;
  }
  vulkan::check(device_.vk().ResetFences(device_.handle(), 1, &done_), "vkResetFences");
  device_.hand_over(info, done_);
  pending_ = true;
}

void Display::finish() {
  if (!pending_) return;
  pending_ = false;
  device_.wait(done_);
}

}  // namespace sunder::gpu
