// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/host_balance.hpp"

#include <algorithm>
#include <cmath>

#include "body/assembly.hpp"

namespace sunder::gpu {

HostBalance::HostBalance(const Problem& problem)
    : problem_(problem),
      k_u_(3 * problem.mesh().nodes.size()),
      load_(Eigen::VectorXd::Zero(problem.dof_count())),
      balance_(load_),
      residual_(load_) {
  grip(problem.gripped_dofs());
}

void HostBalance::set_load(std::span<const double> force) {
  load_ = Eigen::Map<const Eigen::VectorXd>(force.data(), problem_.dof_count());
}

void HostBalance::compute(std::span<const double> displacement) {
  fem::apply_stiffness(problem_, scale_, displacement, k_u_);
  largest_u_ = 0;
  for (double u : displacement) largest_u_ = std::max(largest_u_, std::abs(u));
  for (Index n = 0; n < problem_.node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index dof = problem_.dof(n, axis);
      if (dof != kNone) balance_[dof] = load_[dof] - k_u_[3 * static_cast<std::size_t>(n) + axis];
    }
  }
  residual_ = balance_;
  for (Index g : gripped_) residual_[g] = 0;
}

}  // namespace sunder::gpu
