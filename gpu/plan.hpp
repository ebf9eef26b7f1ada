// SPDX-License-Identifier: Apache-2.0
// Route, update and precision of a scene on a device, with the reason.
#pragma once

#include <string>

#include "gpu/vulkan/physical_device.hpp"
#include "sunder/backend.hpp"

namespace sunder::gpu {

struct Plan {
  bool fp64 = false;              ///< storage of the inverse and of element stress
  bool eager = false;             ///< the update
  bool cg = false;                ///< the route: conjugate gradients instead of the inverse
  bool invert_on_device = false;  ///< the inverse is computed there
  std::string why;
};

/// Throws DeviceError for a route that the backend does not offer, or that does not fit the device.
[[nodiscard]] Plan make_plan(const Problem& problem, const Needs& needs,
                             const vulkan::PhysicalDevice& device);

}  // namespace sunder::gpu
