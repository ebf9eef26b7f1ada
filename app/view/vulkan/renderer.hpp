// SPDX-License-Identifier: Apache-2.0
// Draws the triangles of a body: into an image of its own, which is read back or handed on.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "app/figure/raster.hpp"
#include "app/view/camera.hpp"
#include "app/view/look.hpp"
#include "app/view/vulkan/shared_points.hpp"
#include "sunder/surface.hpp"

namespace sunder::app::view {

class Renderer {
 public:
  /// The device must outlive it. Throws DeviceError.
  Renderer(Device& device, const PictureSize& size);

  // What is drawn from now on; no picture is in work meanwhile.
  /// `changed`: places among `triangles` that are new; those beyond the last are passed over.
  /// `grey`: by element, not 0: it has no colour of the scale; empty: all have.
  void set_triangles(std::span<const SurfaceTriangle> triangles,
                     std::span<const std::uint32_t> changed, std::span<const std::uint8_t> grey);
  void set_points(std::span<const Vec3> places, std::span<const Vec3> normals);
  /// Those that are on its device, with the values of triangles; kept until others come.
  void set_points(std::shared_ptr<const Points> points);
  [[nodiscard]] const Points* points() const { return points_.get(); }
  /// What triangles are coloured by, one each, where points() is null; those that are as they were
  /// are not written again.
  void set_values(std::span<const float> values);
  void set_lips(std::span<const std::array<Index, 2>> lips);

  /// What colours mean: `known` or nothing yet, from 0 to `maximum`; `item`: which of the numbers
  /// of a triangle, where points() has them.
  struct Scale {
    bool known = false;
    double maximum = 1;
    std::uint32_t item = 0;
  };
  /// Draws, and waits for it. The camera's picture has the size of this.
  void draw(const Camera& camera, const Look& look, const Scale& scale);
  /// The last picture.
  [[nodiscard]] Pixels read() const;

  /// Bytes that the host has written of what is drawn, so far.
  [[nodiscard]] std::uint64_t uploaded() const { return uploaded_; }
  [[nodiscard]] const PictureSize& size() const { return size_; }
  /// Of the last picture, R8G8B8A8, in layout TRANSFER_SRC_OPTIMAL.
  [[nodiscard]] VkImage image() const { return colour_.get(); }

 private:
  enum Binding : std::size_t { kPlaces, kNormals, kTriangles, kValues, kLips, kShades, kBindings };

  void make_pass();
  void make_framebuffer();
  void make_layout();
  [[nodiscard]] Owned<VkPipeline> make_pipeline(std::span<const std::uint32_t> vertex,
                                                std::span<const std::uint32_t> fragment);
  void upload_shades();
  void reserve(Binding binding, std::size_t bytes);
  void bind(Binding binding, const HostBuffer& buffer);
  void record(const Camera& camera, const Look& look, const Scale& scale);

  Device& device_;
  PictureSize size_;
  VkExtent2D extent_;
  Image many_, depth_, colour_;  // samples; resolved
  Owned<VkRenderPass> pass_;
  Owned<VkFramebuffer> framebuffer_;
  Owned<VkDescriptorSetLayout> set_layout_;
  Owned<VkDescriptorPool> set_pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  Owned<VkPipelineLayout> layout_;
  Owned<VkPipeline> body_, lips_;
  Commands commands_;
  HostBuffer pixels_;
  std::array<HostBuffer, kBindings> buffers_;
  std::shared_ptr<const Points> points_;  // bound in place of places, normals and values
  std::vector<float> values_;             // as the device has them
  std::uint64_t uploaded_ = 0;
  std::uint32_t triangle_count_ = 0, lip_count_ = 0;
};

}  // namespace sunder::app::view
