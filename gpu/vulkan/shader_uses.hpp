// SPDX-License-Identifier: Apache-2.0
// What a compiled kernel does with the buffers that are bound to it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace sunder::vulkan {

struct Use {
  bool reads = false, writes = false;
};

/// By binding, of descriptor set 0: what the module's instructions do, on any path, with the
/// variable bound there. Follows pointers through access chains, which is all that GLSL can make of
/// them (SPIR-V specification, 2.16.1 "Logical addressing"); functions get texel buffers alone by
/// pointer, and read them.
[[nodiscard]] std::vector<Use> shader_uses(std::span<const std::uint32_t> spirv);

}  // namespace sunder::vulkan
