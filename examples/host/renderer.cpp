// SPDX-License-Identifier: Apache-2.0
#include "renderer.hpp"

#include <cmath>

#include "picture.hpp"

namespace {

constexpr std::uint32_t kVertex =
    32;  // bytes of a node of the surface: place and normal, vec4 each

constexpr VkClearColorValue kBackground{{1, 1, 1, 1}};

/// Parallel projection of the board, turned a little so that its thickness is seen [mm -> clip].
std::array<float, 16> view() {
  const float scale = 1.0f / 41, c = std::cos(0.25f), s = std::sin(0.25f);
  const float aspect = static_cast<float>(Renderer::kPanel) / Renderer::kHeight;
  // x' = c x + s z, y' = -y (down), z' = -s x + c z; middle of the picture at (22, 14).
  return {c * scale,
          0,
          -s / 200,
          0,
          0,
          -scale * aspect,
          0,
          0,
          s * scale,
          0,
          -c / 200,
          0,
          -22 * c * scale,
          14 * scale * aspect,
          0.5f + 22 * s / 200,
          1};
}

std::vector<float> padded(const std::vector<double>& nodes) {
  std::vector<float> result;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    result.push_back(static_cast<float>(nodes[n]));
    if (n % 3 == 2) result.push_back(0);
  }
  return result;
}

}  // namespace

Renderer::Renderer(Device& device, const Board& board, const sunder_vulkan_display& display,
                   std::uint32_t panels, bool surface)
    : device_(device),
      width_(panels * kPanel),
      vertices_(static_cast<std::uint32_t>(12 * board.tet_count())),
      pulled_node_(static_cast<std::uint32_t>(board.pulled_node)),
      surface_(surface),
      nodes_(static_cast<std::uint32_t>(board.nodes.size() / 3)),
      most_triangles_(static_cast<std::uint32_t>(2 * board.tet_count())) {
  const auto rest = padded(board.nodes);
  rest_ =
      device.buffer(rest.size() * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, rest.data());
  tets_ = device.buffer(board.tets.size() * sizeof(std::int32_t),
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, board.tets.data());
  pixels_ =
      device.buffer(VkDeviceSize{4} * width_ * kHeight, VK_BUFFER_USAGE_TRANSFER_DST_BIT, nullptr);
  vertices_of_surface_ =
      device.buffer(VkDeviceSize{kVertex} * nodes_, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, nullptr);
  for (Buffer* of_triangles : {&triangles_, &facts_}) {
    *of_triangles = device.buffer(VkDeviceSize{12} * most_triangles_,
                                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, nullptr);
  }
  create_image(kColour,
               VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                   VK_IMAGE_USAGE_TRANSFER_DST_BIT,
               VK_IMAGE_ASPECT_COLOR_BIT, colour_, colour_memory_, colour_view_);
  create_image(kDepth, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT,
               depth_, depth_memory_, depth_view_);
  create_pass();
  create_descriptors(display);
  create_pipelines();
  create_commands();
  clear_picture();
}

Renderer::~Renderer() {
  const VkDevice d = device_.handle;
  vkDestroyFence(d, done_, nullptr);
  vkDestroyCommandPool(d, command_pool_, nullptr);
  vkDestroyPipeline(d, body_, nullptr);
  vkDestroyPipeline(d, mark_, nullptr);
  vkDestroyPipelineLayout(d, layout_, nullptr);
  vkDestroyDescriptorPool(d, pool_, nullptr);
  vkDestroyDescriptorSetLayout(d, set_layout_, nullptr);
  vkDestroyFramebuffer(d, frame_, nullptr);
  vkDestroyRenderPass(d, pass_, nullptr);
  for (VkImageView view : {colour_view_, depth_view_}) vkDestroyImageView(d, view, nullptr);
  for (VkImage image : {colour_, depth_}) vkDestroyImage(d, image, nullptr);
  for (VkDeviceMemory memory : {colour_memory_, depth_memory_}) vkFreeMemory(d, memory, nullptr);
  for (const Buffer& buffer : {rest_, tets_, pixels_, vertices_of_surface_, triangles_, facts_}) {
    device_.destroy(buffer);
  }
}

void Renderer::create_commands() {
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = device_.family;
  check(vkCreateCommandPool(device_.handle, &pool, nullptr, &command_pool_), "vkCreateCommandPool");
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = command_pool_;
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device_.handle, &info, &commands_), "vkAllocateCommandBuffers");
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateFence(device_.handle, &fence, nullptr, &done_), "vkCreateFence");
}

void Renderer::begin() {
  const VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  check(vkBeginCommandBuffer(commands_, &info), "vkBeginCommandBuffer");
}

