// SPDX-License-Identifier: Apache-2.0
// Places, normals and what triangles are coloured by, that a simulation on the device that draws
// leaves there for its pictures: its kernels write them, and no byte of them goes through the host.
// Each frame has buffers of its own until nobody draws it any more, so that drawing never waits for
// the step that follows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "app/view/vulkan/commands.hpp"
#include "sunder/vulkan_surface.hpp"

namespace sunder::app::view {

/// Of one frame: places and normals of all nodes, four floats each, of which the last one means
/// nothing; four of every triangle.
struct Points {
  Points(const Device& on, std::size_t nodes, std::size_t most_triangles);
  const Device& device;
  HostBuffer places, normals, values;  // no host reads or writes them

  /// Numbers of a triangle, in the order of Field.
  static constexpr std::uint32_t kNumbers = 4;
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
  [[nodiscard]] Frame* free_frame(Simulation& simulation, const Surface& surface);

  Device* device_ = nullptr;  // null: nothing is shared
  std::optional<Commands> commands_;
  std::vector<Frame> frames_;
};

}  // namespace sunder::app::view
