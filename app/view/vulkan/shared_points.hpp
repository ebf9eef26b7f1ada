// SPDX-License-Identifier: Apache-2.0
// Places and normals that a simulation on the device that draws leaves there for its pictures: its
// kernels write them, and no byte of them goes through the host. Each frame has buffers of its own
// until nobody draws it any more, so that drawing never waits for the step that follows.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "app/view/vulkan/commands.hpp"
#include "sunder/vulkan_surface.hpp"

namespace sunder::app::view {

/// Of all nodes of one frame; four floats each, of which the last one means nothing.
struct Points {
  Points(const Device& on, std::size_t nodes);
  const Device& device;
  HostBuffer places, normals;  // no host reads or writes them
};

/// All but write() by whoever makes a backend: on the simulation's thread, as write() is.
class SharedPoints {
 public:
  /// Before the backend goes, or another one is made.
  void leave();
  /// There is a backend on this device, which must outlive all points of it.
  void begin(Device& device);

  /// Where the last step has left them; what draws later on the device's queue sees them. Null:
  /// there is no backend on a device that draws, none that shares its fields, or no step yet.
  /// `surface`: of the simulation, as it is now. Throws DeviceLost, DeviceError.
  [[nodiscard]] std::shared_ptr<const Points> write(Simulation& simulation, const Surface& surface);

 private:
  struct Frame {
    std::shared_ptr<Points> points;
    std::unique_ptr<VulkanSurface> surface;
  };
  [[nodiscard]] Frame* free_frame(Simulation& simulation, std::size_t nodes);

  Device* device_ = nullptr;  // null: nothing is shared
  std::optional<Commands> commands_;
  std::vector<Frame> frames_;
};

}  // namespace sunder::app::view
