// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/block_inversion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

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

/// The largest diagonal entry, which the scaled matrix has as 1: the shift by the unit matrix below
/// then costs no digits.
double largest_diagonal(const linear_algebra::SparseMatrix& lower) {
  double largest = 0;
  for (Index d = 0; d < lower.rows(); ++d) largest = std::max(largest, lower.coeff(d, d));
  return largest;
}

}  // namespace

std::size_t planned_inversion_bytes(const KernelFactory& kernels, Index n, std::uint32_t rows,
                                    std::size_t panel_bytes) {
  const KernelFactory exact = kernels.in_fp64();
  const auto block = static_cast<std::uint32_t>(std::min(kBlock, n));
  return DenseInverse::planned(exact, n, rows, panel_bytes).bytes +
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
  DenseInverse swept(exact, n, rows, panel_bytes);
  const double scale = 1 / largest_diagonal(lower);
  const linear_algebra::SparseMatrix full = lower.selfadjointView<Eigen::Lower>();
  swept.upload([&](Index first, Index count) {
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(n, count);
    for (Index c = 0; c < count; ++c) {
      for (linear_algebra::SparseMatrix::InnerIterator it(full, first + c); it; ++it) {
        block(it.row(), c) = scale * it.value();
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
  inverse.take_complement(swept, scale);
}

}  // namespace sunder::gpu
