// SPDX-License-Identifier: Apache-2.0
// Passes in a command buffer of a host's own, which the host submits.
#pragma once

#include "gpu/vulkan/kernel.hpp"

namespace sunder::vulkan {

class HostCommands {
 public:
  /// `commands`: in the recording state, outside a render pass. What follows waits for all earlier
  /// commands of the queue.
  HostCommands(Device& device, VkCommandBuffer commands);

  template <class Push>
  void dispatch(const Binding& binding, const Push& push, std::uint32_t groups) {
    dispatch(binding, &push, sizeof(Push), groups);
  }
  /// What was dispatched before is seen by what is dispatched after.
  void barrier();
  /// All later commands of the queue, in any stage, see what was written. Leaves bound: a compute
  /// pipeline, descriptor set 0 of its layout, push constants.
  void end();

 private:
  void barrier(VkAccessFlags from, VkAccessFlags to);
  void dispatch(const Binding& binding, const void* push, std::uint32_t bytes,
                std::uint32_t groups);

  const DeviceFunctions& vk_;
  const PhysicalDevice& device_;
  VkCommandBuffer commands_;
};

}  // namespace sunder::vulkan
