// SPDX-License-Identifier: Apache-2.0
// A host with a Vulkan device of its own, which watches what the library does with it: validation
// and synchronization validation, and a count of calls that the library makes.
#pragma once

#include <gtest/gtest.h>
#include <vulkan/vulkan.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "sunder/sunder_vulkan.h"

namespace sunder::test {

/// Calls that the library makes on the lent device.
struct Calls {
  int submits = 0, copies = 0, dispatches = 0, device_waits = 0;
  int locks = 0, depth = 0;
  bool nested = false, submitted_unlocked = false;
};

class VulkanHost {
 public:
  struct Options {
    bool float64 = true, int64 = true, timeline = true;
  };
  explicit VulkanHost(const Options& options);
  VulkanHost() : VulkanHost(Options{}) {}
  /// Fails the test for every validation message, objects that were left behind included.
  ~VulkanHost();
  VulkanHost(const VulkanHost&) = delete;
  VulkanHost& operator=(const VulkanHost&) = delete;

  /// What sunder_vulkan_create is given.
  [[nodiscard]] sunder_vulkan_host lend() const;

  struct Memory {
    VkBuffer buffer{};
    VkDeviceMemory memory{};
    void* mapped{};
    VkDeviceSize size{};
  };
  /// Filled with 0xa5.
  [[nodiscard]] Memory allocate(VkDeviceSize size, VkBufferUsageFlags usage) const;
  void free(const Memory& memory) const;

  /// Records and runs body(commands) in a submit of the host's own.
  template <class Body>
  void run(Body&& body) const {
    const VkCommandBuffer commands = begin();
    body(commands);
    finish(commands);
  }
  /// Bytes of any buffer with TRANSFER_SRC.
  [[nodiscard]] std::vector<std::byte> read(const sunder_vulkan_buffer& part) const;

  [[nodiscard]] VkSemaphore timeline() const;

  VkInstance instance{};
  VkPhysicalDevice physical{};
  VkDevice device{};
  VkQueue queue{};
  std::uint32_t family = 0;
  std::vector<std::string> messages;
  static Calls calls;

 private:
  void create_instance();
  void choose_family();
  void create_device();
  [[nodiscard]] VkCommandBuffer begin() const;
  void finish(VkCommandBuffer commands) const;

  Options options_;
  VkDebugUtilsMessengerEXT messenger_{};
  VkCommandPool pool_{};
  mutable std::vector<VkSemaphore> semaphores_;
};

}  // namespace sunder::test
