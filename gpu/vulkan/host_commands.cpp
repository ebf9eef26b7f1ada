// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/host_commands.hpp"

#include "gpu/vulkan/folded_groups.hpp"

namespace sunder::vulkan {

HostCommands::HostCommands(Device& device, VkCommandBuffer commands)
    : vk_(device.vk()), device_(device.physical()), commands_(commands) {
  device.flush();
  barrier(VK_ACCESS_MEMORY_WRITE_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

void HostCommands::barrier() {
  barrier(VK_ACCESS_SHADER_WRITE_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

void HostCommands::end() { barrier(VK_ACCESS_SHADER_WRITE_BIT, VK_ACCESS_MEMORY_READ_BIT); }

void HostCommands::barrier(VkAccessFlags from, VkAccessFlags to) {
  VkMemoryBarrier memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
  memory.srcAccessMask = from;
  memory.dstAccessMask = to;
  // All stages: a host's queue may be one of compute alone, where vertex stages may not be named.
  vk_.CmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

void HostCommands::dispatch(const Binding& binding, const void* push, std::uint32_t bytes,
                            std::uint32_t groups) {
  const Kernel& kernel = binding.kernel();
  const VkDescriptorSet set = binding.set();
  vk_.CmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
  vk_.CmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1, &set,
                            0, nullptr);
  vk_.CmdPushConstants(commands_, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, bytes, push);
  const FoldedGroups folded(device_, kernel, groups, 1);
  folded.dispatch_rows(vk_, commands_);
  if (folded.rest == 0) return;
  barrier();
  folded.dispatch_rest(vk_, commands_);
}

}  // namespace sunder::vulkan
