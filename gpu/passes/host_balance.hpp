// SPDX-License-Identifier: Apache-2.0
// f - K u on the host in fp64, for devices without shaderFloat64: what the residual pass does on
// others.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::gpu {

class HostBalance {
 public:
  explicit HostBalance(const Problem& problem);

  /// These are gripped from now on: those of the problem at first.
  void grip(std::span<const Index> gripped) { gripped_.assign(gripped.begin(), gripped.end()); }
  /// Over the unknowns.
  void set_load(std::span<const double> force);
  /// a_e of the elements from now on, which stay where they are; empty: intact.
  void scale_by(std::span<const double> scale) { scale_ = scale; }

  /// `displacement`: shape (3 * nodes).
  void compute(std::span<const double> displacement);

  /// f - K u over the unknowns; r is the same but 0 at gripped ones.
  [[nodiscard]] const Eigen::VectorXd& balance() const { return balance_; }
  [[nodiscard]] const Eigen::VectorXd& residual() const { return residual_; }
  // Sums as in shaders::NodePartial.
  [[nodiscard]] double residual_squared() const { return residual_.squaredNorm(); }
  [[nodiscard]] double reaction_squared() const { return (balance_ - residual_).squaredNorm(); }
  [[nodiscard]] double largest_u() const { return largest_u_; }

 private:
  const Problem& problem_;
  std::span<const double> scale_;
  std::vector<Index> gripped_;
  std::vector<double> k_u_;  // K u at all nodes
  Eigen::VectorXd load_, balance_, residual_;
  double largest_u_ = 0;
};

}  // namespace sunder::gpu
