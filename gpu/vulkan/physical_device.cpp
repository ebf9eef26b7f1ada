// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/physical_device.hpp"

#include <algorithm>
#include <string_view>

namespace sunder::vulkan {
namespace {

bool offers(const InstanceFunctions& vk, VkPhysicalDevice device, std::string_view extension) {
  std::uint32_t count = 0;
  vk.EnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> list(count);
  vk.EnumerateDeviceExtensionProperties(device, nullptr, &count, list.data());
  return std::ranges::any_of(list, [&](const VkExtensionProperties& offered) {
    return extension == offered.extensionName;
  });
}

/// Without the extension nobody knows which sizes a driver chooses from.
void read_subgroup_control(const InstanceFunctions& vk, PhysicalDevice& device) {
  if (!offers(vk, device.handle, VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME)) return;
  VkPhysicalDeviceSubgroupSizeControlProperties sizes{};
  sizes.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_PROPERTIES;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &sizes;
  vk.GetPhysicalDeviceProperties2(device.handle, &properties);
  VkPhysicalDeviceSubgroupSizeControlFeatures control{};
  control.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES;
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features.pNext = &control;
  vk.GetPhysicalDeviceFeatures2(device.handle, &features);
  device.subgroup_varies = sizes.minSubgroupSize != sizes.maxSubgroupSize;
  device.subgroup_on_request =
      control.subgroupSizeControl &&
      (sizes.requiredSubgroupSizeStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0 &&
      sizes.minSubgroupSize <= device.subgroup && device.subgroup <= sizes.maxSubgroupSize;
}

void read_properties(const InstanceFunctions& vk, PhysicalDevice& device) {
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceMaintenance3Properties maintenance{};
  maintenance.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES;
  maintenance.pNext = &driver;
  VkPhysicalDeviceSubgroupProperties subgroup{};
  subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
  subgroup.pNext = &maintenance;
  VkPhysicalDeviceProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  properties.pNext = &subgroup;
  vk.GetPhysicalDeviceProperties2(device.handle, &properties);
  const VkPhysicalDeviceProperties& p = properties.properties;
  device.name = p.deviceName;
  device.driver = std::string(driver.driverName) + " " + driver.driverInfo;
  device.driver_id = driver.driverID;
  device.type = p.deviceType;
  device.api_version = p.apiVersion;
  device.vendor = p.vendorID;
  device.device = p.deviceID;
  std::ranges::copy(p.pipelineCacheUUID, device.cache_uuid.begin());
  device.timestamp_period = static_cast<double>(p.limits.timestampPeriod);
  read_limits(p.limits, device.limits);
  device.limits.allocation_bytes.value = maintenance.maxMemoryAllocationSize;
  device.subgroup = subgroup.subgroupSize;
  constexpr VkSubgroupFeatureFlags needed =
      VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_ARITHMETIC_BIT;
  device.subgroup_arithmetic = (subgroup.supportedOperations & needed) == needed &&
                               (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0;
}

void read_features(const InstanceFunctions& vk, PhysicalDevice& device) {
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  vk.GetPhysicalDeviceFeatures2(device.handle, &features);
  device.float64 = features.features.shaderFloat64;
  device.int64 = features.features.shaderInt64;
  device.portable_subset = offers(vk, device.handle, kPortabilitySubset);
}

void read_memory(const InstanceFunctions& vk, PhysicalDevice& device) {
  VkPhysicalDeviceMemoryProperties memory{};
  vk.GetPhysicalDeviceMemoryProperties(device.handle, &memory);
  for (std::uint32_t h = 0; h < memory.memoryHeapCount; ++h) {
    if (memory.memoryHeaps[h].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) {
      device.memory = std::max(device.memory, memory.memoryHeaps[h].size);
    }
  }
  device.maps = maps_its_memory(memory);
}

}  // namespace

bool maps_its_memory(const VkPhysicalDeviceMemoryProperties& memory) {
  constexpr VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                           VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                           VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  VkDeviceSize largest = 0, mapped = 0;
  for (std::uint32_t t = 0; t < memory.memoryTypeCount; ++t) {
    const VkMemoryType& type = memory.memoryTypes[t];
    const VkMemoryHeap& heap = memory.memoryHeaps[type.heapIndex];
    if (!(heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)) continue;
    largest = std::max(largest, heap.size);
    if ((type.propertyFlags & wanted) == wanted) mapped = std::max(mapped, heap.size);
  }
  return largest > 0 && mapped == largest;
}

namespace {

void read_queues(const InstanceFunctions& vk, PhysicalDevice& device) {
  std::uint32_t count = 0;
  vk.GetPhysicalDeviceQueueFamilyProperties(device.handle, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vk.GetPhysicalDeviceQueueFamilyProperties(device.handle, &count, families.data());
  for (std::uint32_t f = 0; f < count; ++f) {
    if (!(families[f].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
    device.compute_family = static_cast<int>(f);
    device.timestamp_bits = families[f].timestampValidBits;
    return;
  }
}

}  // namespace

std::string PhysicalDevice::shortcoming() const {
  if (api_version < VK_API_VERSION_1_2) {
    return "it offers Vulkan " + std::to_string(VK_API_VERSION_MAJOR(api_version)) + "." +
           std::to_string(VK_API_VERSION_MINOR(api_version)) + " only; 1.2 is needed";
  }
  if (compute_family < 0) return "it has no compute queue";
  if (!subgroup_arithmetic) return "its subgroups offer no arithmetic in compute kernels";
  return {};
}

PhysicalDevice describe_device(const InstanceFunctions& vk, VkPhysicalDevice handle) {
  PhysicalDevice device;
  device.handle = handle;
  read_properties(vk, device);
  read_subgroup_control(vk, device);
  read_features(vk, device);
  read_memory(vk, device);
  read_queues(vk, device);
  return device;
}

std::vector<PhysicalDevice> list_devices(const Instance& instance) {
  std::vector<PhysicalDevice> devices;
  for (VkPhysicalDevice handle : instance.physical_devices()) {
    devices.push_back(describe_device(instance.vk(), handle));
  }
  return devices;
}

}  // namespace sunder::vulkan
