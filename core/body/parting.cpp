// SPDX-License-Identifier: Apache-2.0
#include "body/parting.hpp"

namespace sunder::fem {

Parting::Parting(const Problem& before, const Problem& after)
    : before_(before),
      after_(after),
      from_(after.mesh().nodes.size() - before.mesh().nodes.size(), kNone) {
  for (Index e = 0; e < after.tet_count(); ++e) {
    const auto& was = before.mesh().tets[static_cast<std::size_t>(e)];
    const auto& is = after.mesh().tets[static_cast<std::size_t>(e)];
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const Index added = is[corner] - before.node_count();
      if (added >= 0) from_[static_cast<std::size_t>(added)] = was[corner];
    }
  }
}

void Parting::nodal(std::vector<double>& of) const {
  if (of.empty()) return;
  of.reserve(3 * after_.mesh().nodes.size());
  for (const Index from : from_) {
    for (Index axis = 0; axis < 3; ++axis) {
      of.push_back(from == kNone ? 0.0 : of[static_cast<std::size_t>(3 * from + axis)]);
    }
  }
}

void Parting::forces(Eigen::VectorXd& of) const {
  of.conservativeResize(after_.dof_count());
  of.tail(after_.dof_count() - before_.dof_count()).setZero();
}

void add_parted_grips(const Problem& parted, std::vector<double>& of) {
  const auto grips = parted.gripped_dofs().size(), whole = grips - parted.parted_grips().size();
  for (std::size_t i = of.size() - whole; i < parted.parted_grips().size(); ++i) {
    of.push_back(of[static_cast<std::size_t>(parted.parted_grips()[i])]);
  }
}

}  // namespace sunder::fem
