// SPDX-License-Identifier: Apache-2.0
#include "app/view/window/swapchain.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "sunder/error.hpp"

namespace sunder::app::view {
namespace {

constexpr auto kForever = std::numeric_limits<std::uint64_t>::max();
constexpr VkImageSubresourceRange kWhole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};

template <class Function>
void fetch(Function& function, PFN_vkVoidFunction found, const char* name) {
  function = reinterpret_cast<Function>(found);
  if (!function) throw DeviceError(std::string("the Vulkan driver lacks the function ") + name);
}

}  // namespace

Swapchain::Swapchain(Device& device, VkSurfaceKHR surface)
    : device_(device), surface_(surface), commands_(device) {
  const auto get = reinterpret_cast<PFN_vkGetDeviceProcAddr>(
      device.get()(device.instance(), "vkGetDeviceProcAddr"));
#define SUNDER_VIEW_FETCH(name) fetch(of_.name, get(device.handle(), "vk" #name), "vk" #name);
  SUNDER_VIEW_FETCH(CreateSwapchainKHR)
  SUNDER_VIEW_FETCH(DestroySwapchainKHR)
  SUNDER_VIEW_FETCH(GetSwapchainImagesKHR)
  SUNDER_VIEW_FETCH(AcquireNextImageKHR)
  SUNDER_VIEW_FETCH(QueuePresentKHR)
  SUNDER_VIEW_FETCH(CmdBlitImage)
  SUNDER_VIEW_FETCH(CreateSemaphore)
  SUNDER_VIEW_FETCH(DestroySemaphore)
#undef SUNDER_VIEW_FETCH
  fetch(of_.GetPhysicalDeviceSurfaceCapabilitiesKHR,
        device.get()(device.instance(), "vkGetPhysicalDeviceSurfaceCapabilitiesKHR"),
        "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  fetch(of_.GetPhysicalDeviceSurfaceFormatsKHR,
        device.get()(device.instance(), "vkGetPhysicalDeviceSurfaceFormatsKHR"),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::uint32_t count = 0;
  check(of_.GetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, &count, nullptr),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  check(of_.GetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, &count, formats.data()),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  // The picture's bytes are shown as they are: no format that would turn them into sRGB once more.
  const auto plain = std::ranges::find_if(formats, [](const VkSurfaceFormatKHR& f) {
    return f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM;
  });
  if (formats.empty()) throw DeviceError("the window offers no format of pixels");
  format_ = plain == formats.end() ? formats.front() : *plain;
  make_pass();
  make();
}

void Swapchain::make_pass() {
  VkAttachmentDescription colour{};
  colour.format = format_.format;
  colour.samples = VK_SAMPLE_COUNT_1_BIT;
  colour.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD;
  colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  colour.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  colour.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  colour.initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  colour.finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
  const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &reference;
  VkRenderPassCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
  info.attachmentCount = 1;
  info.pAttachments = &colour;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  const DeviceFunctions& vk = device_.vk();
  pass_ = view::make<VkRenderPass>(device_, vk.CreateRenderPass, info, vk.DestroyRenderPass,
                                   "vkCreateRenderPass");
}

void Swapchain::make() {
  const DeviceFunctions& vk = device_.vk();
  device_.wait_idle();
  frames_.clear();
  VkSurfaceCapabilitiesKHR can{};
  check(of_.GetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &can),
        "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  extent_ = can.currentExtent;
  if (extent_.width == 0 || extent_.height == 0) return;  // hidden
  VkSwapchainCreateInfoKHR info{};
  info.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR;
  info.surface = surface_;
  info.minImageCount = std::max(2U, can.minImageCount);
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = extent_;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
  info.preTransform = can.currentTransform;
  info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
  info.clipped = VK_TRUE;
  info.oldSwapchain = chain_.get();
  chain_ = view::make<VkSwapchainKHR>(device_, of_.CreateSwapchainKHR, info,
                                      of_.DestroySwapchainKHR, "vkCreateSwapchainKHR");
  std::uint32_t count = 0;
  check(of_.GetSwapchainImagesKHR(device_.handle(), chain_.get(), &count, nullptr),
        "vkGetSwapchainImagesKHR");
  std::vector<VkImage> images(count);
  check(of_.GetSwapchainImagesKHR(device_.handle(), chain_.get(), &count, images.data()),
        "vkGetSwapchainImagesKHR");
  VkSemaphoreCreateInfo semaphore{};
  semaphore.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
  const auto make_semaphore = [&] {
    return view::make<VkSemaphore>(device_, of_.CreateSemaphore, semaphore, of_.DestroySemaphore,
                                   "vkCreateSemaphore");
  };
  acquired_ = make_semaphore();
  drawn_.clear();
  for (const VkImage image : images) {
    drawn_.push_back(make_semaphore());
    Frame frame;
    frame.image = image;
    VkImageViewCreateInfo of_view{};
    of_view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    of_view.image = image;
    of_view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    of_view.format = format_.format;
    of_view.subresourceRange = kWhole;
    frame.view = view::make<VkImageView>(device_, vk.CreateImageView, of_view, vk.DestroyImageView,
                                         "vkCreateImageView");
    VkFramebufferCreateInfo framebuffer{};
    framebuffer.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
    framebuffer.renderPass = pass_.get();
    framebuffer.attachmentCount = 1;
    framebuffer.pAttachments = frame.view.address();
    framebuffer.width = extent_.width;
    framebuffer.height = extent_.height;
    framebuffer.layers = 1;
    frame.framebuffer = view::make<VkFramebuffer>(device_, vk.CreateFramebuffer, framebuffer,
                                                  vk.DestroyFramebuffer, "vkCreateFramebuffer");
    frames_.push_back(std::move(frame));
  }
}

void Swapchain::barrier(VkCommandBuffer commands, VkImage image, VkImageLayout from,
                        VkImageLayout to, VkAccessFlags done, VkAccessFlags next,
                        VkPipelineStageFlags after, VkPipelineStageFlags before) {
  VkImageMemoryBarrier b{};
  b.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
  b.srcAccessMask = done;
  b.dstAccessMask = next;
  b.oldLayout = from;
  b.newLayout = to;
  b.srcQueueFamilyIndex = b.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  b.image = image;
  b.subresourceRange = kWhole;
  device_.vk().CmdPipelineBarrier(commands, after, before, 0, 0, nullptr, 0, nullptr, 1, &b);
}

void Swapchain::once(const std::function<void(VkCommandBuffer)>& record) {
  record(commands_.begin());
  commands_.run();
}

void Swapchain::show(VkImage picture, VkExtent2D size,
                     const std::function<void(VkCommandBuffer)>& over) {
  if (frames_.empty()) {
    make();
    if (frames_.empty()) return;
  }
  std::uint32_t index = 0;
  const VkResult got = of_.AcquireNextImageKHR(device_.handle(), chain_.get(), kForever,
                                               acquired_.get(), VK_NULL_HANDLE, &index);
  if (got == VK_ERROR_OUT_OF_DATE_KHR) {
    make();
    return;
  }
  if (got != VK_SUBOPTIMAL_KHR) check(got, "vkAcquireNextImageKHR");
  const DeviceFunctions& vk = device_.vk();
  Frame& frame = frames_[index];
  const VkCommandBuffer commands = commands_.begin();
  barrier(commands, frame.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0,
          VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
          VK_PIPELINE_STAGE_TRANSFER_BIT);
  VkImageBlit blit{};
  blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  blit.srcOffsets[1] = {static_cast<std::int32_t>(size.width),
                        static_cast<std::int32_t>(size.height), 1};
  blit.dstOffsets[1] = {static_cast<std::int32_t>(extent_.width),
                        static_cast<std::int32_t>(extent_.height), 1};
  of_.CmdBlitImage(commands, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, frame.image,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
  barrier(commands, frame.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
          VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_ACCESS_TRANSFER_WRITE_BIT,
          VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
          VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT);
  VkRenderPassBeginInfo pass{};
  pass.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO;
  pass.renderPass = pass_.get();
  pass.framebuffer = frame.framebuffer.get();
  pass.renderArea = {{0, 0}, extent_};
  vk.CmdBeginRenderPass(commands, &pass, VK_SUBPASS_CONTENTS_INLINE);
  over(commands);
  vk.CmdEndRenderPass(commands);
  commands_.run(acquired_.get(), drawn_[index].get());
  VkPresentInfoKHR present{};
  present.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR;
  present.waitSemaphoreCount = 1;
  present.pWaitSemaphores = drawn_[index].address();
  present.swapchainCount = 1;
  present.pSwapchains = chain_.address();
  present.pImageIndices = &index;
  const VkResult shown = device_.present(of_.QueuePresentKHR, present);
  if (shown == VK_ERROR_OUT_OF_DATE_KHR || shown == VK_SUBOPTIMAL_KHR) {
    make();
  } else {
    check(shown, "vkQueuePresentKHR");
  }
}

}  // namespace sunder::app::view
