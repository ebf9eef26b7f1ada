// SPDX-License-Identifier: Apache-2.0
// The damaged stiffness as 3 x 3 blocks between nodes in slices of 64 rows (SELL-64), with its
// block-Jacobi preconditioner. Rows sum to zero and K u is summed from differences, so that no
// block is kept on the diagonal; each carries the number of its column. A destroyed element's 16
// blocks are summed anew, element by element: no cancellation between its remaining stiffness and
// what was taken out. What patches of pooled volume add stands beside the blocks
// (patch_vectors.hpp).
#pragma once

#include <span>
#include <vector>

#include "gpu/passes/patch_vectors.hpp"
#include "gpu/passes/slices.hpp"
#include "sunder/problem.hpp"

namespace sunder::gpu {

class BlockMatrix {
 public:
  /// The pattern alone, on the host.
  explicit BlockMatrix(const Problem& problem);
  /// The whole, with preconditioner, on the device.
  BlockMatrix(const KernelFactory& kernels, const Problem& problem) : BlockMatrix(problem) {
    upload(kernels, true);
  }
  /// Of upload() to come.
  [[nodiscard]] std::size_t planned_bytes(bool preconditioner) const;
  /// Throws DeviceError when the device's buffers cannot hold it.
  void upload(const KernelFactory& kernels, bool preconditioner);

  /// Follows an event; `scale`: a_e after it; `now`: patches of pooled volume as damage has split
  /// them, null: the problem's.
  void destroy(std::span<const Index> elements, std::span<const double> scale,
               const fem::Pools* now = nullptr);
  /// These unknowns are gripped from now on, those of the problem at first: what preconditions
  /// their nodes is made anew. `scale` as there.
  void grip(std::span<const Index> gripped, std::span<const double> scale);

  [[nodiscard]] const vulkan::Buffer& blocks() const { return blocks_; }
  [[nodiscard]] const vulkan::Buffer& slices() const { return slices_; }
  [[nodiscard]] const vulkan::Buffer& preconditioner() const { return preconditioner_; }
  /// Of pooled volume, which the kernels NAME_pooled add; empty where nothing pools.
  [[nodiscard]] const PatchVectors& patches() const { return patches_; }
  /// Workgroups of 64 nodes.
  [[nodiscard]] std::uint32_t groups() const { return rows_.groups(); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  void build_pattern();
  /// `scale` empty: intact.
  [[nodiscard]] Mat3 block(Index row, Index column, std::span<const double> scale = {}) const;
  [[nodiscard]] Mat3 diagonal(Index node, std::span<const double> scale = {}) const {
    return block(node, node, scale) + patches_.diagonal(node);
  }
  void write_preconditioner(Index node, std::span<const double> scale);
  [[nodiscard]] Mat3 inverse_of_free(Index node, const Mat3& diagonal) const;

  const Problem& problem_;
  std::vector<Index> gripped_;                   // ascending
  std::vector<std::vector<Index>> elements_of_;  // per node, ascending
  std::vector<std::vector<Index>> neighbours_;   // per node, ascending
  Slices rows_;
  PatchVectors patches_;
  vulkan::Buffer blocks_, slices_, preconditioner_;
};

}  // namespace sunder::gpu
