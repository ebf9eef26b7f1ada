// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/block_inversion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

constexpr Index kBlock = 60;  // columns swept at once: ten blocks of the low-rank update

/// L^-T of the pivot block L L^T.
Eigen::MatrixXd inverse_root(const Eigen::MatrixXd& pivot, Index first) {
  const Eigen::LLT<Eigen::MatrixXd> llt(pivot);
  if (llt.info() != Eigen::Success || !llt.matrixLLT().allFinite()) {
    throw NumericalError(
        "the stiffness is not positive definite in double precision: the inversion on the device "
        "stopped at unknown " +
        std::to_string(first));
  }
  const Index k = pivot.rows();
  return llt.matrixL().solve(Eigen::MatrixXd::Identity(k, k)).transpose();
}

/// Powers of two s that bring each diagonal entry s a s between 1/2 and 2: scaling rounds nothing,
/// and the shift by the unit matrix costs no digits however much stiffnesses differ.
std::vector<double> equilibration(const linear_algebra::SparseMatrix& lower) {
  std::vector<double> scales;
  for (Index d = 0; d < lower.rows(); ++d) {
    const double a = lower.coeff(d, d);
    scales.push_back(a > 0 ? std::exp2(-std::round(std::log2(a) / 2)) : 1);
  }
  return scales;
}

}  // namespace

std::size_t planned_inversion_bytes(const KernelFactory& stored, Index n, std::uint32_t rows,
                                    std::size_t panel_bytes) {
  const KernelFactory exact = stored.in_fp64();
  const auto block = static_cast<std::uint32_t>(std::min(kBlock, n));
  return (stored.fp64() ? 0 : DenseInverse::planned(exact, n, rows, panel_bytes).bytes) +
         DenseInverse::planned_pick(block, block) +
         DenseInverse::planned_update(exact, rows, block, block);
}

// With B = A - I and the columns k of a block, whose pivot is D = L L^T = B_kk + I, the update
// B -= Y Y^T with Y = B(:, k) L^-T leaves A - A_k D^-1 A_k^T outside the block, A_k D^-1 in its
// columns (and rows), and I - D^-1 where they meet: one step of Gauss-Jordan as a single low-rank
// update, B = I - A^-1 when all blocks are done.
void invert_on_device(const KernelFactory& kernels, const linear_algebra::SparseMatrix& lower,
                      std::uint32_t rows, std::size_t panel_bytes, DenseInverse& inverse) {
  const Index n = static_cast<Index>(lower.rows());
  const KernelFactory exact = kernels.in_fp64();
  std::optional<DenseInverse> beside;
  if (!inverse.fp64()) beside.emplace(exact, n, rows, panel_bytes);
  DenseInverse& swept = beside ? *beside : inverse;
  const std::vector<double> scales = equilibration(lower);
  const linear_algebra::SparseMatrix full = lower.selfadjointView<Eigen::Lower>();
  swept.upload([&](Index first, Index count) {
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(n, count);
    for (Index c = 0; c < count; ++c) {
      for (linear_algebra::SparseMatrix::InnerIterator it(full, first + c); it; ++it) {
        block(it.row(), c) = scales[static_cast<std::size_t>(it.row())] * it.value() *
                             scales[static_cast<std::size_t>(first + c)];
      }
      block(first + c, c) -= 1;
    }
    return block;
  });
  std::vector<Index> columns(static_cast<std::size_t>(kBlock));
  for (Index first = 0; first < n; first += kBlock) {
    columns.resize(static_cast<std::size_t>(std::min(kBlock, n - first)));
    std::iota(columns.begin(), columns.end(), first);
    Eigen::MatrixXd pivot = swept.pick(columns, columns);
    pivot.diagonal().array() += 1;
    swept.update(columns, inverse_root(pivot, first), -1);
  }
  inverse.take_complement(swept, scales);
}

}  // namespace sunder::gpu
