// SPDX-License-Identifier: Apache-2.0
// The damaged stiffness as 3 x 3 blocks between nodes in slices of 64 rows (SELL-64), with its
// block-Jacobi preconditioner. Rows sum to zero and K u is summed from differences, so that no
// block is kept on the diagonal; each carries the number of its column. A destroyed element's 16
// blocks are summed anew, element by element: no cancellation between its remaining stiffness and
// what was taken out. A patch of pooled volume couples all its nodes: those blocks too are summed
// anew.
#pragma once

#include <array>
#include <set>
#include <span>
#include <vector>

#include "gpu/kernels.hpp"
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

  /// Follows an event; `scale`: a_e after it.
  void destroy(std::span<const Index> elements, std::span<const double> scale);
  /// These unknowns are gripped from now on, those of the problem at first: what preconditions
  /// their nodes is made anew. `scale` as there.
  void grip(std::span<const Index> gripped, std::span<const double> scale);

  [[nodiscard]] const vulkan::Buffer& blocks() const { return blocks_; }
  [[nodiscard]] const vulkan::Buffer& slices() const { return slices_; }
  [[nodiscard]] const vulkan::Buffer& preconditioner() const { return preconditioner_; }
  /// Workgroups of 64 nodes.
  [[nodiscard]] std::uint32_t groups() const { return groups_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  void build_pattern();
  /// `scale` empty: intact.
  [[nodiscard]] Mat3 block(Index row, Index column, std::span<const double> scale = {}) const;
  [[nodiscard]] Mat3 pressure_block(Index row, Index column, std::span<const double> scale) const;
  [[nodiscard]] Vec3 patch_vector(Index patch, Index node, std::span<const double> scale) const;
  void touch_patches(std::span<const Index> elements,
                     std::set<std::pair<Index, Index>>& touched) const;
  void pack(const Mat3& block, Index column, double* to) const;
  /// Of a row's k-th block, in blocks.
  [[nodiscard]] std::size_t place(std::size_t row, std::size_t k) const;
  [[nodiscard]] std::size_t block_count() const {
    return std::size_t{first_.back()} * shaders::kGroup;
  }
  [[nodiscard]] Mat3 inverse_of_free(Index node, const Mat3& diagonal) const;

  const Problem& problem_;
  std::vector<Index> gripped_;  // ascending
  std::uint32_t groups_;
  std::vector<std::vector<Index>> elements_of_;  // per node, ascending
  std::vector<std::vector<Index>> neighbours_;   // per node, ascending
  std::vector<std::vector<Index>> patches_of_;   // per node, ascending; empty: nothing pools
  std::vector<std::uint32_t> first_;             // of each slice, in rows of 64 blocks
  vulkan::Buffer blocks_, slices_, preconditioner_;
};

}  // namespace sunder::gpu
