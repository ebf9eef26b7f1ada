// SPDX-License-Identifier: Apache-2.0
// Exact columns of an inverse on the host: from the dense inverse when that is kept and small, else
// from the factor.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "gpu/passes/dense_inverse.hpp"
#include "linear_algebra/factor.hpp"

namespace sunder::gpu {

class HostInverse {
 public:
  /// Of the intact body's stiffness.
  HostInverse(const Problem& problem, bool keep_dense);
  /// By a factor. Throws linear_algebra::Stopped when the work was given up.
  HostInverse(std::shared_ptr<const linear_algebra::Factor> factor, bool keep_dense,
              const linear_algebra::FactorWork& work);
  [[nodiscard]] Eigen::MatrixXd columns(std::span<const Index> dofs) const;
  [[nodiscard]] Eigen::MatrixXd range(Index first, Index count) const;
  [[nodiscard]] bool is_dense() const { return dense_.size() > 0; }
  /// Empty where it is not kept.
  [[nodiscard]] const Eigen::MatrixXd& dense() const { return dense_; }
  [[nodiscard]] const linear_algebra::Factor& factor() const { return *factor_; }
  [[nodiscard]] std::size_t bytes() const;
  /// Right sides that it and all later factors of the body have solved for so far.
  [[nodiscard]] std::size_t solved() const { return factor_->cholesky().supernodes().solved.get(); }

 private:
  std::shared_ptr<const linear_algebra::Factor> factor_;
  Eigen::MatrixXd dense_;  // empty: too large
};

/// Fills `device` with it, in storage precision.
void upload_inverse(const HostInverse& host, DenseInverse& device);

}  // namespace sunder::gpu
