// SPDX-License-Identifier: Apache-2.0
// The kernels' SPIR-V, compiled at build time and part of the library: no file is read at run time.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace sunder::shaders {

/// Words of a kernel by name, e.g. "apply_gpu_fp32"; empty: no such kernel.
[[nodiscard]] std::span<const std::uint32_t> find(std::string_view name);
/// Of all kernels.
[[nodiscard]] std::vector<std::string_view> names();

}  // namespace sunder::shaders
