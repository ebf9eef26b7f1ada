// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/instance.hpp"

#include <algorithm>
#include <string_view>
#include <type_traits>

#include "gpu/vulkan/check.hpp"

namespace sunder::vulkan {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL take_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                            VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data,
                                            void* user) {
  static_cast<Messages*>(user)->texts.emplace_back(data->pMessage);
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(Messages* messages) {
  VkDebugUtilsMessengerCreateInfoEXT info{};
  info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                         VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  // Not "general": the loader reports drivers that do not fit this machine there.
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                     VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = take_message;
  info.pUserData = messages;
  return info;
}

}  // namespace

Instance::Instance(const InstanceOptions& options) : messages_(options.messages) {
  open_loader(options.loader);
  create(options.validation);
  vk_ = load_functions(get_, handle_);
  if (options.validation) {
    const auto info = messenger_info(messages_.get());
    check(vk_.CreateDebugUtilsMessengerEXT(handle_, &info, nullptr, &messenger_),
          "vkCreateDebugUtilsMessengerEXT");
  }
}

Instance::~Instance() {
  if (messenger_) vk_.DestroyDebugUtilsMessengerEXT(handle_, messenger_, nullptr);
  vk_.DestroyInstance(handle_, nullptr);
}

void Instance::open_loader(const char* name) {
  library_ = machine::SharedLibrary(name);
  get_ =
      library_.function<std::remove_pointer_t<PFN_vkGetInstanceProcAddr>>("vkGetInstanceProcAddr");
  if (!get_) {
    throw DeviceError(std::string("no Vulkan loader was found (") + name +
                      "); install libvulkan1 or use backend cpu");
  }
}

void Instance::create(bool validation) {
  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.pApplicationName = "sunder";
  application.apiVersion = VK_API_VERSION_1_2;
  const VkValidationFeatureEnableEXT enables[] = {
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{};
  features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enables;
  const auto messenger = messenger_info(messages_.get());
  features.pNext = &messenger;
  std::vector<const char*> extensions;
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;
  if (validation) {
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }
  if (offers(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME)) {
    extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    info.flags = VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const auto create_instance =
      reinterpret_cast<PFN_vkCreateInstance>(get_(nullptr, "vkCreateInstance"));
  check(create_instance(&info, nullptr, &handle_), "vkCreateInstance");
}

bool Instance::offers(const char* extension) const {
  const auto enumerate = reinterpret_cast<PFN_vkEnumerateInstanceExtensionProperties>(
      get_(nullptr, "vkEnumerateInstanceExtensionProperties"));
  std::uint32_t count = 0;
  if (!enumerate || enumerate(nullptr, &count, nullptr) != VK_SUCCESS) return false;
  std::vector<VkExtensionProperties> list(count);
  if (enumerate(nullptr, &count, list.data()) != VK_SUCCESS) return false;
  return std::ranges::any_of(list, [&](const VkExtensionProperties& offered) {
    return std::string_view(extension) == offered.extensionName;
  });
}

std::vector<VkPhysicalDevice> Instance::physical_devices() const {
  std::uint32_t count = 0;
  const VkResult result = vk_.EnumeratePhysicalDevices(handle_, &count, nullptr);
  if (result == VK_ERROR_INITIALIZATION_FAILED) return {};  // drivers without a device
  check(result, "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vk_.EnumeratePhysicalDevices(handle_, &count, devices.data()),
        "vkEnumeratePhysicalDevices");
  devices.resize(count);
  return devices;
}

}  // namespace sunder::vulkan
