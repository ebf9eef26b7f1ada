// SPDX-License-Identifier: Apache-2.0
#include "solver/whole_solution.hpp"

namespace sunder::solver {

void WholeRoom::reserve(Index unknowns, std::size_t touched) {
  right_side.resize(unknowns);
  lost.reserve(touched);
  work.below.reserve(static_cast<std::size_t>(unknowns));
  work.permuted.resize(unknowns);
}

std::size_t WholeRoom::bytes() const {
  return sizeof(double) * (static_cast<std::size_t>(right_side.size() + work.permuted.size()) +
                           lost.capacity() + work.below.capacity());
}

void solve_whole(const Equilibrium& of, WholeRoom& room, Eigen::VectorXd& u) {
  Eigen::VectorXd& right_side = room.right_side;
  right_side.setZero(of.factor->cholesky().size());
  for (std::size_t i = 0; i < of.dofs.size(); ++i) right_side[of.dofs[i]] += of.forces[i];
  if (of.lost) {
    room.lost.resize(of.lost_u.size());
    of.lost->multiply(of.lost_u, room.lost);
    const auto dofs = of.lost->dofs();
    for (std::size_t i = 0; i < dofs.size(); ++i) right_side[dofs[i]] += room.lost[i];
  }
  of.factor->solve(right_side, u, room.work);
}

}  // namespace sunder::solver
