// SPDX-License-Identifier: Apache-2.0
// Vulkan's functions, fetched at run time: the library links no loader, so that a machine without
// one still runs the CPU backend.
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

namespace sunder::vulkan {

// One list each; the only macros of this folder, so that a name is written once.
#define SUNDER_VK_INSTANCE_FUNCTIONS(X)     \
  X(DestroyInstance)                        \
  X(EnumeratePhysicalDevices)               \
  X(EnumerateDeviceExtensionProperties)     \
  X(GetPhysicalDeviceProperties2)           \
  X(GetPhysicalDeviceFeatures2)             \
  X(GetPhysicalDeviceMemoryProperties)      \
  X(GetPhysicalDeviceQueueFamilyProperties) \
  X(CreateDevice)                           \
  X(GetDeviceProcAddr)

#define SUNDER_VK_DEVICE_FUNCTIONS(X) \
  X(DestroyDevice)                    \
  X(GetDeviceQueue)                   \
  X(DeviceWaitIdle)                   \
  X(CreateBuffer)                     \
  X(DestroyBuffer)                    \
  X(GetBufferMemoryRequirements)      \
  X(AllocateMemory)                   \
  X(FreeMemory)                       \
  X(BindBufferMemory)                 \
  X(MapMemory)                        \
  X(CreateBufferView)                 \
  X(DestroyBufferView)                \
  X(CreateShaderModule)               \
  X(DestroyShaderModule)              \
  X(CreateDescriptorSetLayout)        \
  X(DestroyDescriptorSetLayout)       \
  X(CreatePipelineLayout)             \
  X(DestroyPipelineLayout)            \
  X(CreateComputePipelines)           \
  X(CreatePipelineCache)              \
  X(DestroyPipelineCache)             \
  X(GetPipelineCacheData)             \
  X(DestroyPipeline)                  \
  X(CreateDescriptorPool)             \
  X(DestroyDescriptorPool)            \
  X(AllocateDescriptorSets)           \
  X(UpdateDescriptorSets)             \
  X(CreateCommandPool)                \
  X(DestroyCommandPool)               \
  X(AllocateCommandBuffers)           \
  X(FreeCommandBuffers)               \
  X(BeginCommandBuffer)               \
  X(EndCommandBuffer)                 \
  X(CmdBindPipeline)                  \
  X(CmdBindDescriptorSets)            \
  X(CmdPushConstants)                 \
  X(CmdDispatch)                      \
  X(CmdDispatchBase)                  \
  X(CmdDispatchIndirect)              \
  X(CmdPipelineBarrier)               \
  X(CmdCopyBuffer)                    \
  X(CmdFillBuffer)                    \
  X(CmdResetQueryPool)                \
  X(CmdWriteTimestamp)                \
  X(CreateQueryPool)                  \
  X(DestroyQueryPool)                 \
  X(GetQueryPoolResults)              \
  X(CreateFence)                      \
  X(DestroyFence)                     \
  X(ResetFences)                      \
  X(WaitForFences)                    \
  X(QueueSubmit)

#define SUNDER_VK_MEMBER(name) PFN_vk##name name = nullptr;

struct InstanceFunctions {
  SUNDER_VK_INSTANCE_FUNCTIONS(SUNDER_VK_MEMBER)
  // Of VK_EXT_debug_utils; null where validation is off.
  SUNDER_VK_MEMBER(CreateDebugUtilsMessengerEXT)
  SUNDER_VK_MEMBER(DestroyDebugUtilsMessengerEXT)
};

struct DeviceFunctions {
  SUNDER_VK_DEVICE_FUNCTIONS(SUNDER_VK_MEMBER)
};

#undef SUNDER_VK_MEMBER

/// Throw DeviceError when the driver lacks one.
[[nodiscard]] InstanceFunctions load_functions(PFN_vkGetInstanceProcAddr get, VkInstance instance);
[[nodiscard]] DeviceFunctions load_functions(PFN_vkGetDeviceProcAddr get, VkDevice device);

}  // namespace sunder::vulkan
