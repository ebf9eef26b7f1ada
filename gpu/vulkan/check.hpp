// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/vulkan/functions.hpp"
#include "sunder/error.hpp"

namespace sunder::vulkan {

/// The device stopped answering in the middle of its work; what it held is gone.
class DeviceLost : public DeviceError {
 public:
  using DeviceError::DeviceError;
};

/// Throws DeviceLost or DeviceError with a sentence for `result`; `what` is the call or its
/// purpose.
void check(VkResult result, const char* what);

}  // namespace sunder::vulkan
