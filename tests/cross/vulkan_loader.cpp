// SPDX-License-Identifier: Apache-2.0
// A Vulkan loader of the tests, which a program finds by the name that loaders have on its system.
// As a loader that knows of MoltenVK does, it hides its one device, a portable subset of
// Vulkan 1.1, from who does not ask for such devices.
#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <cstring>

namespace {

struct Instance {
  bool portable = false;
};

VkResult VKAPI_CALL enumerate_instance_extensions(const char*, std::uint32_t* count,
                                                  VkExtensionProperties* list) {
  if (list && *count > 0) {
    list[0] = {VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME,
               VK_KHR_PORTABILITY_ENUMERATION_SPEC_VERSION};
  }
  *count = 1;
  return VK_SUCCESS;
}

VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks*,
                                    VkInstance* instance) {
  bool enabled = false;
  for (std::uint32_t e = 0; e < info->enabledExtensionCount; ++e) {
    enabled = enabled || std::strcmp(info->ppEnabledExtensionNames[e],
                                     VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME) == 0;
  }
  const bool asked = (info->flags & VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR) != 0;
  *instance = reinterpret_cast<VkInstance>(new Instance{enabled && asked});
  return VK_SUCCESS;
}

void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks*) {
  delete reinterpret_cast<Instance*>(instance);
}

VkResult VKAPI_CALL enumerate_devices(VkInstance instance, std::uint32_t* count,
                                      VkPhysicalDevice* devices) {
  if (!reinterpret_cast<Instance*>(instance)->portable) {
    *count = 0;
    return VK_SUCCESS;
  }
  if (devices && *count > 0) devices[0] = reinterpret_cast<VkPhysicalDevice>(instance);
  *count = 1;
  return VK_SUCCESS;
}

VkResult VKAPI_CALL enumerate_device_extensions(VkPhysicalDevice, const char*, std::uint32_t* count,
                                                VkExtensionProperties*) {
  *count = 0;
  return VK_SUCCESS;
}

void VKAPI_CALL get_properties(VkPhysicalDevice, VkPhysicalDeviceProperties2* properties) {
  properties->properties = {};
  properties->properties.apiVersion = VK_API_VERSION_1_1;
  std::strcpy(properties->properties.deviceName, "a loader's of the tests");
}

void VKAPI_CALL get_features(VkPhysicalDevice, VkPhysicalDeviceFeatures2* features) {
  features->features = {};
}

void VKAPI_CALL get_memory(VkPhysicalDevice, VkPhysicalDeviceMemoryProperties* memory) {
  *memory = {};
}

void VKAPI_CALL get_queue_families(VkPhysicalDevice, std::uint32_t* count,
                                   VkQueueFamilyProperties*) {
  *count = 0;
}

void VKAPI_CALL never() {}  // no device is created

struct Function {
  const char* name;
  PFN_vkVoidFunction function;
};

template <class F>
PFN_vkVoidFunction any(F* function) {
  return reinterpret_cast<PFN_vkVoidFunction>(function);
}

const Function kFunctions[] = {
    {"vkEnumerateInstanceExtensionProperties", any(enumerate_instance_extensions)},
    {"vkCreateInstance", any(create_instance)},
    {"vkDestroyInstance", any(destroy_instance)},
    {"vkEnumeratePhysicalDevices", any(enumerate_devices)},
    {"vkEnumerateDeviceExtensionProperties", any(enumerate_device_extensions)},
    {"vkGetPhysicalDeviceProperties2", any(get_properties)},
    {"vkGetPhysicalDeviceFeatures2", any(get_features)},
    {"vkGetPhysicalDeviceMemoryProperties", any(get_memory)},
    {"vkGetPhysicalDeviceQueueFamilyProperties", any(get_queue_families)},
    {"vkCreateDevice", any(never)},
    {"vkGetDeviceProcAddr", any(never)},
};

}  // namespace

extern "C" __declspec(dllexport) PFN_vkVoidFunction VKAPI_CALL
    vkGetInstanceProcAddr(VkInstance, const char* name) {
  for (const Function& f : kFunctions) {
    if (std::strcmp(f.name, name) == 0) return f.function;
  }
  return nullptr;
}
