// SPDX-License-Identifier: Apache-2.0
// A host's own Vulkan device, lent for as long as a backend lives. Nothing of it is ever destroyed
// here.
#pragma once

#include "gpu/vulkan/device.hpp"

namespace sunder::vulkan {

struct LentDevice {
  PFN_vkGetInstanceProcAddr get = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;       ///< of the queue
  std::uint32_t api_version = 0;  ///< that the instance was created for
  // Features that the host enabled.
  bool float64 = false, int64 = false, timeline_semaphore = false;
  QueueLock lock;
};

/// Queue families of a device whose handles are there. Throws DeviceError for a missing function.
[[nodiscard]] std::uint32_t queue_families(const LentDevice& lent);

/// Throws DeviceError naming what is missing: a handle, a function, Vulkan 1.2, compute on the
/// queue. Takes microseconds: nothing is created.
void check_device(const LentDevice& lent);

/// Throws what check_device throws. What the host did not enable the device counts as lacking.
[[nodiscard]] std::unique_ptr<Device> borrow_device(const LentDevice& lent, DeviceProbe probe = {},
                                                    std::shared_ptr<PipelineCache> cache = {});

}  // namespace sunder::vulkan
