// SPDX-License-Identifier: Apache-2.0
#include "solver/instrument_block.hpp"

#include <algorithm>

namespace sunder::solver {

std::vector<double> anchors_of(const Problem& problem) {
  const auto gripped = problem.gripped_dofs();
  std::vector<double> anchors(gripped.size(), 0.0);
  for (Index d : problem.anchored_dofs()) {
    const auto g = std::lower_bound(gripped.begin(), gripped.end(), d) - gripped.begin();
    anchors[static_cast<std::size_t>(g)] = problem.anchor_stiffness();
  }
  if (problem.own_grips().empty()) return anchors;
  std::vector<double> own;
  for (Index place : problem.own_grips()) own.push_back(anchors[static_cast<std::size_t>(place)]);
  return own;
}

InstrumentBlock::InstrumentBlock(const Problem& problem) {
  const std::vector<double> anchors = anchors_of(problem);
  forces_ = std::make_shared<InstrumentForces>(anchors);
  anchors_ = Eigen::Map<const Eigen::VectorXd>(anchors.data(), static_cast<Index>(anchors.size()));
  f_ = half_ = u_0_ = Eigen::VectorXd::Zero(anchors_.size());
}

void InstrumentBlock::publish(const Eigen::Ref<const Eigen::MatrixXd>& l,
                              std::span<const double> reactions,
                              std::span<const double> displacements) {
  const Index g = static_cast<Index>(anchors_.size());
  const Eigen::Map<const Eigen::VectorXd> r(reactions.data(), g), d(displacements.data(), g);
  f_ = r.array() + anchors_.array() * d.array();  // anchors pull as well
  half_.noalias() = l.transpose().triangularView<Eigen::Upper>() * f_;
  u_0_ = d;
  u_0_.noalias() -= l.triangularView<Eigen::Lower>() * half_;
  forces_->publish(l, u_0_);
}

}  // namespace sunder::solver
