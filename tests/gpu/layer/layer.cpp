// SPDX-License-Identifier: Apache-2.0
// What every layer has: its place between the loader and the next.
#include "layer.hpp"

#include <vulkan/vk_layer.h>

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string_view>

namespace sunder::layer {
namespace {

std::mutex mutex;
// By the loader's dispatch table, which all that is made of an instance or a device shares.
std::map<void*, InstanceNext> instances;
std::map<void*, DeviceNext> devices;

void* table_of(const void* handle) { return *static_cast<void* const*>(handle); }

/// The loader's link to the next layer, in the chain of what something is created by.
template <class Info>
Info* link_of(const void* chain, VkStructureType type) {
  for (auto* at = static_cast<const VkBaseInStructure*>(chain); at; at = at->pNext) {
    auto* info = reinterpret_cast<Info*>(const_cast<VkBaseInStructure*>(at));
    if (at->sType == type && info->function == VK_LAYER_LINK_INFO) return info;
  }
  return nullptr;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info,
                                               const VkAllocationCallbacks* allocator,
                                               VkInstance* instance) {
  auto* link = link_of<VkLayerInstanceCreateInfo>(info->pNext,
                                                  VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(get(nullptr, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  if (result == VK_SUCCESS) {
    const std::lock_guard lock(mutex);
    instances[table_of(*instance)] = {get, *instance};
  }
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical,
                                             const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* allocator,
                                             VkDevice* device) {
  auto* link =
      link_of<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  const PFN_vkGetDeviceProcAddr device_get = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  DeviceWish wish;
  wish.info = *info;
  wish.extensions.assign(info->ppEnabledExtensionNames,
                         info->ppEnabledExtensionNames + info->enabledExtensionCount);
  wish.queues.assign(info->pQueueCreateInfos, info->pQueueCreateInfos + info->queueCreateInfoCount);
  if (mode() == "families") ask_for_one_family(wish);
  if (mode() == "portable") {
    if (const VkResult result = ask_for_portability(wish)) return result;
  }
  wish.info.enabledExtensionCount = static_cast<std::uint32_t>(wish.extensions.size());
  wish.info.ppEnabledExtensionNames = wish.extensions.data();
  wish.info.queueCreateInfoCount = static_cast<std::uint32_t>(wish.queues.size());
  wish.info.pQueueCreateInfos = wish.queues.data();
  const auto create =
      reinterpret_cast<PFN_vkCreateDevice>(get(instance_of(physical).handle, "vkCreateDevice"));
  const VkResult result = create(physical, &wish.info, allocator, device);
  if (result == VK_SUCCESS) {
    const std::lock_guard lock(mutex);
    devices[table_of(*device)] = {device_get, *device};
  }
  return result;
}

PFN_vkVoidFunction changed(const char* name) {
  if (mode() == "backwards") return backwards(name);
  if (mode() == "families") return families(name);
  if (mode() == "portable") return portable(name);
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_of_device(VkDevice device, const char* name) {
  if (!std::strcmp(name, "vkGetDeviceProcAddr")) return as_void(&get_of_device);
  const PFN_vkVoidFunction next = device_of(device).get(device, name);
  const PFN_vkVoidFunction ours = next ? changed(name) : nullptr;
  return ours ? ours : next;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_of_instance(VkInstance instance, const char* name) {
  const std::string_view wanted = name;
  if (wanted == "vkGetInstanceProcAddr") return as_void(&get_of_instance);
  if (wanted == "vkGetDeviceProcAddr") return as_void(&get_of_device);
  if (wanted == "vkCreateInstance") return as_void(&create_instance);
  if (wanted == "vkCreateDevice") return as_void(&create_device);
  if (const PFN_vkVoidFunction ours = changed(name)) return ours;
  return instance ? instance_of(instance).get(instance, name) : nullptr;
}

}  // namespace

const std::string& mode() {
  static const std::string named = [] {
    const char* value = std::getenv("SUNDER_TEST_LAYER");
    return std::string(value ? value : "");
  }();
  return named;
}

void blame(const std::string& what) {
  const char* log = std::getenv("SUNDER_TEST_LAYER_LOG");
  const std::string line = "other device: " + what + "\n";
  static_cast<void>(!write(log ? std::atoi(log) : 2, line.data(), line.size()));
}

void tell(const std::string& what) {
  const std::string line = "other device: " + what + "\n";
  static_cast<void>(!write(2, line.data(), line.size()));
}

InstanceNext instance_of(const void* handle) {
  const std::lock_guard lock(mutex);
  return instances.at(table_of(handle));
}

DeviceNext device_of(const void* handle) {
  const std::lock_guard lock(mutex);
  return devices.at(table_of(handle));
}

}  // namespace sunder::layer

extern "C" VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* interface) {
  if (interface->loaderLayerInterfaceVersion < 2) return VK_ERROR_INITIALIZATION_FAILED;
  interface->loaderLayerInterfaceVersion = 2;
  interface->pfnGetInstanceProcAddr = sunder::layer::get_of_instance;
  interface->pfnGetDeviceProcAddr = sunder::layer::get_of_device;
  interface->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
