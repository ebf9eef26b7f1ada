// SPDX-License-Identifier: Apache-2.0
// What patches of pooled volume (core/body/pools) add to the stiffness, kappa/V_p b_p b_p^T each:
// not as blocks between all nodes of a patch but as v = (kappa/V_p)^1/2 b_p, three numbers a node.
// K p takes v . p of each patch first (patch_sums.comp), and then adds v times it at each node
// (patch_forces.glsl). Both orders of the same numbers are kept, by patch and by node, in slices.
#pragma once

#include <memory>
#include <set>
#include <span>
#include <vector>

#include "gpu/passes/slices.hpp"
#include "gpu/vulkan/commands.hpp"
#include "sunder/problem.hpp"

namespace sunder::gpu {

class PatchVectors {
 public:
  /// On the host; empty where nothing pools.
  explicit PatchVectors(const Problem& problem);
  [[nodiscard]] bool empty() const { return begin_.size() == 1; }
  /// Of upload() to come; 0: empty.
  [[nodiscard]] std::size_t planned_bytes() const;
  void upload(const KernelFactory& kernels);
  [[nodiscard]] std::size_t bytes() const;

  /// Follows an event; `scale`: a_e after it. Adds the nodes whose diagonal blocks change.
  void destroy(std::span<const Index> elements, std::span<const double> scale,
               std::set<Index>& touched);
  /// Sum of v v^T at a node.
  [[nodiscard]] Mat3 diagonal(Index node) const;

  /// Workgroups of 64 patches.
  [[nodiscard]] std::uint32_t groups() const { return by_patch_.groups(); }
  /// v . p of each patch.
  [[nodiscard]] std::unique_ptr<vulkan::Binding> bind_sums(const KernelFactory& kernels,
                                                           const vulkan::Kernel& kernel,
                                                           const vulkan::Buffer& p) const;
  /// Adds what patch_forces.glsl reads to a kernel's buffers.
  void append_to(std::vector<const vulkan::Buffer*>& buffers) const;

 private:
  void compute(Index patch, std::span<const double> scale);
  void write(Index patch);

  const Problem& problem_;
  // Entries of all patches, one after the other: nodes ascending.
  std::vector<std::size_t> begin_{0};
  std::vector<Index> nodes_;
  std::vector<Vec3> values_;
  std::vector<std::vector<std::size_t>> of_node_;  // entries of each node, ascending
  std::vector<std::size_t> row_;                   // of each entry: which one of its node
  Slices by_patch_, by_node_;
  vulkan::Buffer patches_, patch_slices_, nodal_, nodal_slices_, sums_;
};

}  // namespace sunder::gpu
