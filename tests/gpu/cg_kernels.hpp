// SPDX-License-Identifier: Apache-2.0
// What tests of single kernels of route cg share: vectors of four values a node, and sums over
// them.
#pragma once

#include <cmath>
#include <vector>

#include "kernels_fixture.hpp"

namespace sunder::test {

class CgKernels : public Kernels {
 protected:
  static constexpr std::uint32_t kGroups = 3;                       // of 64 nodes
  static constexpr std::size_t kNodes = kGroups * shaders::kGroup;  // four values each

  /// Four values a node, of which the fourth is zero.
  [[nodiscard]] Doubles random_nodes() {
    Doubles values(4 * kNodes);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 4 < 3 ? random() : 0;
    return values;
  }
  void run(const char* name, const std::vector<const vulkan::Buffer*>& buffers,
           const shaders::CgPush& push, std::uint32_t groups,
           std::uint32_t group = shaders::kGroup) {
    Kernels::run(*factory_->make(name, group), buffers, push, groups);
  }
  /// Partial results of a sum over nodes, each over the nodes that share a part.
  void expect_parts(const vulkan::Buffer& sums, const Doubles& a, const Doubles& b) const {
    const std::size_t parts = kGroups * factory_->parts(), per_part = 4 * kNodes / parts;
    const Doubles got = read(sums, parts);
    for (std::size_t part = 0; part < parts; ++part) {
      double sum = 0, size = 0;
      for (std::size_t i = part * per_part; i < (part + 1) * per_part; ++i) {
        sum += a[i] * b[i];
        size += std::abs(a[i] * b[i]);
      }
      EXPECT_LE(std::abs(got[part] - sum), static_cast<double>(per_part) * kEps64 * size) << part;
    }
  }
  [[nodiscard]] shaders::CgState& state(vulkan::Buffer& of) const {
    if (of.bytes() == 0) {
      of = vulkan::Buffer(*device_, sizeof(shaders::CgState), vulkan::Placement::host);
      of.fill_zero();
    }
    return *of.mapped<shaders::CgState>();
  }
};

}  // namespace sunder::test
