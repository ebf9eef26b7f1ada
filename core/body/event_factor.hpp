// SPDX-License-Identifier: Apache-2.0
// What an event takes out of the stiffness, as update vectors (method.md "Elasticity" 3).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::fem {

/// The update vectors of an event over the unknowns its elements touch: W has shape
/// (dofs.size() x 6 k) with sum of (1 - alpha) K_e = W W^T on those unknowns.
struct EventFactor {
  std::vector<Index> dofs;  ///< ascending
  Eigen::MatrixXd w;
};
[[nodiscard]] EventFactor event_factor(const Problem& problem, std::span<const Index> elements);

/// The same into vectors that keep their room: W row by row at a stride of at least 6 k, zero
/// beyond its columns. `w` is only ever made longer.
void event_factor(const Problem& problem, std::span<const Index> elements, Eigen::Index stride,
                  std::vector<Index>& dofs, std::vector<double>& w);

}  // namespace sunder::fem
