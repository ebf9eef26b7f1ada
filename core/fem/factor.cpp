// SPDX-License-Identifier: Apache-2.0
#include "fem/factor.hpp"

#include <algorithm>

#include "sunder/error.hpp"

namespace sunder::fem {
namespace {

// Right-hand sides are solved in row-major blocks of this width: each entry of L is then read once
// per block and the inner loop runs over consecutive doubles.
constexpr Index kBlock = 32;
using RowBlock = Eigen::Matrix<double, Eigen::Dynamic, kBlock, Eigen::RowMajor>;

/// Solves L L^T y = b in place; `first` is the first row of b that is not zero.
void solve_in_place(const SparseMatrix& l, Index first, RowBlock& b) {
  const Index n = static_cast<Index>(l.rows());
  const Index* outer = l.outerIndexPtr();
  const Index* inner = l.innerIndexPtr();
  const double* value = l.valuePtr();
  for (Index j = first; j < n; ++j) {  // the diagonal comes first in each column
    b.row(j) /= value[outer[j]];
    for (Index p = outer[j] + 1; p < outer[j + 1]; ++p) b.row(inner[p]) -= value[p] * b.row(j);
  }
  for (Index j = n - 1; j >= 0; --j) {
    for (Index p = outer[j] + 1; p < outer[j + 1]; ++p) b.row(j) -= value[p] * b.row(inner[p]);
    b.row(j) /= value[outer[j]];
  }
}

}  // namespace

Factor::Factor(const SparseMatrix& lower) {
  llt_.compute(lower);
  if (llt_.info() != Eigen::Success) {
    throw NumericalError(
        "the stiffness matrix is not positive definite in double precision: a part of the body "
        "hangs on a hinge, or stiffness contrast, Poisson's ratio or slivers are too extreme");
  }
}

Eigen::VectorXd Factor::solve(const Eigen::VectorXd& rhs) const { return llt_.solve(rhs); }

Eigen::MatrixXd Factor::inverse_columns(std::span<const Index> columns) const {
  const SparseMatrix& l = llt_.matrixL().nestedExpression();
  const Index n = static_cast<Index>(l.rows());
  const auto& permutation = llt_.permutationP().indices();  // row i of A is row P[i] of L
  Eigen::MatrixXd result(n, static_cast<Index>(columns.size()));
  RowBlock block(n, kBlock);
  for (std::size_t start = 0; start < columns.size(); start += kBlock) {
    const Index width = static_cast<Index>(std::min<std::size_t>(kBlock, columns.size() - start));
    block.setZero();
    Index first = n;
    for (Index c = 0; c < width; ++c) {
      const Index row = permutation.size() ? permutation[columns[start + c]] : columns[start + c];
      block(row, c) = 1;
      first = std::min(first, row);
    }
    solve_in_place(l, first, block);
    for (Index i = 0; i < n; ++i) {
      const Index row = permutation.size() ? permutation[i] : i;
      result.row(i).segment(static_cast<Index>(start), width) = block.row(row).head(width);
    }
  }
  return result;
}

Eigen::MatrixXd Factor::inverse() const {
  // In the factor's own order, so that the columns of a block share their leading zeros.
  const Index n = static_cast<Index>(llt_.matrixL().rows());
  const auto& permutation = llt_.permutationP().indices();
  std::vector<Index> order(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) order[permutation.size() ? permutation[i] : i] = i;
  const Eigen::MatrixXd columns = inverse_columns(order);
  Eigen::MatrixXd result(n, n);
  for (Index i = 0; i < n; ++i) result.col(order[i]) = columns.col(i);
  // Rounding leaves the two triangles apart in the last digits; the updates expect symmetry.
  result = ((result + result.transpose()) / 2).eval();
  return result;
}

std::size_t Factor::bytes() const {
  const auto& l = llt_.matrixL().nestedExpression();
  return static_cast<std::size_t>(l.nonZeros()) * (sizeof(double) + sizeof(Index)) +
         static_cast<std::size_t>(l.rows() + 1) * sizeof(Index);
}

}  // namespace sunder::fem
