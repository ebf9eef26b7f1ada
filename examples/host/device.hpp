// SPDX-License-Identifier: Apache-2.0
// The host's Vulkan: instance, with validation where it is installed, device, one queue for drawing
// and computing.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <string>
#include <vector>

void check(VkResult result, const char* what);

struct Buffer {
  VkBuffer handle = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  void* mapped = nullptr;
};

class Device {
 public:
  /// `validation`: demands the validation layer; else it is used if it is there.
  explicit Device(bool validation);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Host-visible memory, filled with `data` if there is any.
  [[nodiscard]] Buffer buffer(VkDeviceSize bytes, VkBufferUsageFlags usage, const void* data);
  void destroy(const Buffer& buffer);
  [[nodiscard]] std::uint32_t memory_type(std::uint32_t allowed, VkMemoryPropertyFlags flags) const;

  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice handle = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
  bool validated = false;             ///< the validation layer watches
  VkBool32 float64 = VK_FALSE;        ///< shaderFloat64 was enabled
  VkBool32 int64 = VK_FALSE;          ///< shaderInt64 was enabled
  std::vector<std::string> messages;  ///< of the validation layers

 private:
  void create_instance(bool validation);
  void choose_physical();
  void create_device();

  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};
