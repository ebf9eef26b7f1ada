// SPDX-License-Identifier: Apache-2.0
// A trainer in small: its own Vulkan device and renderer, and a board that tears on that device.
//   host PICTURE.png [--surface] [--validation]
//     --surface     draws the surface that the library keeps in buffers of ours, not all elements
//     --validation  demands the validation layer; else it is used if installed
#include <cstdio>
#include <cstring>
#include <exception>
#include <iterator>

#include "board.hpp"
#include "device.hpp"
#include "renderer.hpp"

namespace {

constexpr int kSteps = 40;
constexpr int kPanelEnds[] = {24, 29, kSteps};  // steps that each part of the picture shows last

sunder_simulation lend(const Device& device, sunder_scene scene) {
  sunder_vulkan_host host = SUNDER_VULKAN_HOST_INIT;
  host.api_version = VK_API_VERSION_1_2;
  host.get_instance_proc_addr = reinterpret_cast<sunder_vulkan_get_function>(vkGetInstanceProcAddr);
  host.instance = device.instance;
  host.physical_device = device.physical;
  host.device = device.handle;
  host.queue = device.queue;
  host.queue_family = device.family;
  host.features = (device.float64 ? SUNDER_VULKAN_SHADER_FLOAT64 : 0) |
                  (device.int64 ? SUNDER_VULKAN_SHADER_INT64 : 0);
  sunder_simulation simulation = nullptr;
  check(sunder_vulkan_create(scene, &host, nullptr, &simulation));
  return simulation;
}

void run(Device& device, const char* path, bool surface) {
  const Board board;
  const sunder_scene scene = make_scene(board, kSteps);
  const sunder_simulation simulation = lend(device, scene);
  check(sunder_scene_destroy(scene));
  sunder_vulkan_display display = SUNDER_VULKAN_DISPLAY_INIT;
  check(sunder_vulkan_get_display(simulation, &display));
  {
    Renderer renderer(device, board, display, std::size(kPanelEnds), surface);
    if (surface) renderer.lend(simulation);
    sunder_step step = SUNDER_STEP_INIT;
    std::uint32_t panel = 0;
    for (int i = 0; i < kSteps; ++i) {
      check(sunder_simulation_step(simulation, &step));
      renderer.frame(simulation, panel);
      if (i + 1 == kPanelEnds[panel]) {
        std::printf("part %u: step %d, %d elements destroyed\n", panel++, i + 1, step.destroyed);
      }
    }
    renderer.save(path);
  }
  check(sunder_simulation_destroy(simulation));
}

}  // namespace

int main(int argc, char** argv) try {
  bool validation = false, surface = false, known = argc >= 2;
  for (int i = 2; i < argc; ++i) {
    const bool is_surface = std::strcmp(argv[i], "--surface") == 0;
    (is_surface ? surface : validation) = true;
    known = known && (is_surface || std::strcmp(argv[i], "--validation") == 0);
  }
  if (!known) {
    return std::fprintf(stderr, "usage: host PICTURE.png [--surface] [--validation]\n"), 2;
  }
  Device device(validation);
  std::printf("validation layer: %s\n", device.validated ? "on" : "not installed, runs without");
  run(device, argv[1], surface);
  for (const std::string& message : device.messages) std::fprintf(stderr, "%s\n", message.c_str());
  return device.messages.empty() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "host: %s\n", error.what());
  return 1;
}
