// SPDX-License-Identifier: Apache-2.0
// What a frame returns, from the partial results of its workgroups: by one workgroup, or where
// there are too many for one by many and then one.
#pragma once

#include <memory>

#include "gpu/kernels.hpp"
#include "gpu/vulkan/commands.hpp"

namespace sunder::gpu {

/// The buffers that a summary is made of and goes to (shaders/layout.h).
struct SummaryBuffers {
  const vulkan::Buffer& stress_partials;
  const vulkan::Buffer& node_partials;
  const vulkan::Buffer& summaries;
  const vulkan::Buffer& over;
};

/// Partial results, at most.
struct SummaryParts {
  std::uint32_t elements = 0, nodes = 0;
};

class SummaryPass {
 public:
  SummaryPass(const KernelFactory& kernels, const SummaryParts& most,
              const SummaryBuffers& buffers);

  /// Of so many partial results, to a slot of the summaries.
  void record(vulkan::Commands& commands, const SummaryParts& parts, std::uint32_t slot) const;

  /// Device bytes of its own, before it exists.
  [[nodiscard]] static std::size_t planned_bytes(const KernelFactory& kernels,
                                                 const SummaryParts& most);
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::unique_ptr<vulkan::Kernel> kernel_,
      parts_kernel_;  // the latter null: one workgroup is enough
  vulkan::Buffer joined_, joined_nodes_;
  std::unique_ptr<vulkan::Binding> binding_, parts_binding_;
};

}  // namespace sunder::gpu
