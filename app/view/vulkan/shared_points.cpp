// SPDX-License-Identifier: Apache-2.0
#include "app/view/vulkan/shared_points.hpp"

namespace sunder::app::view {
namespace {

constexpr std::uint32_t kStride = 16;  // bytes, of a node and of a triangle
static_assert(kStride == Points::kNumbers * sizeof(float));

sunder_vulkan_items items_of(const HostBuffer& buffer) {
  return {reinterpret_cast<std::uint64_t>(buffer.get()), 0, buffer.size(),
          VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, kStride};
}

}  // namespace

Points::Points(const Device& on, std::size_t nodes, std::size_t most_triangles)
    : device(on),
      places(on, kStride * nodes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, false),
      normals(on, kStride * nodes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, false),
      values(on, kStride * most_triangles, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, false) {}

void SharedPoints::leave() {
  frames_.clear();
  commands_.reset();
  device_ = nullptr;
}

void SharedPoints::begin(Device& device) {
  leave();
  device_ = &device;
}

/// One that nobody draws, or a further one. Three are enough: the one that is drawn, the one that
/// is to be drawn next, and this one. One that has become too small for what a tear has laid open
/// leaves its place to a larger one, with room to spare: a tear goes on.
SharedPoints::Frame* SharedPoints::free_frame(Simulation& simulation, const Surface& of) {
  const std::size_t triangles = of.triangles().size();
  std::erase_if(frames_, [&](const Frame& frame) {
    return frame.points.use_count() == 1 && frame.points->values.size() < kStride * triangles;
  });
  for (Frame& frame : frames_) {
    if (frame.points.use_count() == 1) return &frame;
  }
  auto points = std::make_shared<Points>(*device_, of.node_count(), triangles * 3 / 2);
  auto surface = VulkanSurface::on(simulation, items_of(points->places), items_of(points->normals),
                                   items_of(points->values));
  if (!surface) return nullptr;
  return &frames_.emplace_back(Frame{std::move(points), std::move(surface)});
}

std::shared_ptr<const Points> SharedPoints::write(Simulation& simulation, const Surface& surface) {
  if (!device_ || simulation.steps_done() == 0) return nullptr;
  Frame* const frame = free_frame(simulation, surface);
  if (!frame) {
    leave();  // nor will it later
    return nullptr;
  }
  if (!commands_) commands_.emplace(*device_);
  frame->surface->record(commands_->begin(), surface);
  commands_->run();
  return frame->points;
}

}  // namespace sunder::app::view
