// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/block_matrix.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <set>

#include "body/element.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

constexpr std::size_t kBlockWords = 4 * shaders::kBlockPacks;
constexpr std::size_t kColumnAt = 18;  // of a block's words, behind its nine values
using PackedBlock = std::array<std::uint32_t, kBlockWords>;
using PackedInverse = std::array<double, 6>;  // the upper triangle, row by row

PackedBlock pack(const Mat3& block, Index column) {
  PackedBlock packed{};
  for (std::size_t k = 0; k < 9; ++k) {
    const double value = block(static_cast<Index>(k / 3), static_cast<Index>(k % 3));
    const auto words = std::bit_cast<std::array<std::uint32_t, 2>>(value);
    std::ranges::copy(words, &packed[2 * k]);
  }
  packed[kColumnAt] = static_cast<std::uint32_t>(column);
  return packed;
}

PackedInverse pack_inverse(const Mat3& inverse) {
  return {inverse(0, 0), inverse(0, 1), inverse(0, 2), inverse(1, 1), inverse(1, 2), inverse(2, 2)};
}

Index corner_of(const std::array<Index, 4>& tet, Index node) {
  return static_cast<Index>(std::find(tet.begin(), tet.end(), node) - tet.begin());
}

}  // namespace

BlockMatrix::BlockMatrix(const Problem& problem)
    : problem_(problem),
      gripped_(problem.gripped_dofs().begin(), problem.gripped_dofs().end()),
      elements_of_(problem.mesh().nodes.size()),
      neighbours_(problem.mesh().nodes.size()),
      patches_(problem) {
  build_pattern();
}

std::size_t BlockMatrix::planned_bytes(bool preconditioner) const {
  const std::size_t rows = std::size_t{groups()} * shaders::kGroup;
  return rows_.count() * sizeof(PackedBlock) + vulkan::Buffer::padded(rows_.bytes()) +
         (preconditioner ? rows * sizeof(PackedInverse) : 0) + patches_.planned_bytes();
}

void BlockMatrix::upload(const KernelFactory& kernels, bool preconditioner_wanted) {
  const Problem& problem = problem_;
  const vulkan::PhysicalDevice& device = kernels.device().physical();
  const std::size_t bytes = rows_.count() * sizeof(PackedBlock);
  // `lvp` reads blocks as texels alone, which lavapipe allows 16 times the range of storage
  // buffers.
  const std::size_t range =
      kernels.emulated() ? device.limits.texels.value * 16 : device.limits.buffer_bytes.value;
  const auto limit = std::min<std::size_t>(range, device.limits.allocation_bytes.value);
  if (bytes > limit) {
    throw DeviceError("the stiffness needs a buffer of " + std::to_string(bytes) +
                      " bytes, but the device \"" + device.name + "\" takes buffers of " +
                      std::to_string(limit) + "; use backend cpu");
  }
  std::vector<PackedBlock> blocks(rows_.count(), PackedBlock{});  // padding: of node 0, zero
  std::vector<PackedInverse> preconditioner(
      preconditioner_wanted ? std::size_t{groups()} * shaders::kGroup : 0, PackedInverse{});
  for (Index n = 0; n < problem.node_count(); ++n) {
    const auto row = static_cast<std::size_t>(n);
    for (std::size_t k = 0; k < neighbours_[row].size(); ++k) {
      blocks[rows_.place(row, k)] = pack(block(n, neighbours_[row][k]), neighbours_[row][k]);
    }
    if (preconditioner_wanted) {
      preconditioner[row] = pack_inverse(inverse_of_free(n, diagonal(n)));
    }
  }
  const auto upload = [&](vulkan::Buffer& buffer, auto& values) {
    buffer = vulkan::Buffer(kernels.device(), values.size() * sizeof(values[0]),
                            vulkan::Placement::device);
    buffer.write(std::span<const std::remove_reference_t<decltype(values[0])>>(values));
  };
  upload(blocks_, blocks);
  upload(slices_, rows_.first());
  if (preconditioner_wanted) upload(preconditioner_, preconditioner);
  patches_.upload(kernels);
}

void BlockMatrix::build_pattern() {
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    for (Index n : problem_.mesh().tets[e]) elements_of_[n].push_back(e);
  }
  std::vector<std::set<Index>> all(neighbours_.size());
  for (std::size_t n = 0; n < neighbours_.size(); ++n) {
    for (Index e : elements_of_[n]) {
      all[n].insert(problem_.mesh().tets[e].begin(), problem_.mesh().tets[e].end());
    }
  }
  std::vector<std::size_t> lengths;
  for (std::size_t n = 0; n < neighbours_.size(); ++n) {
    all[n].erase(static_cast<Index>(n));
    neighbours_[n].assign(all[n].begin(), all[n].end());
    lengths.push_back(neighbours_[n].size());
  }
  rows_ = Slices(lengths);
}

