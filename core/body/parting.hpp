// SPDX-License-Identifier: Apache-2.0
// What the vectors of a body become where nodes part (parted_problem()): what a new node has is
// what the node had that it parts from.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::fem {

class Parting {
 public:
  /// Both are the same body, `after` with some more nodes; both must outlive it.
  Parting(const Problem& before, const Problem& after);

  /// (3 * nodes)
  void nodal(std::vector<double>& of) const;
  /// Forces on unknowns: new ones have none.
  void forces(Eigen::VectorXd& of) const;

 private:
  const Problem &before_, &after_;
  std::vector<Index> from_;  // of each new node
};

/// Of gripped dofs, where `of` has those of the body's own: nodes that have parted go with them.
void add_parted_grips(const Problem& parted, std::vector<double>& of);

}  // namespace sunder::fem
