// SPDX-License-Identifier: Apache-2.0
// A dispatch of more workgroups along x than a device takes: as many full rows as there are, along
// z, and the rest of a row after them. Exactly as many workgroups run as were asked for; each finds
// its number by workgroup() (shaders/common.glsl).
#pragma once

#include <algorithm>

#include "gpu/vulkan/kernel.hpp"

namespace sunder::vulkan {

struct FoldedGroups {
  std::uint32_t x, y;  ///< of a row
  std::uint32_t rows, rest;

  /// Throws DeviceError where a device takes not so many rows.
  FoldedGroups(const PhysicalDevice& device, const Kernel& kernel, std::uint32_t groups_x,
               std::uint32_t groups_y)
      : y(groups_y) {
    const auto most = static_cast<std::uint32_t>(device.limits.groups.value);
    x = std::min(groups_x, most);
    rows = groups_x <= most ? 1 : groups_x / most;
    rest = groups_x <= most ? 0 : groups_x % most;
    device.require(std::max(rows, y), device.limits.rows_of_groups, "kernel " + kernel.name());
  }

  void dispatch_rows(const DeviceFunctions& vk, VkCommandBuffer commands) const {
    vk.CmdDispatch(commands, x, y, rows);
  }
  void dispatch_rest(const DeviceFunctions& vk, VkCommandBuffer commands) const {
    vk.CmdDispatchBase(commands, 0, 0, rows, rest, y, 1);
  }
};

}  // namespace sunder::vulkan
