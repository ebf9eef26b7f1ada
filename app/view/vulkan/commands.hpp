// SPDX-License-Identifier: Apache-2.0
// Commands that are recorded, submitted and waited for, one set after the other.
#pragma once

#include "app/view/vulkan/device.hpp"

namespace sunder::app::view {

class Commands {
 public:
  /// The device must outlive it. Throws DeviceError, as all of it does.
  explicit Commands(Device& device);

  /// Begins anew; what was recorded is forgotten.
  VkCommandBuffer begin();
  /// Submits what was recorded since and returns when it is done. Transfers wait for `after`;
  /// `done` is signalled at the end.
  void run(VkSemaphore after = VK_NULL_HANDLE, VkSemaphore done = VK_NULL_HANDLE);

 private:
  Device& device_;
  Owned<VkCommandPool> pool_;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;
  Owned<VkFence> fence_;
};

}  // namespace sunder::app::view
