// SPDX-License-Identifier: Apache-2.0
// What the workgroups of a compiled kernel share.
#pragma once

#include <cstdint>
#include <span>

namespace sunder::vulkan {

/// Bytes of a module's shared variables, one after the other and aligned as std430 does, which is
/// how Vulkan counts them against maxComputeSharedMemorySize. The lengths of arrays must be
/// constants that nothing specializes.
[[nodiscard]] std::uint64_t shared_bytes(std::span<const std::uint32_t> spirv);

}  // namespace sunder::vulkan
