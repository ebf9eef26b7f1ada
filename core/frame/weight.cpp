// SPDX-License-Identifier: Apache-2.0
#include "frame/weight.hpp"

#include <algorithm>

#include "body/lumped_mass.hpp"

namespace sunder {

Weight::Weight(const Problem& problem)
    : problem_(problem),
      gravity_(problem.scene().gravity),
      mass_(fem::lumped_masses(problem)),
      weighs_(mass_.size(), 1),
      gripped_(problem.gripped_dofs().begin(), problem.gripped_dofs().end()),
      search_(problem) {
  collect(intact_);
  present_ = intact_;
  for (Load* load : {&present_, &sum_}) {
    load->force_dofs.reserve(static_cast<std::size_t>(problem.dof_count()));
    load->forces.reserve(static_cast<std::size_t>(problem.dof_count()));
  }
}

void Weight::hold(std::span<const Index> unknowns, std::span<const Index> nodes) {
  if (!std::ranges::equal(unknowns, gripped_)) {
    gripped_.assign(unknowns.begin(), unknowns.end());
    const auto weighs = weighs_;
    std::ranges::fill(weighs_, std::uint8_t{1});
    collect(intact_);
    weighs_ = weighs;
    collect(present_);
  }
  if (search_.hold(unknowns, nodes)) destroyed_ = -1;
}

void Weight::look(std::span<const std::uint8_t> destroyed) {
  const auto count = std::count(destroyed.begin(), destroyed.end(), std::uint8_t{1});
  if (count == destroyed_) return;
  destroyed_ = count;
  search_.look(destroyed);
  for (Index n = 0; n < problem_.node_count(); ++n) weighs_[n] = search_.isolated(n) ? 0 : 1;
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (destroyed[e] || search_.piece_of(e) == kNone) continue;
    for (Index n : problem_.mesh().tets[e]) weighs_[n] = 0;
  }
  collect(present_);
}

/// Forces of unknowns that no grip drives.
void Weight::collect(Load& weight) const {
  weight.force_dofs.clear();
  weight.forces.clear();
  for (Index n = 0; n < problem_.node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      const double force = of(n, axis);
      if (d == kNone || force == 0 || std::ranges::binary_search(gripped_, d)) continue;
      weight.force_dofs.push_back(d);
      weight.forces.push_back(force);
    }
  }
}

void Weight::add(const Load& weight, Load& load) {
  sum_.force_dofs.clear();
  sum_.forces.clear();
  const auto push = [this](Index dof, double force) {
    if (!sum_.force_dofs.empty() && sum_.force_dofs.back() == dof) {
      sum_.forces.back() += force;
    } else {
      sum_.force_dofs.push_back(dof);
      sum_.forces.push_back(force);
    }
  };
  std::size_t i = 0;
  for (std::size_t w = 0; w < weight.forces.size(); ++w) {
    for (; i < load.forces.size() && load.force_dofs[i] <= weight.force_dofs[w]; ++i) {
      push(load.force_dofs[i], load.forces[i]);
    }
    push(weight.force_dofs[w], weight.forces[w]);
  }
  for (; i < load.forces.size(); ++i) push(load.force_dofs[i], load.forces[i]);
  std::swap(load.force_dofs, sum_.force_dofs);
  std::swap(load.forces, sum_.forces);
}

}  // namespace sunder
