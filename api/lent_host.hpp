// SPDX-License-Identifier: Apache-2.0
// A host's device as the backend vulkan takes it.
#pragma once

#include "gpu/vulkan/lent_device.hpp"
#include "sunder/sunder_vulkan.h"

namespace sunder {

/// Nothing is checked but that lock and unlock are both there.
[[nodiscard]] inline vulkan::LentDevice to_lent(const sunder_vulkan_host& host) {
  vulkan::LentDevice lent;
  lent.get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(host.get_instance_proc_addr);
  lent.instance = static_cast<VkInstance>(host.instance);
  lent.physical = static_cast<VkPhysicalDevice>(host.physical_device);
  lent.device = static_cast<VkDevice>(host.device);
  lent.queue = static_cast<VkQueue>(host.queue);
  lent.family = host.queue_family;
  lent.api_version = host.api_version;
  lent.float64 = host.features & SUNDER_VULKAN_SHADER_FLOAT64;
  lent.int64 = host.features & SUNDER_VULKAN_SHADER_INT64;
  lent.timeline_semaphore = host.features & SUNDER_VULKAN_TIMELINE_SEMAPHORE;
  if (host.lock && host.unlock) {
    lent.lock.lock = [lock = host.lock, user = host.lock_user] { lock(user); };
    lent.lock.unlock = [unlock = host.unlock, user = host.lock_user] { unlock(user); };
  }
  return lent;
}

}  // namespace sunder
