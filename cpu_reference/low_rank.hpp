// SPDX-License-Identifier: Apache-2.0
// Eager low-rank update of a dense inverse (method.md "Elasticity" 3).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "body/event_factor.hpp"

namespace sunder::cpu_reference {

/// X <- X + Z Z^T with Z = X W L^-T, L L^T = C = I - W^T X W: the inverse after an event. It keeps
/// its room: events of up to kElements elements allocate nothing.
class InverseUpdate {
 public:
  static constexpr std::size_t kElements = 40;

  /// Room for an inverse of so many unknowns. The system gives the memory where it is used.
  explicit InverseUpdate(Eigen::Index unknowns);

  /// Takes up an event.
  void gather(const Problem& problem, std::span<const Index> elements);
  /// Updates X by the event taken up. Returns false and leaves X alone when C is not positive
  /// definite in double precision. Cost 12 k n^2 flops.
  [[nodiscard]] bool apply(Eigen::MatrixXd& x);
  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] bool factor_c(Eigen::Index stride);
  void add_product(Eigen::Index stride, Eigen::MatrixXd& x);

  std::vector<Index> dofs_;
  Eigen::Index rank_ = 0, width_ = 0;  // columns of W; the same in full vectors
  std::vector<double> w_;              // row by row
  std::vector<double> columns_, z_;    // columns of X, then Z^T: row by row
  std::vector<double> at_event_, c_;   // (X W) on the event's unknowns; C, then L
  std::vector<double> product_;        // of lower_solve() and some columns of Z Z^T
};

}  // namespace sunder::cpu_reference
