// SPDX-License-Identifier: Apache-2.0
// Exact columns of an inverse on the host: from the dense inverse when that is kept and small, else
// from the factor.
#pragma once

#include <Eigen/Core>
#include <span>

#include "fem/factor.hpp"
#include "gpu/passes/dense_inverse.hpp"

namespace sunder::gpu {

class HostInverse {
 public:
  /// Of a body's stiffness, elements scaled as in assemble_lower.
  HostInverse(const Problem& problem, std::span<const double> scale, bool keep_dense);
  [[nodiscard]] Eigen::MatrixXd columns(std::span<const Index> dofs) const;
  [[nodiscard]] Eigen::MatrixXd range(Index first, Index count) const;
  /// Of the diagonal; a dense inverse only.
  [[nodiscard]] std::vector<double> roots() const;
  [[nodiscard]] bool is_dense() const { return dense_.size() > 0; }
  [[nodiscard]] const fem::Factor& factor() const { return factor_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  fem::Factor factor_;
  Eigen::MatrixXd dense_;  // empty: too large
};

/// Fills `device` with it, in storage precision; returns the roots of its diagonal in fp64, for `n`
/// unknowns.
[[nodiscard]] std::vector<double> upload_inverse(const HostInverse& host, DenseInverse& device,
                                                 Index n);

}  // namespace sunder::gpu
