// SPDX-License-Identifier: Apache-2.0
// What of VkPhysicalDeviceLimits is relied on, and the sentence where it does not reach.
#pragma once

#include <cstdint>
#include <string>

#include "gpu/vulkan/functions.hpp"

namespace sunder::vulkan {

/// One limit of a device.
struct Limit {
  std::uint64_t value;  ///< at first what Vulkan promises of every device
  const char* field;    ///< Vulkan's name
  const char* of;       ///< what it counts
  const char* instead;  ///< what would do
};

struct Limits {
  Limit groups{65535, "maxComputeWorkGroupCount[0]", "workgroups in one indirect dispatch",
               "use another route, a smaller mesh or backend cpu"};
  /// Along y and z, the lesser.
  Limit rows_of_groups{65535, "maxComputeWorkGroupCount[1] and [2]",
                       "rows of workgroups in one dispatch", "use a smaller mesh or backend cpu"};
  Limit group{128, "maxComputeWorkGroupInvocations and maxComputeWorkGroupSize[0]",
              "invocations in a workgroup", "use backend cpu"};
  Limit shared_bytes{16384, "maxComputeSharedMemorySize", "bytes that a workgroup shares",
                     "use backend cpu"};
  Limit push_bytes{128, "maxPushConstantsSize", "bytes of push constants", "use backend cpu"};
  Limit storage_buffers{4, "maxPerStageDescriptorStorageBuffers", "storage buffers",
                        "use another route or backend cpu"};
  Limit texel_buffers{16, "maxPerStageDescriptorSampledImages", "texel buffers",
                      "use SUNDER_SHADER_VARIANT=gpu or backend cpu"};
  Limit buffers{128, "maxPerStageResources", "buffers", "use another route or backend cpu"};
  Limit buffer_bytes{std::uint64_t{1} << 27, "maxStorageBufferRange", "bytes in one storage buffer",
                     "use precision fp32, another route, a smaller mesh or backend cpu"};
  Limit texels{65536, "maxTexelBufferElements", "texels in one buffer",
               "use a smaller mesh or backend cpu"};
  Limit allocation_bytes{std::uint64_t{1} << 30, "maxMemoryAllocationSize",
                         "bytes in one allocation",
                         "use precision fp32, another route, a smaller mesh or backend cpu"};
  Limit allocations{4096, "maxMemoryAllocationCount", "allocations of memory at a time",
                    "use fewer backends on one device, another route or backend cpu"};
  /// At whose multiples storage and texel buffers begin [bytes], the largest.
  std::uint64_t alignment = 256;
};

/// All of `limits` but the largest allocation, which stands elsewhere.
void read_limits(const VkPhysicalDeviceLimits& from, Limits& limits);

/// Limits that tests lower (the alignment: raise). 0: what the device has.
struct LimitsProbe {
  std::uint64_t groups = 0, rows_of_groups = 0, group = 0, shared_bytes = 0, push_bytes = 0,
                storage_buffers = 0, texel_buffers = 0, buffers = 0, buffer_bytes = 0, texels = 0,
                allocation_bytes = 0, allocations = 0, alignment = 0;
};
void lower(Limits& limits, const LimitsProbe& probe);

/// Throws DeviceError where `who` needs more than `limit` of the device.
void require(std::uint64_t needed, const Limit& limit, const std::string& device,
             const std::string& who);

}  // namespace sunder::vulkan
