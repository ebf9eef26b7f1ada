// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/block_matrix.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <set>

#include "fem/element.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

constexpr std::size_t kBlockDoubles = 12;  // three rows of four, the last unused

Index corner_of(const std::array<Index, 4>& tet, Index node) {
  return static_cast<Index>(std::find(tet.begin(), tet.end(), node) - tet.begin());
}

}  // namespace

BlockMatrix::BlockMatrix(const Problem& problem)
    : problem_(problem),
      groups_(round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup) /
              shaders::kGroup),
      scale_(problem.mesh().tets.size(), 1.0),
      elements_of_(problem.mesh().nodes.size()),
      neighbours_(problem.mesh().nodes.size()) {
  build_pattern();
}

std::size_t BlockMatrix::planned_bytes(bool preconditioner) const {
  const std::size_t rows = std::size_t{groups_} * shaders::kGroup;
  return columns_of_.size() * kBlockDoubles * sizeof(double) +
         vulkan::Buffer::padded(columns_of_.size() * sizeof(std::uint32_t)) +
         vulkan::Buffer::padded(first_.size() * sizeof(std::uint32_t)) +
         (preconditioner ? rows * kBlockDoubles * sizeof(double) : 0);
}

void BlockMatrix::upload(const KernelFactory& kernels, bool preconditioner_wanted) {
  const Problem& problem = problem_;
  std::vector<std::uint32_t> columns;
  columns.swap(columns_of_);
  const vulkan::PhysicalDevice& device = kernels.device().physical();
  const std::size_t bytes = columns.size() * kBlockDoubles * sizeof(double);
  const auto limit = std::min<std::size_t>(device.largest_buffer, device.largest_allocation);
  if (bytes > limit) {
    throw DeviceError("the stiffness needs a buffer of " + std::to_string(bytes) +
                      " bytes, but the device \"" + device.name + "\" takes buffers of " +
                      std::to_string(limit) + "; use backend cpu");
  }
  std::vector<double> blocks(columns.size() * kBlockDoubles, 0.0);
  std::vector<double> preconditioner(
      preconditioner_wanted ? std::size_t{groups_} * shaders::kGroup * kBlockDoubles : 0, 0.0);
  for (Index n = 0; n < problem.node_count(); ++n) {
    const auto row = static_cast<std::size_t>(n);
    for (std::size_t k = 0; k < neighbours_[row].size(); ++k) {
      const Mat3 value = block(n, neighbours_[row][k]);
      const std::size_t at =
          (first_[row / shaders::kGroup] + k) * shaders::kGroup + row % shaders::kGroup;
      pack(value, &blocks[at * kBlockDoubles]);
      if (preconditioner_wanted && neighbours_[row][k] == n) {
        pack(inverse_of_free(n, value), &preconditioner[row * kBlockDoubles]);
      }
    }
  }
  const auto upload = [&](vulkan::Buffer& buffer, auto& values) {
    buffer = vulkan::Buffer(kernels.device(), values.size() * sizeof(values[0]),
                            vulkan::Placement::device);
    buffer.write(std::span<const std::remove_reference_t<decltype(values[0])>>(values));
  };
  upload(blocks_, blocks);
  upload(columns_, columns);
  upload(slices_, first_);
  if (preconditioner_wanted) upload(preconditioner_, preconditioner);
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
  add_surroundings(all);
  for (std::size_t n = 0; n < neighbours_.size(); ++n) {
    neighbours_[n].assign(all[n].begin(), all[n].end());
  }
  first_.assign(groups_ + 1, 0);
  for (std::uint32_t slice = 0; slice < groups_; ++slice) {
    std::size_t width = 0;
    const std::size_t end =
        std::min<std::size_t>(std::size_t{slice + 1} * shaders::kGroup, neighbours_.size());
    for (std::size_t n = std::size_t{slice} * shaders::kGroup; n < end; ++n) {
      width = std::max(width, neighbours_[n].size());
    }
    first_[slice + 1] = first_[slice] + static_cast<std::uint32_t>(width);
  }
  columns_of_.assign(std::size_t{first_[groups_]} * shaders::kGroup, 0);  // padding: zero blocks
  for (std::size_t n = 0; n < neighbours_.size(); ++n) {
    for (std::size_t k = 0; k < neighbours_[n].size(); ++k) {
      columns_of_[(first_[n / shaders::kGroup] + k) * shaders::kGroup + n % shaders::kGroup] =
          static_cast<std::uint32_t>(neighbours_[n][k]);
    }
  }
}

