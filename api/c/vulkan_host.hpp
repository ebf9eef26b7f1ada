// SPDX-License-Identifier: Apache-2.0
// What a host says of its Vulkan device, checked, and as the backend takes it.
#pragma once

#include "c/failure.hpp"
#include "sunder/sunder_vulkan.h"
#ifdef SUNDER_GPU
#include "gpu/vulkan_backend.hpp"
#endif

namespace sunder::c {

#ifdef SUNDER_GPU
/// All that can be said before anything is prepared, but for buffers. Throws SUNDER_ERROR_NULL,
/// _VALUE, and DeviceError.
void check_host(const sunder_vulkan_host& host);

/// With what the environment says for tests.
[[nodiscard]] gpu::VulkanOptions to_options(const sunder_vulkan_host& host);

// Non-dispatchable handles are pointers here; elsewhere they are the number itself.
static_assert(sizeof(VkBuffer) == sizeof(std::uint64_t));
#else
[[noreturn]] inline void without_vulkan() {
  throw Failure(SUNDER_ERROR_DEVICE, "this build leaves out the backend vulkan (SUNDER_GPU=OFF)");
}
#endif

}  // namespace sunder::c