void Renderer::submit() {
  check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands_;
  check(vkQueueSubmit(device_.queue, 1, &info, done_), "vkQueueSubmit");
  check(vkWaitForFences(device_.handle, 1, &done_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  check(vkResetFences(device_.handle, 1, &done_), "vkResetFences");
}

void Renderer::clear_picture() {
  begin();
  VkImageMemoryBarrier to{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  to.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  to.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  to.image = colour_;
  to.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  to.srcQueueFamilyIndex = to.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                       0, 0, nullptr, 0, nullptr, 1, &to);
  vkCmdClearColorImage(commands_, colour_, to.newLayout, &kBackground, 1, &to.subresourceRange);
  to.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  to.dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  to.oldLayout = to.newLayout;
  to.newLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT,
                       VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, 0, 0, nullptr, 0, nullptr, 1,
                       &to);
  submit();
}

void Renderer::lend(sunder_simulation simulation) {
  const auto items = [](const Buffer& buffer, std::uint64_t offset, std::uint64_t size,
                        std::uint32_t stride) {
    return sunder_vulkan_items{reinterpret_cast<std::uint64_t>(buffer.handle), offset,
                               size - offset, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, stride};
  };
  sunder_vulkan_surface surface = SUNDER_VULKAN_SURFACE_INIT;
  const std::uint64_t vertices = std::uint64_t{kVertex} * nodes_;
  surface.places = items(vertices_of_surface_, 0, vertices, kVertex);
  surface.normals = items(vertices_of_surface_, kVertex / 2, vertices, kVertex);
  surface.triangles = items(triangles_, 0, std::uint64_t{12} * most_triangles_, 0);
  surface.facts = items(facts_, 0, std::uint64_t{12} * most_triangles_, 0);
  check(sunder_vulkan_lend_surface(simulation, nullptr, &surface));
}

void Renderer::record_surface(sunder_simulation simulation) {
  sunder_surface surface = SUNDER_SURFACE_INIT;
  check(sunder_vulkan_record_surface(simulation, commands_, &surface));
  drawn_ = static_cast<std::uint32_t>(surface.triangle_count);
}

void Renderer::frame(sunder_simulation simulation, std::uint32_t panel) {
  begin();
  check(sunder_vulkan_record(simulation, commands_));
  if (surface_) record_surface(simulation);
  VkClearValue depth{};
  depth.depthStencil.depth = 1;
  const VkClearValue clear[] = {{}, depth};
  VkRenderPassBeginInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
  info.renderPass = pass_;
  info.framebuffer = frame_;
  info.renderArea.extent = {width_, kHeight};
  info.clearValueCount = 2;
  info.pClearValues = clear;
  vkCmdBeginRenderPass(commands_, &info, VK_SUBPASS_CONTENTS_INLINE);
  draw(panel);
  vkCmdEndRenderPass(commands_);
  submit();
}

void Renderer::draw(std::uint32_t panel) {
  const VkRect2D area{{static_cast<std::int32_t>(panel * kPanel), 0}, {kPanel, kHeight}};
  const VkViewport viewport{static_cast<float>(panel * kPanel), 0, kPanel, kHeight, 0, 1};
  vkCmdSetViewport(commands_, 0, 1, &viewport);
  vkCmdSetScissor(commands_, 0, 1, &area);
  VkClearAttachment clear{};
  clear.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
  clear.clearValue.color = kBackground;
  const VkClearRect rect{area, 0, 1};
  vkCmdClearAttachments(commands_, 1, &clear, 1, &rect);
  vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &set_, 0,
                          nullptr);
  const Push push{view(), {0, -9, 0, 0}, pulled_node_};
  vkCmdPushConstants(commands_, layout_, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof push, &push);
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, body_);
  vkCmdDraw(commands_, surface_ ? 3 * drawn_ : vertices_, 1, 0, 0);
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, mark_);
  vkCmdDraw(commands_, 9, 1, 0, 0);
}

void Renderer::save(const std::string& path) {
  begin();
  VkImageMemoryBarrier to{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  to.srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  to.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
  to.oldLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  to.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  to.image = colour_;
  to.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  to.srcQueueFamilyIndex = to.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                       VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1, &to);
  VkBufferImageCopy whole{};
  whole.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  whole.imageExtent = {width_, kHeight, 1};
  vkCmdCopyImageToBuffer(commands_, colour_, to.newLayout, pixels_.handle, 1, &whole);
  submit();
  write_png(path, width_, kHeight,
            {static_cast<const std::uint8_t*>(pixels_.mapped), std::size_t{4} * width_ * kHeight});
}
