// SPDX-License-Identifier: Apache-2.0
// A host's device as the library takes it from the C interface.
#pragma once

#include "api/vulkan_host.hpp"
#include "gpu/vulkan_backend.hpp"

namespace sunder::test {

[[nodiscard]] inline gpu::VulkanOptions options_of(const VulkanHost& host) {
  gpu::VulkanOptions options;
  const sunder_vulkan_host lent = host.lend();
  options.lent.emplace();
  options.lent->get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(lent.get_instance_proc_addr);
  options.lent->instance = host.instance;
  options.lent->physical = host.physical;
  options.lent->device = host.device;
  options.lent->queue = host.queue;
  options.lent->family = host.family;
  options.lent->api_version = lent.api_version;
  options.lent->float64 = options.lent->int64 = true;
  options.lent->lock.lock = [lent] { lent.lock(nullptr); };
  options.lent->lock.unlock = [lent] { lent.unlock(nullptr); };
  return options;
}

}  // namespace sunder::test
