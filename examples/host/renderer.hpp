// SPDX-License-Identifier: Apache-2.0
// Draws the body off screen, several moments side by side, from the solver's buffers.
#pragma once

#include <sunder/sunder_vulkan.h>

#include <array>
#include <span>
#include <string>

#include "board.hpp"
#include "device.hpp"

class Renderer {
 public:
  static constexpr std::uint32_t kPanel = 600, kHeight = 700;  // pixels

  /// `surface`: draws the surface that the library keeps in buffers of ours, in place of all
  /// elements.
  Renderer(Device& device, const Board& board, const sunder_vulkan_display& display,
           std::uint32_t panels, bool surface);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Lends it the buffers for its surface.
  void lend(sunder_simulation simulation);
  /// One frame in one submit: lets `simulation` bring its fields, then draws them into a panel.
  void frame(sunder_simulation simulation, std::uint32_t panel);
  void save(const std::string& path);

 private:
  static constexpr VkFormat kColour = VK_FORMAT_R8G8B8A8_UNORM, kDepth = VK_FORMAT_D32_SFLOAT;
  struct Push {
    std::array<float, 16> view;  // columns
    std::array<float, 4> along;
    std::uint32_t node;
  };

  void create_image(VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect,
                    VkImage& image, VkDeviceMemory& memory, VkImageView& view);
  void create_pass();
  void create_descriptors(const sunder_vulkan_display& display);
  [[nodiscard]] VkPipeline create_pipeline(std::span<const std::uint32_t> vertex);
  void create_pipelines();
  void create_commands();
  void begin();
  void submit();
  void record_surface(sunder_simulation simulation);
  void draw(std::uint32_t panel);
  void clear_picture();

  Device& device_;
  std::uint32_t width_, vertices_, pulled_node_;
  bool surface_;
  std::uint32_t nodes_, most_triangles_, drawn_ = 0;
  Buffer rest_, tets_, pixels_, vertices_of_surface_, triangles_, facts_;
  VkImage colour_{}, depth_{};
  VkDeviceMemory colour_memory_{}, depth_memory_{};
  VkImageView colour_view_{}, depth_view_{};
  VkRenderPass pass_{};
  VkFramebuffer frame_{};
  VkDescriptorSetLayout set_layout_{};
  VkDescriptorPool pool_{};
  VkDescriptorSet set_{};
  VkPipelineLayout layout_{};
  VkPipeline body_{}, mark_{};
  VkCommandPool command_pool_{};
  VkCommandBuffer commands_{};
  VkFence done_{};
};
