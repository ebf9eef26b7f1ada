// SPDX-License-Identifier: Apache-2.0
// The driver's pipeline cache, begun with bytes that a host has kept and read out for it to keep.
// Drivers need not survive bytes that are cut or changed, so that they are wrapped: a word of ours,
// their number and a checksum; and they are checked against Vulkan's own header of them.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/vulkan/physical_device.hpp"

namespace sunder::vulkan {

class KernelCache {
 public:
  /// `vk` must outlive it. What was given and does not fit is ignored.
  KernelCache(const DeviceFunctions& vk, VkDevice device, const PhysicalDevice& physical,
              std::span<const std::byte> given);
  ~KernelCache();
  KernelCache(const KernelCache&) = delete;
  KernelCache& operator=(const KernelCache&) = delete;

  [[nodiscard]] VkPipelineCache handle() const { return handle_; }
  /// Why what was given is ignored; empty: it is not, or nothing was given.
  [[nodiscard]] const std::string& ignored() const { return ignored_; }
  /// To be given to the next one; empty where the driver has none to give.
  [[nodiscard]] std::vector<std::byte> bytes() const;

 private:
  const DeviceFunctions& vk_;
  VkDevice device_;
  VkPipelineCache handle_ = VK_NULL_HANDLE;
  std::string ignored_;
};

/// Why such bytes are not for this device; empty: they are. They are whole, and begin with
/// Vulkan's header (VkPipelineCacheHeaderVersionOne) of its driver.
[[nodiscard]] std::string why_not(std::span<const std::byte> wrapped,
                                  const PhysicalDevice& physical);

/// A driver's bytes as a host keeps them.
[[nodiscard]] std::vector<std::byte> wrap(std::span<const std::byte> of_driver);

}  // namespace sunder::vulkan
