// SPDX-License-Identifier: Apache-2.0
// Route, update and precision of a scene on a device, with the reason.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gpu/vulkan/physical_device.hpp"
#include "solver/region.hpp"
#include "sunder/backend.hpp"

namespace sunder::gpu {

struct Plan {
  bool fp64 = false;                     ///< storage of the inverse and of element stress
  bool eager = false;                    ///< the update
  bool cg = false;                       ///< the route: conjugate gradients instead of the inverse
  std::optional<solver::Region> region;  ///< route condensed: what alone is on the device
  bool invert_on_device = false;         ///< the inverse is computed there
  std::string why;
  std::vector<std::string> warnings;
};

/// Throws DeviceError for a route that the backend does not offer, or that does not fit the device.
/// `displayed`: a host draws the whole body's fields, which must be on the device then.
[[nodiscard]] Plan make_plan(const Problem& problem, const Needs& needs,
                             const vulkan::PhysicalDevice& device, bool displayed);

/// Whatever the device, the host computes this problem's inverse: it may begin before there is one.
[[nodiscard]] bool host_inverts_anyway(const Problem& problem);

}  // namespace sunder::gpu
