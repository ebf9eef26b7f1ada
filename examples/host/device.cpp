// SPDX-License-Identifier: Apache-2.0
#include "device.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace {

VKAPI_ATTR VkBool32 VKAPI_CALL take_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                            VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data,
                                            void* user) {
  static_cast<std::vector<std::string>*>(user)->emplace_back(data->pMessage);
  return VK_FALSE;
}

constexpr const char* kValidation = "VK_LAYER_KHRONOS_validation";

bool is_installed(const char* layer) {
  std::uint32_t count = 0;
  check(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  check(vkEnumerateInstanceLayerProperties(&count, layers.data()),
        "vkEnumerateInstanceLayerProperties");
  return std::any_of(layers.begin(), layers.end(), [&](const VkLayerProperties& l) {
    return std::strcmp(l.layerName, layer) == 0;
  });
}

template <class Function>
Function extension(VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

}  // namespace

void check(VkResult result, const char* what) {
  if (result != VK_SUCCESS) {
    throw std::runtime_error(std::string(what) + " failed: " + std::to_string(result));
  }
}

Device::Device(bool validation) {
  create_instance(validation);
  choose_physical();
  create_device();
}

Device::~Device() {
  vkDestroyDevice(handle, nullptr);
  if (messenger_) {
    extension<PFN_vkDestroyDebugUtilsMessengerEXT>(instance, "vkDestroyDebugUtilsMessengerEXT")(
        instance, messenger_, nullptr);
  }
  vkDestroyInstance(instance, nullptr);
}

void Device::create_instance(bool validation) {
  validated = is_installed(kValidation);
  if (validation && !validated) {
    throw std::runtime_error(std::string("--validation: the layer ") + kValidation +
                             " is not installed (Debian: vulkan-validationlayers)");
  }
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.apiVersion = VK_API_VERSION_1_2;
  const VkValidationFeatureEnableEXT enable =
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &enable;
  VkDebugUtilsMessengerCreateInfoEXT debug{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  debug.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                          VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  debug.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  debug.pfnUserCallback = take_message;
  debug.pUserData = &messages;
  features.pNext = &debug;
  const char* name = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  if (validated) {  // the layer has both extensions
    info.pNext = &features;
    info.enabledLayerCount = info.enabledExtensionCount = 1;
    info.ppEnabledLayerNames = &kValidation;
    info.ppEnabledExtensionNames = &name;
  }
  check(vkCreateInstance(&info, nullptr, &instance), "vkCreateInstance");
  if (!validated) return;
  check(extension<PFN_vkCreateDebugUtilsMessengerEXT>(instance, "vkCreateDebugUtilsMessengerEXT")(
            instance, &debug, nullptr, &messenger_),
        "vkCreateDebugUtilsMessengerEXT");
}

void Device::choose_physical() {
  std::uint32_t count = 1;  // the first is good enough for an example
  const VkResult found = vkEnumeratePhysicalDevices(instance, &count, &physical);
  if (found < 0 || count == 0) throw std::runtime_error("there is no Vulkan device");
  std::uint32_t families = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &families, nullptr);
  std::vector<VkQueueFamilyProperties> properties(families);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &families, properties.data());
  constexpr VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  while (family < families && (properties[family].queueFlags & both) != both) ++family;
  if (family == families) throw std::runtime_error("no queue draws and computes");
}

void Device::create_device() {
  VkPhysicalDeviceFeatures offered{};
  vkGetPhysicalDeviceFeatures(physical, &offered);
  float64 = offered.shaderFloat64;
  int64 = offered.shaderInt64;
  VkPhysicalDeviceFeatures features{};
  features.shaderFloat64 = float64;  // Sunder uses both where they are there
  features.shaderInt64 = int64;
  const float priority = 1;
  VkDeviceQueueCreateInfo queues{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queues.queueFamilyIndex = family;
  queues.queueCount = 1;
  queues.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queues;
  info.pEnabledFeatures = &features;
  check(vkCreateDevice(physical, &info, nullptr, &handle), "vkCreateDevice");
  vkGetDeviceQueue(handle, family, 0, &queue);
}

std::uint32_t Device::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags flags) const {
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  for (std::uint32_t t = 0; t < memory.memoryTypeCount; ++t) {
    if ((allowed >> t & 1) && (memory.memoryTypes[t].propertyFlags & flags) == flags) return t;
  }
  throw std::runtime_error("no memory of the kind that is needed");
}

Buffer Device::buffer(VkDeviceSize bytes, VkBufferUsageFlags usage, const void* data) {
  Buffer result;
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = bytes;
  info.usage = usage;
  check(vkCreateBuffer(handle, &info, nullptr, &result.handle), "vkCreateBuffer");
  VkMemoryRequirements needed{};
  vkGetBufferMemoryRequirements(handle, result.handle, &needed);
  VkMemoryAllocateInfo memory{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  memory.allocationSize = needed.size;
  memory.memoryTypeIndex =
      memory_type(needed.memoryTypeBits,
                  VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  check(vkAllocateMemory(handle, &memory, nullptr, &result.memory), "vkAllocateMemory");
  check(vkBindBufferMemory(handle, result.handle, result.memory, 0), "vkBindBufferMemory");
  check(vkMapMemory(handle, result.memory, 0, VK_WHOLE_SIZE, 0, &result.mapped), "vkMapMemory");
  if (data) std::memcpy(result.mapped, data, bytes);
  return result;
}

void Device::destroy(const Buffer& buffer) {
  vkDestroyBuffer(handle, buffer.handle, nullptr);
  vkFreeMemory(handle, buffer.memory, nullptr);
}
