// SPDX-License-Identifier: Apache-2.0
// Vulkan's functions that a picture takes, fetched at run time: the program links no loader, so
// that it still runs where there is none.
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

namespace sunder::app::view {

// One list each; the only macros of this folder, so that a name is written once.
#define SUNDER_VIEW_INSTANCE_FUNCTIONS(X)   \
  X(DestroyInstance)                        \
  X(EnumeratePhysicalDevices)               \
  X(GetPhysicalDeviceProperties)            \
  X(GetPhysicalDeviceFeatures2)             \
  X(GetPhysicalDeviceMemoryProperties)      \
  X(GetPhysicalDeviceQueueFamilyProperties) \
  X(CreateDevice)                           \
  X(GetDeviceProcAddr)

#define SUNDER_VIEW_DEVICE_FUNCTIONS(X) \
  X(DestroyDevice)                      \
  X(GetDeviceQueue)                     \
  X(DeviceWaitIdle)                     \
  X(CreateBuffer)                       \
  X(DestroyBuffer)                      \
  X(GetBufferMemoryRequirements)        \
  X(BindBufferMemory)                   \
  X(CreateImage)                        \
  X(DestroyImage)                       \
  X(GetImageMemoryRequirements)         \
  X(BindImageMemory)                    \
  X(CreateImageView)                    \
  X(DestroyImageView)                   \
  X(AllocateMemory)                     \
  X(FreeMemory)                         \
  X(MapMemory)                          \
  X(CreateShaderModule)                 \
  X(DestroyShaderModule)                \
  X(CreateDescriptorSetLayout)          \
  X(DestroyDescriptorSetLayout)         \
  X(CreateDescriptorPool)               \
  X(DestroyDescriptorPool)              \
  X(AllocateDescriptorSets)             \
  X(UpdateDescriptorSets)               \
  X(CreatePipelineLayout)               \
  X(DestroyPipelineLayout)              \
  X(CreateGraphicsPipelines)            \
  X(DestroyPipeline)                    \
  X(CreateRenderPass)                   \
  X(DestroyRenderPass)                  \
  X(CreateFramebuffer)                  \
  X(DestroyFramebuffer)                 \
  X(CreateCommandPool)                  \
  X(DestroyCommandPool)                 \
  X(AllocateCommandBuffers)             \
  X(BeginCommandBuffer)                 \
  X(EndCommandBuffer)                   \
  X(CmdBeginRenderPass)                 \
  X(CmdEndRenderPass)                   \
  X(CmdBindPipeline)                    \
  X(CmdBindDescriptorSets)              \
  X(CmdPushConstants)                   \
  X(CmdSetViewport)                     \
  X(CmdSetScissor)                      \
  X(CmdDraw)                            \
  X(CmdCopyImageToBuffer)               \
  X(CmdPipelineBarrier)                 \
  X(CreateFence)                        \
  X(DestroyFence)                       \
  X(ResetFences)                        \
  X(WaitForFences)                      \
  X(QueueSubmit)

#define SUNDER_VIEW_MEMBER(name) PFN_vk##name name = nullptr;

struct InstanceFunctions {
  SUNDER_VIEW_INSTANCE_FUNCTIONS(SUNDER_VIEW_MEMBER)
};
struct DeviceFunctions {
  SUNDER_VIEW_DEVICE_FUNCTIONS(SUNDER_VIEW_MEMBER)
};

#undef SUNDER_VIEW_MEMBER

/// Throws DeviceError that names the call where it has not succeeded.
void check(VkResult result, const char* call);

}  // namespace sunder::app::view
