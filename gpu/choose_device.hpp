// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/vulkan/device.hpp"
#include "sunder/types.hpp"

namespace sunder::gpu {

/// Device `asked`, or for kNone the first GPU, or the first device that can run the kernels.
/// Throws DeviceError when there is none.
[[nodiscard]] vulkan::PhysicalDevice choose_device(const vulkan::Instance& instance, int asked,
                                                   const vulkan::DeviceProbe& probe = {});

}  // namespace sunder::gpu
