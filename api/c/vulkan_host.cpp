// SPDX-License-Identifier: Apache-2.0
#include "c/vulkan_host.hpp"

#ifdef SUNDER_GPU
#include "lent_host.hpp"

namespace sunder::c {
namespace {

gpu::DisplayTarget to_target(const sunder_vulkan_buffer& b) {
  return {reinterpret_cast<VkBuffer>(b.buffer), b.offset, b.size};
}

void check_handles(const sunder_vulkan_host& host) {
  if (!host.get_instance_proc_addr) {
    throw Failure(SUNDER_ERROR_NULL, "host: get_instance_proc_addr is null");
  }
  require(host.instance, "host: instance");
  require(host.physical_device, "host: physical_device");
  require(host.device, "host: device");
  require(host.queue, "host: queue");
  if (!host.lock != !host.unlock) {
    throw Failure(SUNDER_ERROR_NULL, "host: lock and unlock come in pairs; one of them is null");
  }
}

void check_features(const sunder_vulkan_host& host) {
  constexpr std::uint32_t known =
      SUNDER_VULKAN_SHADER_FLOAT64 | SUNDER_VULKAN_SHADER_INT64 | SUNDER_VULKAN_TIMELINE_SEMAPHORE;
  if (host.features & ~known) {
    throw Failure(SUNDER_ERROR_VALUE, "host: features = " + std::to_string(host.features) +
                                          " is no sum of SUNDER_VULKAN_SHADER_FLOAT64, " +
                                          "_SHADER_INT64 and _TIMELINE_SEMAPHORE");
  }
}

}  // namespace

void check_host(const sunder_vulkan_host& host) {
  check_handles(host);
  check_features(host);
  const auto lent = to_lent(host);
  require_index(host.queue_family, vulkan::queue_families(lent), "host: queue_family");
  vulkan::check_device(lent);
}

gpu::VulkanOptions to_options(const sunder_vulkan_host& host) {
  gpu::VulkanOptions options = gpu::options_from_environment();
  options.lent = to_lent(host);
  options.display = {to_target(host.displacement), to_target(host.stress), to_target(host.live)};
  return options;
}

}  // namespace sunder::c
#endif
