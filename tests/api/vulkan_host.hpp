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
    bool draws_elsewhere = false;  ///< on a queue of another family than the one that it lends
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
  /// Filled with 0xa5. `shared`: by the lent queue's family and the one that draws.
  [[nodiscard]] Memory allocate(VkDeviceSize size, VkBufferUsageFlags usage,
                                bool shared = false) const;
  void free(const Memory& memory) const;

  /// Records and runs body(commands) in a submit of the host's own, on the lent queue.
  template <class Body>
  void run(Body&& body) const {
    run(lent_, body);
  }
  /// The same on the queue that draws.
  template <class Body>
  void draw(Body&& body) const {
    run(options_.draws_elsewhere ? drawing_ : lent_, body);
  }
  /// Bytes of any buffer with TRANSFER_SRC, read by the queue that draws.
  [[nodiscard]] std::vector<std::byte> read(const sunder_vulkan_buffer& part) const;

  [[nodiscard]] VkSemaphore timeline() const;

  VkInstance instance{};
  VkPhysicalDevice physical{};
  VkDevice device{};
  VkQueue queue{};
  std::uint32_t family = 0, drawing_family = 0;
  std::vector<std::string> messages;
  static Calls calls;

 private:
  void create_instance();
  void choose_family();
  void create_device();
  struct Side {
    VkQueue queue{};
    VkCommandPool pool{};
  };
  [[nodiscard]] Side side(std::uint32_t of) const;
  template <class Body>
  void run(const Side& side, Body&& body) const {
    const VkCommandBuffer commands = begin(side);
    body(commands);
    finish(side, commands);
  }
  [[nodiscard]] VkCommandBuffer begin(const Side& side) const;
  void finish(const Side& side, VkCommandBuffer commands) const;

  Options options_;
  VkDebugUtilsMessengerEXT messenger_{};
  Side lent_, drawing_;
  mutable std::vector<VkSemaphore> semaphores_;
};

}  // namespace sunder::test
