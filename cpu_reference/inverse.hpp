// SPDX-License-Identifier: Apache-2.0
// The intact stiffness's factor and its dense inverse (method.md "Elasticity" 1; the paper's
// prepared inverse).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>

#include "fem/assembly.hpp"

namespace sunder::cpu_reference {

/// Sparse Cholesky factor of a symmetric positive definite matrix given by its lower triangle.
class Factor {
 public:
  /// Throws NumericalError when the matrix is not positive definite in double precision.
  explicit Factor(const fem::SparseMatrix& lower);

  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const;
  /// Inverse as a dense matrix, shape (n x n). Cost 2 n nnz(L) multiply-adds.
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  /// Some columns of the inverse, shape (n x columns).
  [[nodiscard]] Eigen::MatrixXd inverse_columns(std::span<const Index> columns) const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  Eigen::SimplicialLLT<fem::SparseMatrix, Eigen::Lower> llt_;
};

}  // namespace sunder::cpu_reference
