// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/patch_pressures.hpp"

#include <algorithm>
#include <span>

#include "body/pools.hpp"

namespace sunder::gpu {

using vulkan::Buffer;
using vulkan::Placement;

namespace {

/// Patches that there can ever be, padded: those that a piece splits share no node of a live
/// element.
std::uint32_t room_for(const Problem& problem) {
  std::size_t most = 0;
  for (Index p = 0; problem.pools() && p < problem.pools()->count(); ++p) {
    most += std::max<std::size_t>(1, problem.pools()->nodes(problem, p).size() / 4);
  }
  return round_up(static_cast<std::uint32_t>(most), shaders::kGroup);
}

}  // namespace

std::size_t PatchPressures::planned_bytes(const Problem& problem) {
  const std::size_t patches = room_for(problem);
  if (patches == 0) return 0;
  return Buffer::padded((patches + 1) * sizeof(std::uint32_t)) +
         Buffer::padded(problem.mesh().tets.size() * sizeof(std::uint32_t)) +
         Buffer::padded(patches * sizeof(double)) +
         Buffer::padded(patches * sizeof(shaders::PatchPressure));
}

PatchPressures::PatchPressures(const KernelFactory& kernels, const Problem& problem,
                               const Inputs& inputs)
    : room_(room_for(problem)), kernel_(kernels.make_fp64("pools")) {
  vulkan::Device& device = kernels.device();
  const Tables tables = tables_of(*problem.pools());
  const auto create = [&](Buffer& buffer, std::size_t bytes) {
    buffer = Buffer(device, bytes, Placement::device);
  };
  create(first_, tables.first.size() * sizeof(std::uint32_t));
  create(elements_, problem.mesh().tets.size() * sizeof(std::uint32_t));
  create(bulk_, tables.bulk.size() * sizeof(double));
  create(pressures_, room_ * sizeof(shaders::PatchPressure));
  write(tables);
  for (std::size_t i = 0; i < bindings_.size(); ++i) {
    const std::vector<const Buffer*> list{inputs.u[i], &inputs.nodes, &inputs.shape, &inputs.facts,
                                          &first_,     &elements_,    &bulk_,        &pressures_};
    bindings_[i] = std::make_unique<vulkan::Binding>(device, *kernel_, list);
  }
}

/// Those that pad have no elements. All the room is dispatched: what is recorded holds after a
/// split.
PatchPressures::Tables PatchPressures::tables_of(const fem::Pools& pools) const {
  Tables tables{{0}, {}, std::vector<double>(room_, 0.0)};
  for (Index p = 0; p < pools.count(); ++p) {
    for (Index e : pools.elements(p)) tables.elements.push_back(static_cast<std::uint32_t>(e));
    tables.first.push_back(static_cast<std::uint32_t>(tables.elements.size()));
    tables.bulk[static_cast<std::size_t>(p)] = pools.bulk(p);
  }
  tables.first.resize(room_ + 1, tables.first.back());
  return tables;
}

void PatchPressures::write(const Tables& tables) {
  first_.write(std::span(tables.first));
  elements_.write(std::span(tables.elements));
  bulk_.write(std::span(tables.bulk));
}

void PatchPressures::split(const fem::Pools& now) { write(tables_of(now)); }

std::size_t PatchPressures::bytes() const {
  return first_.bytes() + elements_.bytes() + bulk_.bytes() + pressures_.bytes();
}

void PatchPressures::record(vulkan::Commands& commands, std::size_t field,
                            const shaders::ElementPush& push) const {
  commands.dispatch(*bindings_[field], push, room_ / shaders::kGroup);
}

}  // namespace sunder::gpu
