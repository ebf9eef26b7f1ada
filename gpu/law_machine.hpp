// SPDX-License-Identifier: Apache-2.0
// The device as bodies at finite deformation and in motion use it.
#pragma once

#include "finite/law_backend.hpp"
#include "gpu/vulkan_backend.hpp"

namespace sunder::gpu {

/// Opens the device that the scene names or the first GPU. Throws DeviceError: no such device, no
/// shaderFloat64, a host's own device.
[[nodiscard]] finite::Machine law_machine(const Problem& problem, const VulkanOptions& options);

}  // namespace sunder::gpu
