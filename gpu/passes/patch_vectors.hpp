// SPDX-License-Identifier: Apache-2.0
// What patches of pooled volume (core/body/pools) add to the stiffness, kappa/V_p b_p b_p^T each:
// not as blocks between all nodes of a patch but as v = (kappa/V_p)^1/2 b_p, three numbers a node.
// K p takes v . p of each patch first (patch_sums.comp), and then adds v times it at each node
// (patch_forces.glsl). Both orders of the same numbers are kept, by patch and by node, in slices.
//
// Where damage has split a patch each part has a vector of its own. Room for all parts that there
// can be is there from the first: parts hang together by nodes, so that they share only nodes of
// destroyed elements, which stay with one of them. A patch of N nodes has no more than N/4 parts,
// and a node lies in no more than two of them. What is not in use is not read.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "gpu/passes/slices.hpp"
#include "gpu/vulkan/commands.hpp"
#include "sunder/problem.hpp"

namespace sunder::gpu {

class PatchVectors {
 public:
  /// On the host; empty where nothing pools.
  explicit PatchVectors(const Problem& problem);
  [[nodiscard]] bool empty() const { return patches_.empty(); }
  /// Of upload() to come; 0: empty.
  [[nodiscard]] std::size_t planned_bytes() const;
  void upload(const KernelFactory& kernels);
  [[nodiscard]] std::size_t bytes() const;

  /// Follows an event; `scale`: a_e after it, `now`: patches as damage has split them, each a part
  /// of one of the problem's (Pools::split). Adds the nodes whose diagonal blocks change.
  void destroy(std::span<const Index> elements, std::span<const double> scale,
               const fem::Pools& now, std::set<Index>& touched);
  /// Sum of v v^T at a node.
  [[nodiscard]] Mat3 diagonal(Index node) const;

  /// Workgroups of 64 patches and parts, for as long as it lives.
  [[nodiscard]] std::uint32_t groups() const { return by_patch_.slices().groups(); }
  /// Until the next event.
  [[nodiscard]] std::uint32_t groups_now() const {
    return split_.empty() ? groups_of_whole_ : groups();
  }
  /// v . p of each patch.
  [[nodiscard]] std::unique_ptr<vulkan::Binding> bind_sums(const KernelFactory& kernels,
                                                           const vulkan::Kernel& kernel,
                                                           const vulkan::Buffer& p) const;
  /// Adds what patch_forces.glsl reads to a kernel's buffers.
  void append_to(std::vector<const vulkan::Buffer*>& buffers) const;

 private:
  using Parts = std::vector<std::vector<Index>>;  // elements of each
  static constexpr std::size_t kUnused = static_cast<std::size_t>(-1);
  struct Value {
    Vec3 v = Vec3::Zero();
    std::size_t part = kUnused;
  };
  struct Entry {
    Index node;
    std::size_t at;               // among the patches of its node
    std::array<Value, 2> values;  // of the parts that the node lies in
  };
  struct Patch {
    std::vector<Entry> entries;  // nodes ascending
    std::size_t further;         // row of the second part, which others follow
    Parts parts;                 // empty: it is whole
  };

  /// Of a patch as it is now; empty: whole.
  [[nodiscard]] Parts parts_of(Index patch, const fem::Pools& now) const;
  void become(Index patch, Parts parts, std::span<const double> scale);
  void compute(Index patch, std::span<const double> scale);
  void add(Patch& patch, std::size_t part, std::span<const Index> elements, double bulk,
           std::span<const double> scale);
  void use_reserve(const Patch& patch, int one);
  [[nodiscard]] std::size_t row_of(Index patch, std::size_t part) const;
  /// Hands every number of a patch to put(order, place, v, of): `by_patch_` or `by_node_`, and the
  /// node or row that v belongs to.
  template <class Put>
  void place(Index patch, bool reserve, const Put& put) const;

  const Problem& problem_;
  std::vector<Patch> patches_;
  std::uint32_t groups_of_whole_ = 0;
  std::set<Index> split_;                                            // those with parts
  std::vector<std::vector<std::pair<Index, std::size_t>>> of_node_;  // patches and their entries
  ReservedSlices by_patch_, by_node_;  // in reserve: rows of further parts; a node's second parts
  vulkan::Buffer patch_values_, patch_ranges_, node_values_, node_ranges_, sums_;
};

}  // namespace sunder::gpu
