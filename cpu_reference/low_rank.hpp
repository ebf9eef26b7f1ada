// SPDX-License-Identifier: Apache-2.0
// Eager low-rank update of a dense inverse (method.md "Elasticity" 3).
#pragma once

#include <Eigen/Core>
#include <span>

#include "sunder/problem.hpp"

namespace sunder::cpu_reference {

/// The update vectors of an event over the unknowns its elements touch: W has shape
/// (dofs.size() x 6 k) with sum of (1 - alpha) K_e = W W^T on those unknowns.
struct EventFactor {
  std::vector<Index> dofs;  ///< ascending
  Eigen::MatrixXd w;
};
[[nodiscard]] EventFactor event_factor(const Problem& problem, std::span<const Index> elements);

/// X <- X + Z Z^T with Z = X W L^-T, L L^T = C = I - W^T X W: the inverse after the event. Returns
/// false and leaves X alone when C is not positive definite in double precision. Cost 12 k n^2
/// flops.
[[nodiscard]] bool update_inverse(const EventFactor& event, Eigen::MatrixXd& x);

}  // namespace sunder::cpu_reference
