// SPDX-License-Identifier: Apache-2.0
// Numbers as a device keeps them: fp64, or two floats each where it has none
// (shaders/two_float.glsl).
#pragma once

#include <span>
#include <vector>

#include "gpu/kernels.hpp"

namespace sunder::gpu {

/// High part and rest of each, interleaved.
[[nodiscard]] std::vector<float> two_floats(std::span<const double> values);
/// Numbers of two floats each, read as if they were fp64, to fp64.
void join_two_floats(std::span<double> values);
/// From the buffer's first byte on.
void write_wide(const KernelFactory& kernels, vulkan::Buffer& buffer,
                std::span<const double> values);

}  // namespace sunder::gpu
