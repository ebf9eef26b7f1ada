// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/two_floats.hpp"

#include <array>
#include <bit>

namespace sunder::gpu {

std::vector<float> two_floats(std::span<const double> values) {
  std::vector<float> pairs;
  pairs.reserve(2 * values.size());
  for (double v : values) {
    const auto high = static_cast<float>(v);
    pairs.push_back(high);
    pairs.push_back(static_cast<float>(v - static_cast<double>(high)));
  }
  return pairs;
}

void join_two_floats(std::span<double> values) {
  for (double& v : values) {
    const auto parts = std::bit_cast<std::array<float, 2>>(v);
    v = static_cast<double>(parts[0]) + static_cast<double>(parts[1]);
  }
}

void write_wide(const KernelFactory& kernels, vulkan::Buffer& buffer,
                std::span<const double> values) {
  if (kernels.single()) {
    buffer.write(std::span<const float>(two_floats(values)));
  } else {
    buffer.write(values);
  }
}

}  // namespace sunder::gpu
