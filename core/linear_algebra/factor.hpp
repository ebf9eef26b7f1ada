// SPDX-License-Identifier: Apache-2.0
// Sparse Cholesky factor, and dense inverses from it (the paper's prepared inverse, method.md
// "Elasticity" 1). Host side, double precision.
#pragma once

#include <Eigen/Core>
#include <span>
#include <stdexcept>

#include "linear_algebra/supernodal_cholesky.hpp"

namespace sunder::linear_algebra {

/// A factor was given up because FactorWork::stop asked for it.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("the factor was given up") {}
};

/// Sparse Cholesky factor of a symmetric positive definite matrix given by its lower triangle.
class Factor {
 public:
  /// Throws NumericalError when the matrix is not positive definite in double precision.
  explicit Factor(const SparseMatrix& lower);
  /// Unknown i becomes row place[i]. Throws Stopped when the work was given up.
  Factor(const SparseMatrix& lower, std::vector<Index> place, const FactorWork& work = {});
  /// Of a matrix given in the order of `nodes`.
  Factor(std::shared_ptr<const Supernodes> nodes, const SparseMatrix& ordered,
         const FactorWork& work = {});

  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const;
  /// The same into x, which is another vector than rhs; allocates only until `work` has grown.
  void solve(const Eigen::VectorXd& rhs, Eigen::VectorXd& x, SolveWork& work) const;
  /// The same of several right sides, shape (n x columns), which become their solutions.
  void solve(Eigen::Ref<Eigen::MatrixXd> columns, RowMajor& room, SolveWork& work) const;
  /// Inverse as a dense matrix, shape (n x n). Cost at most 2 n nnz(L) multiply-adds. This and what
  /// follows take a block of right sides, n x 64, for each thread, and throw Stopped where the work
  /// was given up.
  [[nodiscard]] Eigen::MatrixXd inverse(const FactorWork& work = {}) const;
  /// Some columns of the inverse, shape (n x columns).
  [[nodiscard]] Eigen::MatrixXd inverse_columns(std::span<const Index> columns,
                                                const FactorWork& work = {}) const;
  /// Some columns of the inverse at some rows, shape (rows x columns). An entry has the same bits
  /// whatever others it is computed with.
  [[nodiscard]] Eigen::MatrixXd inverse_block(std::span<const Index> rows,
                                              std::span<const Index> columns,
                                              const FactorWork& work = {}) const;
  /// Entries of L: a triangular solve reads each once.
  [[nodiscard]] std::size_t entries() const { return cholesky_.entries(); }
  /// Entries of L that a solution with forces on some unknowns reads on its way forward.
  [[nodiscard]] std::size_t path_entries(std::span<const Index> dofs) const;
  [[nodiscard]] std::size_t bytes() const { return cholesky_.bytes(); }
  [[nodiscard]] const SupernodalCholesky& cholesky() const { return cholesky_; }

 private:
  struct Room;
  void check() const;
  template <class Body>
  void each_block(Index columns, const FactorWork& work, Body&& body) const;

  SupernodalCholesky cholesky_;
};

}  // namespace sunder::linear_algebra
