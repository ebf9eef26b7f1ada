// SPDX-License-Identifier: Apache-2.0
#include "app/view/vulkan/commands.hpp"

#include <limits>

namespace sunder::app::view {

Commands::Commands(Device& device) : device_(device) {
  const DeviceFunctions& vk = device.vk();
  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = device.family();
  pool_ = make<VkCommandPool>(device, vk.CreateCommandPool, pool, vk.DestroyCommandPool,
                              "vkCreateCommandPool");
  VkCommandBufferAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocate.commandPool = pool_.get();
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  check(vk.AllocateCommandBuffers(device.handle(), &allocate, &buffer_),
        "vkAllocateCommandBuffers");
  VkFenceCreateInfo fence{};
  fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  fence_ = make<VkFence>(device, vk.CreateFence, fence, vk.DestroyFence, "vkCreateFence");
}

VkCommandBuffer Commands::begin() {
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(device_.vk().BeginCommandBuffer(buffer_, &begin), "vkBeginCommandBuffer");
  return buffer_;
}

void Commands::run(VkSemaphore after, VkSemaphore done) {
  const DeviceFunctions& vk = device_.vk();
  check(vk.EndCommandBuffer(buffer_), "vkEndCommandBuffer");
  const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
  VkSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  info.waitSemaphoreCount = after ? 1 : 0;
  info.pWaitSemaphores = &after;
  info.pWaitDstStageMask = &stage;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &buffer_;
  info.signalSemaphoreCount = done ? 1 : 0;
  info.pSignalSemaphores = &done;
  device_.submit(info, fence_.get());
  constexpr auto kForever = std::numeric_limits<std::uint64_t>::max();
  check(vk.WaitForFences(device_.handle(), 1, fence_.address(), VK_TRUE, kForever),
        "vkWaitForFences");
  check(vk.ResetFences(device_.handle(), 1, fence_.address()), "vkResetFences");
}

}  // namespace sunder::app::view
