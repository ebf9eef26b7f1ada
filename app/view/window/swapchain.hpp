// SPDX-License-Identifier: Apache-2.0
// The images of a window: a picture is copied into one, then whatever is drawn over it.
#pragma once

#include <functional>
#include <vector>

#include "app/view/vulkan/commands.hpp"

namespace sunder::app::view {

/// Device functions that windows take besides.
struct SwapchainFunctions {
  PFN_vkCreateSwapchainKHR CreateSwapchainKHR = nullptr;
  PFN_vkDestroySwapchainKHR DestroySwapchainKHR = nullptr;
  PFN_vkGetSwapchainImagesKHR GetSwapchainImagesKHR = nullptr;
  PFN_vkAcquireNextImageKHR AcquireNextImageKHR = nullptr;
  PFN_vkQueuePresentKHR QueuePresentKHR = nullptr;
  PFN_vkCmdBlitImage CmdBlitImage = nullptr;
  PFN_vkCreateSemaphore CreateSemaphore = nullptr;
  PFN_vkDestroySemaphore DestroySemaphore = nullptr;
  PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR GetPhysicalDeviceSurfaceCapabilitiesKHR = nullptr;
  PFN_vkGetPhysicalDeviceSurfaceFormatsKHR GetPhysicalDeviceSurfaceFormatsKHR = nullptr;
};

class Swapchain {
 public:
  /// Both must outlive it.
  Swapchain(Device& device, VkSurfaceKHR surface);

  /// The pass in which `over` records: one colour attachment, what was copied stays.
  [[nodiscard]] VkRenderPass pass() const { return pass_.get(); }
  [[nodiscard]] std::uint32_t image_count() const {
    return static_cast<std::uint32_t>(frames_.size());
  }
  /// Shows a picture of that size, in layout TRANSFER_SRC_OPTIMAL, stretched over the window, and
  /// what `over` records on top. Of a window that has changed its size nothing is shown once.
  void show(VkImage picture, VkExtent2D size, const std::function<void(VkCommandBuffer)>& over);
  /// Has `record` record, and waits until it is done.
  void once(const std::function<void(VkCommandBuffer)>& record);

 private:
  struct Frame {
    VkImage image = VK_NULL_HANDLE;
    Owned<VkImageView> view;
    Owned<VkFramebuffer> framebuffer;
  };
  void make_pass();
  void make();
  void barrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
               VkAccessFlags done, VkAccessFlags next, VkPipelineStageFlags after,
               VkPipelineStageFlags before);

  Device& device_;
  VkSurfaceKHR surface_;
  SwapchainFunctions of_;
  VkSurfaceFormatKHR format_{};
  VkExtent2D extent_{};
  Owned<VkRenderPass> pass_;
  Owned<VkSwapchainKHR> chain_;
  std::vector<Frame> frames_;
  Owned<VkSemaphore> acquired_;
  std::vector<Owned<VkSemaphore>> drawn_;  // by image
  Commands commands_;
};

}  // namespace sunder::app::view
