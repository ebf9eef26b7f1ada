// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/patch_pressures.hpp"

#include <span>
#include <vector>

#include "body/pools.hpp"

namespace sunder::gpu {

using vulkan::Buffer;
using vulkan::Placement;

std::uint32_t PatchPressures::padded(const Problem& problem) {
  const auto count = problem.pools() ? static_cast<std::uint32_t>(problem.pools()->count()) : 0U;
  return round_up(count, shaders::kGroup);
}

std::size_t PatchPressures::planned_bytes(const Problem& problem) {
  const std::size_t patches = padded(problem);
  if (patches == 0) return 0;
  return Buffer::padded((patches + 1) * sizeof(std::uint32_t)) +
         Buffer::padded(problem.mesh().tets.size() * sizeof(std::uint32_t)) +
         Buffer::padded(patches * sizeof(double)) +
         Buffer::padded(patches * sizeof(shaders::PatchPressure));
}

PatchPressures::PatchPressures(const KernelFactory& kernels, const Problem& problem,
                               const Inputs& inputs)
    : patches_(padded(problem)), kernel_(kernels.make_fp64("pools")) {
  const fem::Pools& pools = *problem.pools();
  std::vector<std::uint32_t> first{0}, elements;
  std::vector<double> bulk(patches_, 0.0);
  for (Index p = 0; p < pools.count(); ++p) {
    for (Index e : pools.elements(p)) elements.push_back(static_cast<std::uint32_t>(e));
    first.push_back(static_cast<std::uint32_t>(elements.size()));
    bulk[static_cast<std::size_t>(p)] = pools.bulk(p);
  }
  first.resize(patches_ + 1, first.back());  // those that pad have no elements
  vulkan::Device& device = kernels.device();
  const auto upload = [&](Buffer& buffer, const auto& values) {
    buffer = Buffer(device, values.size() * sizeof(values[0]), Placement::device);
    buffer.write(std::span(values));
  };
  upload(first_, first);
  upload(elements_, elements);
  upload(bulk_, bulk);
  pressures_ = Buffer(device, patches_ * sizeof(shaders::PatchPressure), Placement::device);
  for (std::size_t i = 0; i < bindings_.size(); ++i) {
    const std::vector<const Buffer*> list{inputs.u[i], &inputs.nodes, &inputs.shape, &inputs.facts,
                                          &first_,     &elements_,    &bulk_,        &pressures_};
    bindings_[i] = std::make_unique<vulkan::Binding>(device, *kernel_, list);
  }
}

std::size_t PatchPressures::bytes() const {
  return first_.bytes() + elements_.bytes() + bulk_.bytes() + pressures_.bytes();
}

void PatchPressures::record(vulkan::Commands& commands, std::size_t field,
                            const shaders::ElementPush& push) const {
  commands.dispatch(*bindings_[field], push, patches_ / shaders::kGroup);
}

}  // namespace sunder::gpu
