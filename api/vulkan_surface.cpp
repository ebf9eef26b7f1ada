// SPDX-License-Identifier: Apache-2.0
#include "sunder/vulkan_surface.hpp"

#include <string>

#include "sunder/error.hpp"
#ifdef SUNDER_GPU
#include "gpu/passes/surface_writer.hpp"
#include "gpu/vulkan_backend.hpp"
#endif

namespace sunder {

#ifdef SUNDER_GPU
namespace {

constexpr std::uint32_t kPoint = 12, kValues = 16;  // bytes

gpu::LentItems lent(const sunder_vulkan_items& items, std::uint32_t bytes) {
  return {reinterpret_cast<VkBuffer>(items.buffer), items.offset, items.size,
          items.stride == 0 ? bytes : items.stride};
}

class OnDevice final : public VulkanSurface {
 public:
  OnDevice(const Simulation& simulation, const gpu::LentField& field,
           const gpu::SurfaceTargets& targets)
      : simulation_(simulation), writer_(field, simulation, nullptr, targets) {}

  void record(void* command_buffer, const Surface& surface) override {
    if (simulation_.steps_done() == 0) throw UsageError("there are no fields before a step");
    if (const auto small = writer_.too_small(surface)) {
      throw UsageError(std::string("the buffer for ") + small->what + " has " +
                       std::to_string(small->bytes) + " bytes; it must have " +
                       std::to_string(small->needed));
    }
    writer_.record(static_cast<VkCommandBuffer>(command_buffer), surface);
  }

 private:
  const Simulation& simulation_;
  gpu::SurfaceWriter writer_;
};

}  // namespace
#endif

std::unique_ptr<VulkanSurface> VulkanSurface::on(
    [[maybe_unused]] Simulation& simulation, [[maybe_unused]] const sunder_vulkan_items& places,
    [[maybe_unused]] const sunder_vulkan_items& normals,
    [[maybe_unused]] const sunder_vulkan_items& values) {
#ifdef SUNDER_GPU
  const gpu::LentField field = gpu::lent_field(simulation.backend());
  if (!field.displacement) return nullptr;
  gpu::SurfaceTargets targets;
  targets.places = lent(places, kPoint);
  targets.normals = lent(normals, kPoint);
  targets.values = lent(values, kValues);
  return std::make_unique<OnDevice>(simulation, field, targets);
#else
  return nullptr;
#endif
}

}  // namespace sunder
