// SPDX-License-Identifier: Apache-2.0
// The Vulkan instance: loader opened at run time, drivers found, validation on request.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gpu/vulkan/functions.hpp"
#include "machine/shared_library.hpp"

namespace sunder::vulkan {

/// What the validation layers said; shared with the callback.
struct Messages {
  std::vector<std::string> texts;
};

struct InstanceOptions {
  /// Validation and synchronization validation; a message becomes a DeviceError at the next submit.
  bool validation = false;
  std::shared_ptr<Messages> messages = std::make_shared<Messages>();
#if defined(_WIN32)
  const char* loader = "vulkan-1.dll";
#elif defined(__APPLE__)
  const char* loader = "libvulkan.1.dylib";
#else
  const char* loader = "libvulkan.so.1";
#endif
};

class Instance {
 public:
  /// Devices that lack what Vulkan asks for but not what is asked here (MoltenVK's) are there too.
  /// Throws DeviceError when there is no loader or no driver.
  explicit Instance(const InstanceOptions& options);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  [[nodiscard]] const InstanceFunctions& vk() const { return vk_; }
  [[nodiscard]] VkInstance handle() const { return handle_; }
  [[nodiscard]] std::vector<VkPhysicalDevice> physical_devices() const;
  [[nodiscard]] const std::shared_ptr<Messages>& messages() const { return messages_; }

 private:
  void open_loader(const char* name);
  void create(bool validation);
  [[nodiscard]] bool offers(const char* extension) const;

  machine::SharedLibrary library_;
  PFN_vkGetInstanceProcAddr get_ = nullptr;
  VkInstance handle_ = VK_NULL_HANDLE;
  InstanceFunctions vk_;
  std::shared_ptr<Messages> messages_;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace sunder::vulkan
