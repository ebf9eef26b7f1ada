// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/lent_device.hpp"

#include "sunder/error.hpp"

namespace sunder::vulkan {
namespace {

void require(bool there, const std::string& what) {
  if (!there) throw DeviceError("the host's Vulkan device cannot be used: " + what);
}

void check_handles(const LentDevice& lent) {
  require(lent.get != nullptr, "vkGetInstanceProcAddr is null");
  require(lent.instance != VK_NULL_HANDLE, "the instance is null");
  require(lent.physical != VK_NULL_HANDLE, "the physical device is null");
  require(lent.device != VK_NULL_HANDLE, "the device is null");
  require(lent.queue != VK_NULL_HANDLE, "the queue is null");
}

std::vector<VkQueueFamilyProperties> families_of(const InstanceFunctions& vk,
                                                 VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vk.GetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vk.GetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  return families;
}

void check_family(const InstanceFunctions& vk, const LentDevice& lent, PhysicalDevice& physical) {
  const auto families = families_of(vk, lent.physical);
  require(lent.family < families.size(), "it has no queue family " + std::to_string(lent.family));
  require(families[lent.family].queueFlags & VK_QUEUE_COMPUTE_BIT,
          "queue family " + std::to_string(lent.family) + " cannot compute");
  physical.compute_family = static_cast<int>(lent.family);
  physical.timestamp_bits = families[lent.family].timestampValidBits;
}

void check_features(const LentDevice& lent, const PhysicalDevice& physical) {
  require(lent.api_version >= VK_API_VERSION_1_2,
          "its instance was created for Vulkan " +
              std::to_string(VK_API_VERSION_MAJOR(lent.api_version)) + "." +
              std::to_string(VK_API_VERSION_MINOR(lent.api_version)) + "; 1.2 is needed");
  const std::string shortcoming = physical.shortcoming();
  require(shortcoming.empty(), shortcoming);
}

PhysicalDevice checked(const InstanceFunctions& vk, const LentDevice& lent) {
  PhysicalDevice physical = describe_device(vk, lent.physical);
  check_family(vk, lent, physical);
  check_features(lent, physical);
  return physical;
}

}  // namespace

std::uint32_t queue_families(const LentDevice& lent) {
  check_handles(lent);
  const InstanceFunctions vk = load_functions(lent.get, lent.instance);
  return static_cast<std::uint32_t>(families_of(vk, lent.physical).size());
}

void check_device(const LentDevice& lent) {
  check_handles(lent);
  const InstanceFunctions vk = load_functions(lent.get, lent.instance);
  static_cast<void>(checked(vk, lent));
  static_cast<void>(load_functions(vk.GetDeviceProcAddr, lent.device));
}

std::unique_ptr<Device> borrow_device(const LentDevice& lent, DeviceProbe probe,
                                      std::shared_ptr<PipelineCache> cache) {
  check_handles(lent);
  const InstanceFunctions vk = load_functions(lent.get, lent.instance);
  PhysicalDevice physical = checked(vk, lent);
  DeviceHandles handles;
  handles.device = lent.device;
  handles.queue = lent.queue;
  handles.family = lent.family;
  handles.lock = lent.lock;
  handles.int64 = lent.int64;
  physical.int64 = lent.int64;
  physical.float64 = lent.float64;
  physical.subgroup_on_request = false;  // the host need not have enabled it
  physical = probed(std::move(physical), probe);
  handles.vk = load_functions(vk.GetDeviceProcAddr, lent.device);
  vk.GetPhysicalDeviceMemoryProperties(lent.physical, &handles.memory);
  // Validation is the host's; its messages go to the host.
  return std::make_unique<Device>(std::move(handles), std::move(physical),
                                  std::make_shared<Messages>(), probe, std::move(cache));
}

}  // namespace sunder::vulkan
