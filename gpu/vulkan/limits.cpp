// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/limits.hpp"

#include <algorithm>

#include "sunder/error.hpp"

namespace sunder::vulkan {

void read_limits(const VkPhysicalDeviceLimits& from, Limits& limits) {
  limits.groups.value = from.maxComputeWorkGroupCount[0];
  limits.rows_of_groups.value =
      std::min(from.maxComputeWorkGroupCount[1], from.maxComputeWorkGroupCount[2]);
  limits.group.value =
      std::min(from.maxComputeWorkGroupInvocations, from.maxComputeWorkGroupSize[0]);
  limits.shared_bytes.value = from.maxComputeSharedMemorySize;
  limits.push_bytes.value = from.maxPushConstantsSize;
  limits.storage_buffers.value =
      std::min(from.maxPerStageDescriptorStorageBuffers, from.maxDescriptorSetStorageBuffers);
  limits.texel_buffers.value =
      std::min(from.maxPerStageDescriptorSampledImages, from.maxDescriptorSetSampledImages);
  limits.buffers.value = from.maxPerStageResources;
  limits.buffer_bytes.value = from.maxStorageBufferRange;
  limits.texels.value = from.maxTexelBufferElements;
  limits.allocations.value = from.maxMemoryAllocationCount;
  limits.alignment =
      std::max(from.minStorageBufferOffsetAlignment, from.minTexelBufferOffsetAlignment);
}

void lower(Limits& limits, const LimitsProbe& probe) {
  const auto to = [](Limit& limit, std::uint64_t value) {
    if (value > 0) limit.value = std::min(limit.value, value);
  };
  to(limits.groups, probe.groups);
  to(limits.rows_of_groups, probe.rows_of_groups);
  to(limits.group, probe.group);
  to(limits.shared_bytes, probe.shared_bytes);
  to(limits.push_bytes, probe.push_bytes);
  to(limits.storage_buffers, probe.storage_buffers);
  to(limits.texel_buffers, probe.texel_buffers);
  to(limits.buffers, probe.buffers);
  to(limits.buffer_bytes, probe.buffer_bytes);
  to(limits.texels, probe.texels);
  to(limits.allocation_bytes, probe.allocation_bytes);
  to(limits.allocations, probe.allocations);
  limits.alignment = std::max(limits.alignment, probe.alignment);
}

void require(std::uint64_t needed, const Limit& limit, const std::string& device,
             const std::string& who) {
  if (needed <= limit.value) return;
  throw DeviceError(who + " needs " + std::to_string(needed) + " " + limit.of +
                    ", but the Vulkan device \"" + device + "\" takes " +
                    std::to_string(limit.value) + " (" + limit.field + "); " + limit.instead);
}

}  // namespace sunder::vulkan
