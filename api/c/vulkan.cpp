// SPDX-License-Identifier: Apache-2.0
// A host's own Vulkan device.
#include "sunder/sunder_vulkan.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "c/simulation_create.hpp"
#include "c/vulkan_host.hpp"

namespace {

using namespace sunder::c;

#ifdef SUNDER_GPU
sunder_vulkan_buffer to_part(const sunder::vulkan::Buffer& b, std::uint64_t size) {
  return {reinterpret_cast<std::uint64_t>(b.handle()), b.offset(), size};
}

/// A buffer of the host's, if it lends one.
void check_buffer(const sunder_vulkan_buffer& b, std::uint64_t bytes, const char* what) {
  if (!b.buffer) return;
  if (b.offset % sunder::gpu::kDisplayAlignment != 0) {
    throw Failure(SUNDER_ERROR_VALUE, std::string("host: the buffer for ") + what +
                                          " begins at byte " + std::to_string(b.offset) +
                                          "; it must begin at a multiple of " +
                                          std::to_string(sunder::gpu::kDisplayAlignment));
  }
  if (b.size < bytes) {
    throw Failure(SUNDER_ERROR_SIZE, std::string("host: the buffer for ") + what + " has " +
                                         std::to_string(b.size) + " bytes; it must have " +
                                         std::to_string(bytes));
  }
}

void check_buffers(const sunder_vulkan_host& host, const sunder::Problem& problem) {
  const auto bytes = sunder::gpu::display_bytes(problem);
  check_buffer(host.displacement, bytes.displacement, "displacement");
  check_buffer(host.stress, bytes.stress, "stress");
  check_buffer(host.live, bytes.live, "live");
}

sunder::gpu::Display& display_of(SimulationObject& object) {
  auto* display = sunder::gpu::display_of(object.simulation().backend());
  if (display) return *display;
  throw Failure(SUNDER_ERROR_ORDER, "the simulation was not made by sunder_vulkan_create");
}

void require_solved(const SimulationObject& object) {
  if (!object.solved()) throw Failure(SUNDER_ERROR_ORDER, "there are no fields before a step");
}
#endif

}  // namespace

extern "C" {

sunder_status sunder_vulkan_create(sunder_scene scene, const sunder_vulkan_host* host,
                                   const sunder_callbacks* callbacks,
                                   sunder_simulation* simulation) {
  return call<SceneObject>(scene, [&]([[maybe_unused]] SceneObject& object) {
    const auto given = read_struct(host, sized<sunder_vulkan_host>(), "host");
#ifdef SUNDER_GPU
    if (object.scene.solver.backend == "cpu") {
      throw Failure(SUNDER_ERROR_VALUE, "the scene asks for backend cpu on a Vulkan device");
    }
    check_host(given);
    create_simulation(
        object, callbacks,
        [&](std::shared_ptr<const sunder::Problem> problem, sunder::Needs needs,
            std::shared_ptr<sunder::PipelineCache> cache) {
          check_buffers(given, *problem);
          auto options = to_options(given);
          options.cache = cache;
          sunder::CreatedBackend created;
          created.backend = sunder::gpu::create(std::move(problem), std::move(needs), options);
          if (!cache->ignored().empty()) {
            created.warnings.push_back("the pipeline cache that was handed in is ignored: " +
                                       cache->ignored());
          }
          return created;
        },
        false,  // the buffers that it shares are there once
        simulation);
#else
    static_cast<void>(given);
    static_cast<void>(callbacks);
    static_cast<void>(simulation);
    without_vulkan();
#endif
  });
}

sunder_status sunder_vulkan_get_display(sunder_simulation simulation,
                                        sunder_vulkan_display* display) {
  return call<SimulationObject>(simulation, [&]([[maybe_unused]] SimulationObject& object) {
    static_cast<void>(stated_size(display, "display"));
#ifdef SUNDER_GPU
    const sunder::gpu::Display& from = display_of(object);
    auto out = sized<sunder_vulkan_display>();
    out.nodes = from.nodes();
    out.tets = from.elements();
    const auto bytes = sunder::gpu::display_bytes(object.problem());
    out.displacement = to_part(from.displacement(), bytes.displacement);
    out.stress = to_part(from.stress(), bytes.stress);
    out.live = to_part(from.live(), bytes.live);
    write_struct(display, out, "display");
#else
    without_vulkan();
#endif
  });
}

sunder_status sunder_vulkan_record(sunder_simulation simulation, void* command_buffer) {
  return call<SimulationObject>(simulation, [&]([[maybe_unused]] SimulationObject& object) {
    require(command_buffer, "the command buffer");
#ifdef SUNDER_GPU
    const sunder::gpu::Display& display = display_of(object);
    require_solved(object);
    display.record(static_cast<VkCommandBuffer>(command_buffer));
#else
    without_vulkan();
#endif
  });
}

sunder_status sunder_vulkan_set_pipeline_cache(sunder_scene scene, const uint8_t* bytes,
                                               size_t size) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    if (size > 0) require(bytes, "bytes");
    const auto given = std::as_bytes(std::span(bytes, size));
    object.pipeline_cache.assign(given.begin(), given.end());
  });
}

sunder_status sunder_vulkan_pipeline_cache(sunder_simulation simulation, uint8_t* bytes,
                                           size_t capacity, size_t* length) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(length, "length");
    if (capacity > 0) require(bytes, "bytes");
    const std::vector<std::byte> all = object.pipeline_cache->bytes();
    *length = all.size();
    if (capacity == 0) return;
    if (capacity < all.size()) {
      throw Failure(SUNDER_ERROR_SIZE, "capacity is " + std::to_string(capacity) + " bytes; " +
                                           std::to_string(all.size()) + " are needed");
    }
    std::ranges::copy(std::as_bytes(std::span(all)),
                      std::as_writable_bytes(std::span(bytes, all.size())).begin());
  });
}

sunder_status sunder_vulkan_submit(sunder_simulation simulation,
                                   const sunder_vulkan_signals* signals) {
  return call<SimulationObject>(simulation, [&]([[maybe_unused]] SimulationObject& object) {
    const auto given = read_struct(signals, sized<sunder_vulkan_signals>(), "signals");
#ifdef SUNDER_GPU
    sunder::gpu::Display& display = display_of(object);
    require_solved(object);
    display.submit({reinterpret_cast<VkSemaphore>(given.wait_semaphore),
                    reinterpret_cast<VkSemaphore>(given.signal_semaphore), given.wait_value,
                    given.signal_value});
#else
    static_cast<void>(given);
    without_vulkan();
#endif
  });
}

}  // extern "C"
