// SPDX-License-Identifier: Apache-2.0
// The solution of a condensed base at all unknowns, by one solve with its factor.
#pragma once

#include <vector>

#include "solver/condensed_base.hpp"

namespace sunder::solver {

/// What solve_whole() works in.
struct WholeRoom {
  /// For a body of so many unknowns, some of them touched.
  void reserve(Index unknowns, std::size_t touched);
  [[nodiscard]] std::size_t bytes() const;
  Eigen::VectorXd right_side;
  std::vector<double> lost;
  linear_algebra::SolveWork work;
};
/// u at all unknowns.
void solve_whole(const Equilibrium& of, WholeRoom& room, Eigen::VectorXd& u);

}  // namespace sunder::solver
