// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/summary.hpp"

#include <algorithm>

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// So many partial results one workgroup joins as quickly as another dispatch would begin: 16 an
// invocation on a GPU, some .1 ms of lavapipe's one thread.
constexpr std::uint32_t kMostOfOne = 1024, kMostOfOneEmulated = 8192;

std::uint32_t joined(std::uint32_t parts) {
  return round_up(parts, shaders::kPartsAtOnce) / shaders::kPartsAtOnce;
}

bool in_two(const KernelFactory& kernels, const SummaryParts& most) {
  return std::max(most.elements, most.nodes) >
         (kernels.emulated() ? kMostOfOneEmulated : kMostOfOne);
}

/// Of the joined partial results of elements, and of nodes.
std::size_t element_bytes(const SummaryParts& most) {
  return Buffer::padded(joined(most.elements) * sizeof(shaders::StressPartial));
}
std::size_t node_bytes(const SummaryParts& most) {
  return Buffer::padded(joined(most.nodes) * sizeof(shaders::NodePartial));
}

}  // namespace

SummaryPass::SummaryPass(const KernelFactory& kernels, const SummaryParts& most,
                         const SummaryBuffers& buffers)
    : kernel_(kernels.make_fp64("summary")) {
  vulkan::Device& device = kernels.device();
  const bool two = in_two(kernels, most);
  if (two) {
    parts_kernel_ = kernels.make_fp64("summary_parts");
    joined_ = Buffer(device, element_bytes(most), Placement::device);
    joined_nodes_ = Buffer(device, node_bytes(most), Placement::device);
    const Buffer* of_parts[] = {&buffers.stress_partials, &buffers.node_partials, &joined_,
                                &joined_nodes_};
    parts_binding_ = std::make_unique<vulkan::Binding>(device, *parts_kernel_, of_parts);
  }
  const Buffer* of_one[] = {two ? &joined_ : &buffers.stress_partials,
                            two ? &joined_nodes_ : &buffers.node_partials, &buffers.summaries,
                            &buffers.over};
  binding_ = std::make_unique<vulkan::Binding>(device, *kernel_, of_one);
}

void SummaryPass::record(vulkan::Commands& commands, const SummaryParts& parts,
                         std::uint32_t slot) const {
  shaders::SummaryPush push{parts.elements, parts.nodes, slot};
  if (parts_binding_) {
    commands.dispatch(*parts_binding_, push, joined(std::max({parts.elements, parts.nodes, 1u})));
    push.element_parts = joined(parts.elements);
    push.node_parts = joined(parts.nodes);
  }
  commands.dispatch(*binding_, push, 1);
}

std::size_t SummaryPass::planned_bytes(const KernelFactory& kernels, const SummaryParts& most) {
  return in_two(kernels, most) ? element_bytes(most) + node_bytes(most) : 0;
}

std::size_t SummaryPass::bytes() const { return joined_.bytes() + joined_nodes_.bytes(); }

}  // namespace sunder::gpu