/// Sum of a_e V (lambda g_i g_j^T + mu g_j g_i^T + mu g_i.g_j I) over the elements of both nodes.
Mat3 BlockMatrix::block(Index row, Index column, std::span<const double> scale) const {
  Mat3 sum = Mat3::Zero();
  for (Index e : elements_of_[row]) {
    const auto& tet = problem_.mesh().tets[e];
    const Index j = corner_of(tet, column);
    if (j == 4) continue;
    const TetShape& shape = problem_.shape(e);
    const SmallStrain law = fem::own_law(problem_, e);
    const double mu = law.mu, lambda = law.lambda;
    const Vec3 gi = shape.gradient.col(corner_of(tet, row)), gj = shape.gradient.col(j);
    sum += (scale.empty() ? 1.0 : scale[e]) * shape.volume *
           (lambda * gi * gj.transpose() + mu * gj * gi.transpose() +
            mu * gi.dot(gj) * Mat3::Identity());
  }
  return sum;
}

/// Inverse of a diagonal block over the axes that neither a support nor a grip holds.
Mat3 BlockMatrix::inverse_of_free(Index node, const Mat3& diagonal) const {
  Mat3 matrix = diagonal;
  std::array<bool, 3> held{};
  for (int axis = 0; axis < 3; ++axis) {
    const Index dof = problem_.dof(node, axis);
    held[axis] = dof == kNone || std::ranges::binary_search(gripped_, dof);
    if (!held[axis]) continue;
    matrix.row(axis).setZero();
    matrix.col(axis).setZero();
    matrix(axis, axis) = 1;
  }
  Mat3 inverse = matrix.inverse();
  for (int axis = 0; axis < 3; ++axis) {
    if (held[axis]) inverse(axis, axis) = 0;
  }
  return inverse;
}

void BlockMatrix::destroy(std::span<const Index> elements, std::span<const double> scale,
                          const fem::Pools* now) {
  std::set<std::pair<Index, Index>> touched;
  std::set<Index> diagonals;
  for (Index e : elements) {
    for (Index i : problem_.mesh().tets[e]) {
      diagonals.insert(i);
      for (Index j : problem_.mesh().tets[e]) {
        if (i != j) touched.insert({i, j});
      }
    }
  }
  if (!patches_.empty()) {
    patches_.destroy(elements, scale, now ? *now : *problem_.pools(), diagonals);
  }
  for (const auto& [i, j] : touched) {
    const auto& row = neighbours_[i];
    const auto k =
        static_cast<std::size_t>(std::lower_bound(row.begin(), row.end(), j) - row.begin());
    const PackedBlock packed = pack(block(i, j, scale), j);
    blocks_.write(std::span<const PackedBlock>(&packed, 1),
                  rows_.place(static_cast<std::size_t>(i), k));
  }
  if (preconditioner_.bytes() == 0) return;
  for (const Index n : diagonals) write_preconditioner(n, scale);
}

void BlockMatrix::grip(std::span<const Index> gripped, std::span<const double> scale) {
  std::vector<Index> now(gripped.begin(), gripped.end()), others;
  std::ranges::sort(now);
  std::set_symmetric_difference(now.begin(), now.end(), gripped_.begin(), gripped_.end(),
                                std::back_inserter(others));
  gripped_ = std::move(now);
  if (preconditioner_.bytes() == 0) return;
  for (Index n = 0; n < problem_.node_count(); ++n) {
    bool other = false;
    for (int axis = 0; axis < 3; ++axis) {
      other = other || std::ranges::binary_search(others, problem_.dof(n, axis));
    }
    if (other) write_preconditioner(n, scale);
  }
}

void BlockMatrix::write_preconditioner(Index node, std::span<const double> scale) {
  const PackedInverse packed = pack_inverse(inverse_of_free(node, diagonal(node, scale)));
  preconditioner_.write(std::span<const PackedInverse>(&packed, 1), static_cast<std::size_t>(node));
}

std::size_t BlockMatrix::bytes() const {
  return blocks_.bytes() + slices_.bytes() + preconditioner_.bytes() + patches_.bytes();
}

}  // namespace sunder::gpu
