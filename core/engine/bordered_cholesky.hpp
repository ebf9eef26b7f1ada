// SPDX-License-Identifier: Apache-2.0
// Cholesky factor of a small symmetric matrix that grows by rows and columns and shrinks again.
#pragma once

#include <Eigen/Core>

namespace sunder::engine {

class BorderedCholesky {
 public:
  /// Grows S to [S B; B^T D]; B has shape (size() x k), D (k x k), lower triangle read. Returns
  /// false and changes nothing when the grown matrix is not positive definite in double
  /// precision. Cost k size()^2 flops.
  [[nodiscard]] bool append(const Eigen::MatrixXd& border, const Eigen::MatrixXd& block);
  /// Back to an earlier size; the factor is then the earlier one bit by bit.
  void shrink(Eigen::Index size) { size_ = size; }

  [[nodiscard]] Eigen::Index size() const { return size_; }
  /// x <- L^-1 x and x <- L^-T x with S = L L^T.
  void solve_lower(Eigen::Ref<Eigen::MatrixXd> x) const;
  void solve_upper(Eigen::Ref<Eigen::MatrixXd> x) const;
  /// The same for x that rows were appended to together with S: its first `solved` rows are L^-1 x
  /// already and stay as they are.
  void solve_lower_from(Eigen::Index solved, Eigen::Ref<Eigen::MatrixXd> x) const;
  [[nodiscard]] std::size_t bytes() const {
    return static_cast<std::size_t>(l_.size()) * sizeof(double);
  }

 private:
  Eigen::MatrixXd l_;  // leading size_ x size_ is L; the rest is room to grow
  Eigen::Index size_ = 0;
};

}  // namespace sunder::engine