void BlockMatrix::add_surroundings(std::vector<std::set<Index>>& all) {
  const Surroundings& around = problem_.surroundings();
  if (around.dofs.empty()) return;
  std::vector<Index> touched;
  around_.assign(all.size(), {kNone, kNone, kNone});
  for (Index n = 0; n < problem_.node_count(); ++n) {
    bool any = false;
    for (int axis = 0; axis < 3; ++axis) {
      const Index dof = problem_.dof(n, axis);
      const auto at = std::lower_bound(around.dofs.begin(), around.dofs.end(), dof);
      if (dof == kNone || at == around.dofs.end() || *at != dof) continue;
      around_[n][axis] = static_cast<Index>(at - around.dofs.begin());
      any = true;
    }
    if (any) touched.push_back(n);
  }
  for (Index n : touched) {
    all[n].insert(touched.begin(), touched.end());
    all[n].insert(problem_.node_count() - 1);  // the ground
  }
}

/// A block of the surroundings' stiffness; towards the ground what makes the row sum to zero.
Mat3 BlockMatrix::of_surroundings(Index row, Index column) const {
  const Eigen::MatrixXd& k = problem_.surroundings().stiffness;
  const bool ground = column == problem_.node_count() - 1;
  Mat3 value = Mat3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Index at = around_[row][i];
    if (at == kNone) continue;
    if (!ground) {
      for (int j = 0; j < 3; ++j) {
        if (around_[column][j] != kNone) value(i, j) = k(at, around_[column][j]);
      }
      continue;
    }
    for (Index n = 0; n < column; ++n) {
      for (int j = 0; j < 3; ++j) {
        if (around_[n][j] != kNone) value(i, j) -= k(at, around_[n][j]);
      }
    }
  }
  return value;
}

/// Sum of a_e V (lambda g_i g_j^T + mu g_j g_i^T + mu g_i.g_j I) over the elements of both nodes.
Mat3 BlockMatrix::block(Index row, Index column) const {
  Mat3 sum = around_.empty() ? Mat3(Mat3::Zero()) : of_surroundings(row, column);
  for (Index e : elements_of_[row]) {
    const auto& tet = problem_.mesh().tets[e];
    const Index j = corner_of(tet, column);
    if (j == 4) continue;
    const TetShape& shape = problem_.shape(e);
    const Material& m = problem_.material(e);
    const double mu = m.young / (2 * (1 + m.poisson));
    const double lambda = m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson));
    const Vec3 gi = shape.gradient.col(corner_of(tet, row)), gj = shape.gradient.col(j);
    sum += scale_[e] * shape.volume *
           (lambda * gi * gj.transpose() + mu * gj * gi.transpose() +
            mu * gi.dot(gj) * Mat3::Identity());
  }
  return sum;
}

void BlockMatrix::pack(const Mat3& block, double* to) const {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) to[4 * i + j] = block(i, j);
  }
}

/// Inverse of a diagonal block over the axes that neither a support nor a grip holds.
Mat3 BlockMatrix::inverse_of_free(Index node, const Mat3& diagonal) const {
  const auto gripped = problem_.gripped_dofs();
  Mat3 matrix = diagonal;
  std::array<bool, 3> held{};
  for (int axis = 0; axis < 3; ++axis) {
    const Index dof = problem_.dof(node, axis);
    held[axis] = dof == kNone || std::binary_search(gripped.begin(), gripped.end(), dof);
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

void BlockMatrix::destroy(std::span<const Index> elements) {
  std::set<std::pair<Index, Index>> touched;
  for (Index e : elements) {
    scale_[e] = problem_.scene().fracture.alpha;
    for (Index i : problem_.mesh().tets[e]) {
      for (Index j : problem_.mesh().tets[e]) touched.insert({i, j});
    }
  }
  std::array<double, kBlockDoubles> packed{};
  for (const auto& [i, j] : touched) {
    const Mat3 value = block(i, j);
    const auto& row = neighbours_[i];
    const auto k =
        static_cast<std::size_t>(std::lower_bound(row.begin(), row.end(), j) - row.begin());
    const auto n = static_cast<std::size_t>(i);
    pack(value, packed.data());
    blocks_.write(std::span<const double>(packed),
                  ((first_[n / shaders::kGroup] + k) * shaders::kGroup + n % shaders::kGroup) *
                      kBlockDoubles);
    if (i != j || preconditioner_.bytes() == 0) continue;
    pack(inverse_of_free(i, value), packed.data());
    preconditioner_.write(std::span<const double>(packed), n * kBlockDoubles);
  }
}

std::size_t BlockMatrix::bytes() const {
  return blocks_.bytes() + columns_.bytes() + slices_.bytes() + preconditioner_.bytes();
}

}  // namespace sunder::gpu
