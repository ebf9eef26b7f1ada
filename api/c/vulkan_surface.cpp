// SPDX-License-Identifier: Apache-2.0
// The surface of a body in buffers of a host's own Vulkan device.
#include "c/simulation.hpp"
#include "c/structs.hpp"
#include "c/vulkan_host.hpp"
#ifdef SUNDER_GPU
#include "gpu/passes/surface_writer.hpp"
#endif

namespace sunder::c {

template <>
inline constexpr std::size_t kFirstSize<sunder_vulkan_surface> = offsetof(sunder_vulkan_surface,
                                                                          values);

#ifdef SUNDER_GPU
/// What writes it, with what it needs of a device that is not the simulation's.
class VulkanSurface {
 public:
  VulkanSurface(SimulationObject& object, const sunder_vulkan_host* host,
                const gpu::SurfaceTargets& targets, const Skin* skin)
      : skins_(object.skins), wants_skin_(skin != nullptr) {
    gpu::LentField field = gpu::lent_field(object.simulation().backend());
    if (host) {
      const gpu::VulkanOptions options = to_options(*host);
      device_ = vulkan::borrow_device(*options.lent, options.probe);
      kernels_.emplace(*device_, gpu::choose_variant(device_->physical()), false);
      field = {.kernels = &*kernels_};
    }
    shared_ = field.displacement != nullptr;
    writer_.emplace(field, object.simulation(), skin, targets);
  }
  /// Its displacement is read where the simulation has it.
  [[nodiscard]] bool shared() const { return shared_; }
  /// The skin is still the one that was there.
  [[nodiscard]] bool fits(const SimulationObject& object) const {
    return !wants_skin_ || object.skins == skins_;
  }
  [[nodiscard]] gpu::SurfaceWriter& writer() { return *writer_; }

 private:
  int skins_;
  bool wants_skin_, shared_ = false;
  std::unique_ptr<vulkan::Device> device_;  // borrowed; null: the simulation's
  std::optional<gpu::KernelFactory> kernels_;
  std::optional<gpu::SurfaceWriter> writer_;
};
#endif

}  // namespace sunder::c

namespace {

using namespace sunder::c;

#ifdef SUNDER_GPU
constexpr std::uint32_t kPoint = 12, kWord = 4, kValues = 16;  // bytes

std::string bytes_of(const char* what, const char* member, std::uint64_t value) {
  return std::string("surface: ") + what + " has " + member + " = " + std::to_string(value);
}

/// Items of a host's, if it lends them; `bytes`: of one.
sunder::gpu::LentItems to_items(const sunder_vulkan_items& items, std::uint32_t bytes,
                                const char* what) {
  if (!items.buffer) return {};
  const std::uint32_t stride = items.stride == 0 ? bytes : items.stride;
  if (items.offset % kWord != 0) {
    throw Failure(SUNDER_ERROR_VALUE,
                  bytes_of(what, "offset", items.offset) + "; it must be a multiple of 4");
  }
  if (stride % kWord != 0 || stride < bytes) {
    throw Failure(SUNDER_ERROR_VALUE, bytes_of(what, "stride", stride) +
                                          "; it must be a multiple of 4, and " +
                                          std::to_string(bytes) + " or more");
  }
  if (!(items.usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT)) {
    throw Failure(SUNDER_ERROR_VALUE,
                  bytes_of(what, "usage", items.usage) +
                      ", without VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, by which it is written");
  }
  return {reinterpret_cast<VkBuffer>(items.buffer), items.offset, items.size, stride};
}

sunder::gpu::SurfaceTargets to_targets(const sunder_vulkan_surface& surface) {
  return {to_items(surface.places, kPoint, "places"),
          to_items(surface.normals, kPoint, "normals"),
          to_items(surface.triangles, kPoint, "triangles"),
          to_items(surface.facts, kPoint, "facts"),
          to_items(surface.skin, kPoint, "skin"),
          to_items(surface.skin_lives, kWord, "skin_lives"),
          to_items(surface.values, kValues, "values")};
}

/// The skin that these buffers are for; null: none is wanted.
const sunder::Skin* wanted_skin(const SimulationObject& object,
                                const sunder::gpu::SurfaceTargets& targets) {
  if (!targets.skin.buffer && !targets.skin_lives.buffer) return nullptr;
  if (object.skin) return object.skin.get();
  throw Failure(SUNDER_ERROR_ORDER, "the simulation was given no skin");
}

void require_fits(sunder::gpu::SurfaceWriter& writer, const sunder::Surface& surface) {
  const auto small = writer.too_small(surface);
  if (!small) return;
  throw Failure(SUNDER_ERROR_SIZE, std::string("surface: the buffer for ") + small->what + " has " +
                                       std::to_string(small->bytes) + " bytes; it must have " +
                                       std::to_string(small->needed));
}

void lend(SimulationObject& object, const sunder_vulkan_host* host,
          const sunder_vulkan_surface& surface) {
  const bool on_host = sunder::gpu::lent_field(object.simulation().backend()).displacement;
  if (on_host && host) {
    throw Failure(SUNDER_ERROR_ORDER,
                  "the simulation is on a host's device: the surface goes there, and host is null");
  }
  if (!on_host && !host) {
    throw Failure(SUNDER_ERROR_ORDER, "the simulation is not on a host's device (backend " +
                                          object.simulation().backend().info().backend +
                                          "): host must name the device of the buffers");
  }
  const auto targets = to_targets(surface);
  const sunder::Skin* skin = wanted_skin(object, targets);
  object.draw_on(std::make_shared<VulkanSurface>(object, host, targets, skin));
}
#endif

}  // namespace

extern "C" {

sunder_status sunder_vulkan_lend_surface(sunder_simulation simulation,
                                         const sunder_vulkan_host* host,
                                         const sunder_vulkan_surface* buffers) {
  return call<SimulationObject>(simulation, [&]([[maybe_unused]] SimulationObject& object) {
#ifdef SUNDER_GPU
    if (!buffers) {
      object.draw_on(nullptr);
      return;
    }
    const auto surface = read_struct(buffers, sized<sunder_vulkan_surface>(), "surface");
    if (!host) {
      lend(object, nullptr, surface);
      return;
    }
    const auto given = read_struct(host, sized<sunder_vulkan_host>(), "host");
    check_host(given);
    lend(object, &given, surface);
#else
    static_cast<void>(host);
    static_cast<void>(buffers);
    without_vulkan();
#endif
  });
}

sunder_status sunder_vulkan_record_surface(sunder_simulation simulation, void* command_buffer,
                                           sunder_surface* surface) {
  return call<SimulationObject>(simulation, [&]([[maybe_unused]] SimulationObject& object) {
    require(command_buffer, "the command buffer");
    if (surface) static_cast<void>(stated_size(surface, "surface"));
#ifdef SUNDER_GPU
    VulkanSurface* const lent = object.vulkan_surface();
    if (!lent) throw Failure(SUNDER_ERROR_ORDER, "no buffers are lent for the surface");
    if (!lent->fits(object)) {
      throw Failure(SUNDER_ERROR_ORDER,
                    "the skin was given anew since the buffers were lent; lend them again");
    }
    if (lent->shared() && !object.solved()) {
      throw Failure(SUNDER_ERROR_ORDER, "there are no fields before a step");
    }
    const sunder::Surface& follows = object.follow_surface();
    if (surface) write_struct(surface, to_c(follows), "surface");
    require_fits(lent->writer(), follows);
    lent->writer().record(static_cast<VkCommandBuffer>(command_buffer), follows);
#else
    without_vulkan();
#endif
  });
}

}  // extern "C"
