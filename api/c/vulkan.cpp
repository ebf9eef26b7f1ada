// SPDX-License-Identifier: Apache-2.0
// A host's own Vulkan device.
#include "sunder/sunder_vulkan.h"

#include "c/simulation_create.hpp"
#ifdef SUNDER_GPU
#include "gpu/vulkan_backend.hpp"
#endif

namespace {

using namespace sunder::c;

#ifdef SUNDER_GPU
// Non-dispatchable handles are pointers here; elsewhere they are the number itself.
static_assert(sizeof(VkBuffer) == sizeof(std::uint64_t));

sunder::gpu::DisplayTarget to_target(const sunder_vulkan_buffer& b) {
  return {reinterpret_cast<VkBuffer>(b.buffer), b.offset, b.size};
}

sunder_vulkan_buffer to_part(const sunder::vulkan::Buffer& b, std::uint64_t size) {
  return {reinterpret_cast<std::uint64_t>(b.handle()), b.offset(), size};
}

sunder::vulkan::LentDevice to_lent(const sunder_vulkan_host& host) {
  sunder::vulkan::LentDevice lent;
  lent.get = reinterpret_cast<PFN_vkGetInstanceProcAddr>(host.get_instance_proc_addr);
  lent.instance = static_cast<VkInstance>(host.instance);
  lent.physical = static_cast<VkPhysicalDevice>(host.physical_device);
  lent.device = static_cast<VkDevice>(host.device);
  lent.queue = static_cast<VkQueue>(host.queue);
  lent.family = host.queue_family;
  lent.api_version = host.api_version;
  lent.float64 = host.features & SUNDER_VULKAN_SHADER_FLOAT64;
  lent.int64 = host.features & SUNDER_VULKAN_SHADER_INT64;
  lent.timeline_semaphore = host.features & SUNDER_VULKAN_TIMELINE_SEMAPHORE;
  if (!host.lock != !host.unlock) {
    throw Failure(SUNDER_ERROR_NULL, "lock and unlock come in pairs; one of them is null");
  }
  if (host.lock) {
    lent.lock.lock = [lock = host.lock, user = host.lock_user] { lock(user); };
    lent.lock.unlock = [unlock = host.unlock, user = host.lock_user] { unlock(user); };
  }
  return lent;
}

sunder::gpu::VulkanOptions to_options(const sunder_vulkan_host& host) {
  sunder::gpu::VulkanOptions options;
  options.lent = to_lent(host);
  options.display = {to_target(host.displacement), to_target(host.stress), to_target(host.live)};
  return options;
}

sunder::gpu::Display& display_of(SimulationObject& object) {
  auto* display = sunder::gpu::display_of(object.simulation().backend());
  if (display) return *display;
  throw Failure(SUNDER_ERROR_ORDER, "the simulation was not made by sunder_vulkan_create");
}

void require_solved(const SimulationObject& object) {
  if (!object.solved()) throw Failure(SUNDER_ERROR_ORDER, "there are no fields before a step");
}
#else
[[noreturn]] void without_vulkan() {
  throw Failure(SUNDER_ERROR_DEVICE, "this build leaves out the backend vulkan (SUNDER_GPU=OFF)");
}
#endif

}  // namespace

extern "C" {

sunder_status sunder_vulkan_create(sunder_scene scene, const sunder_vulkan_host* host,
                                   const sunder_callbacks* callbacks,
                                   sunder_simulation* simulation) {
#ifdef SUNDER_GPU
  return guarded_status([&] {
    const auto options = to_options(read_struct(host, sized<sunder_vulkan_host>(), "host"));
    return create_simulation(
        scene, callbacks,
        [&](std::shared_ptr<const sunder::Problem> problem, sunder::Needs needs) {
          if (problem->scene().solver.backend == "cpu") {
            throw Failure(SUNDER_ERROR_VALUE, "the scene asks for backend cpu on a Vulkan device");
          }
          return sunder::CreatedBackend{
              sunder::gpu::create(std::move(problem), std::move(needs), options), {}};
        },
        simulation);
  });
#else
  static_cast<void>(host);
  return create_simulation(
      scene, callbacks,
      [](std::shared_ptr<const sunder::Problem>, sunder::Needs) -> sunder::CreatedBackend {
        without_vulkan();
      },
      simulation);
#endif
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
    out.displacement = to_part(from.displacement(), std::uint64_t{16} * out.nodes);
    out.stress = to_part(from.stress(), std::uint64_t{8} * out.tets);
    out.live = to_part(from.live(), std::uint64_t{4} * out.tets);
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
