// SPDX-License-Identifier: Apache-2.0
// Pressures of patches of pooled volume (core/body/pools) on the device, by law "linear": one pass
// before that of stress.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "body/pools.hpp"
#include "gpu/kernels.hpp"
#include "gpu/vulkan/commands.hpp"
#include "shaders/layout.h"
#include "sunder/problem.hpp"

namespace sunder::gpu {

class PatchPressures {
 public:
  /// What the pass reads, which must outlive it; `u`: fields of which either is asked for.
  struct Inputs {
    std::array<const vulkan::Buffer*, 2> u;
    const vulkan::Buffer &nodes, &shape, &facts;
  };
  /// Of a problem that pools.
  PatchPressures(const KernelFactory& kernels, const Problem& problem, const Inputs& inputs);

  /// Patches are from now on those of `now`, each a part of one of the problem's.
  void split(const fem::Pools& now);
  /// Device bytes, before they exist; 0: nothing pools.
  [[nodiscard]] static std::size_t planned_bytes(const Problem& problem);
  [[nodiscard]] std::size_t bytes() const;

  /// shaders::PatchPressure of each patch.
  [[nodiscard]] const vulkan::Buffer& pressures() const { return pressures_; }
  /// Of one of the fields.
  void record(vulkan::Commands& commands, std::size_t field,
              const shaders::ElementPush& push) const;

 private:
  struct Tables {
    std::vector<std::uint32_t> first, elements;
    std::vector<double> bulk;
  };
  [[nodiscard]] Tables tables_of(const fem::Pools& pools) const;
  void write(const Tables& tables);

  std::uint32_t room_;  // for patches, padded
  vulkan::Buffer first_, elements_, bulk_, pressures_;
  std::unique_ptr<vulkan::Kernel> kernel_;
  std::array<std::unique_ptr<vulkan::Binding>, 2> bindings_;  // of each field
};

}  // namespace sunder::gpu
