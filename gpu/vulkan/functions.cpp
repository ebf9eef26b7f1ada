// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/functions.hpp"

#include <string>

#include "sunder/error.hpp"

namespace sunder::vulkan {
namespace {

template <class Function, class Get, class Handle>
void load(Function& function, Get get, Handle handle, const char* name) {
  function = reinterpret_cast<Function>(get(handle, name));
  if (!function) throw DeviceError(std::string("the Vulkan driver lacks the function ") + name);
}

}  // namespace

InstanceFunctions load_functions(PFN_vkGetInstanceProcAddr get, VkInstance instance) {
  InstanceFunctions vk;
#define SUNDER_VK_LOAD(name) load(vk.name, get, instance, "vk" #name);
  SUNDER_VK_INSTANCE_FUNCTIONS(SUNDER_VK_LOAD)
#undef SUNDER_VK_LOAD
  vk.CreateDebugUtilsMessengerEXT = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      get(instance, "vkCreateDebugUtilsMessengerEXT"));
  vk.DestroyDebugUtilsMessengerEXT = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
      get(instance, "vkDestroyDebugUtilsMessengerEXT"));
  return vk;
}

DeviceFunctions load_functions(PFN_vkGetDeviceProcAddr get, VkDevice device) {
  DeviceFunctions vk;
#define SUNDER_VK_LOAD(name) load(vk.name, get, device, "vk" #name);
  SUNDER_VK_DEVICE_FUNCTIONS(SUNDER_VK_LOAD)
#undef SUNDER_VK_LOAD
  return vk;
}

}  // namespace sunder::vulkan
