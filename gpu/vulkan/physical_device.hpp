// SPDX-License-Identifier: Apache-2.0
// What a machine's Vulkan devices offer, and which of them can run the kernels.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "gpu/vulkan/instance.hpp"
#include "gpu/vulkan/limits.hpp"

namespace sunder::vulkan {

/// Vulkan's header has it among what is not final yet.
inline constexpr const char* kPortabilitySubset = "VK_KHR_portability_subset";

struct PhysicalDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  std::string name, driver;
  VkPhysicalDeviceType type = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  VkDriverId driver_id = VK_DRIVER_ID_MAX_ENUM;
  std::uint32_t api_version = 0;
  std::uint32_t vendor = 0, device = 0;                 ///< Vulkan's numbers of them
  std::array<std::uint8_t, VK_UUID_SIZE> cache_uuid{};  ///< of what the driver makes of kernels
  bool float64 = false, int64 = false;
  int compute_family = -1;           ///< queue family, -1: none
  std::uint32_t timestamp_bits = 0;  ///< of that family
  double timestamp_period = 0;       ///< [ns]
  VkDeviceSize memory = 0;           ///< largest device-local heap [bytes]
  bool maps = false;                 ///< the host can map all of that heap
  Limits limits;
  std::uint32_t subgroup = 0;       ///< invocations of a subgroup
  bool subgroup_arithmetic = true;  ///< sums and extrema over one, in compute kernels
  /// A compute kernel may ask for subgroups of this size (VK_EXT_subgroup_size_control).
  bool subgroup_on_request = false;
  bool portable_subset = false;  ///< of Vulkan (VK_KHR_portability_subset): it must be told so
  bool subgroup_varies = true;  ///< a driver may choose another size for a kernel that does not ask

  /// A processor that emulates a GPU (lavapipe, say).
  [[nodiscard]] bool is_cpu() const { return type == VK_PHYSICAL_DEVICE_TYPE_CPU; }
  /// Kernels of known subgroups (the lvp variant's) can be had.
  [[nodiscard]] bool subgroup_known() const { return subgroup_on_request || !subgroup_varies; }
  /// Memory is one for host and device.
  [[nodiscard]] bool unified() const {
    return is_cpu() || type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
  }
  /// Why the kernels cannot run there; empty: they can.
  [[nodiscard]] std::string shortcoming() const;
  /// Throws DeviceError where `who` needs more than `limit`, which is one of `limits`.
  void require(std::uint64_t needed, const Limit& limit, const std::string& who) const {
    vulkan::require(needed, limit, name, who);
  }
};

/// Whether the host can map all of its largest device-local heap, not a window into that alone.
[[nodiscard]] bool maps_its_memory(const VkPhysicalDeviceMemoryProperties& memory);

[[nodiscard]] PhysicalDevice describe_device(const InstanceFunctions& vk, VkPhysicalDevice handle);

/// In the driver's order.
[[nodiscard]] std::vector<PhysicalDevice> list_devices(const Instance& instance);

}  // namespace sunder::vulkan
