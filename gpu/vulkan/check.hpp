// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/vulkan/functions.hpp"
#include "sunder/error.hpp"

namespace sunder::vulkan {

/// Throws DeviceLost or DeviceError with a sentence for `result`; `what` is the call or its
/// purpose.
void check(VkResult result, const char* what);

}  // namespace sunder::vulkan
