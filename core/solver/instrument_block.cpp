// SPDX-License-Identifier: Apache-2.0
#include "solver/instrument_block.hpp"

#include <algorithm>

#include "sunder/error.hpp"

namespace sunder::solver {

std::vector<double> anchors_of(const Problem& problem) {
  const auto gripped = problem.gripped_dofs();
  std::vector<double> anchors(gripped.size(), 0.0);
  for (Index d : problem.anchored_dofs()) {
    const auto g = std::lower_bound(gripped.begin(), gripped.end(), d) - gripped.begin();
    anchors[static_cast<std::size_t>(g)] = problem.anchor_stiffness();
  }
  return anchors;
}

InstrumentBlock::InstrumentBlock(const Problem& problem) : anchors_(anchors_of(problem)) {
  forces_ = std::make_shared<InstrumentForces>(anchors_);
  f_ = half_ = u_0_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(anchors_.size()));
}

std::span<const double> InstrumentBlock::anchors(std::size_t grips) {
  anchors_.resize(grips, 0.0);
  return anchors_;
}

void InstrumentBlock::publish(const Eigen::Ref<const Eigen::MatrixXd>& l,
                              std::span<const double> reactions,
                              std::span<const double> displacements) {
  const auto g = static_cast<Eigen::Index>(reactions.size());
  if (l.rows() != g) throw UsageError("a compliance of other grips than the reactions'");
  const Eigen::Map<const Eigen::VectorXd> r(reactions.data(), g), d(displacements.data(), g),
      anchors(this->anchors(reactions.size()).data(), g);
  f_ = r.array() + anchors.array() * d.array();  // anchors pull as well
  half_.noalias() = l.transpose().triangularView<Eigen::Upper>() * f_;
  u_0_ = d;
  u_0_.noalias() -= l.triangularView<Eigen::Lower>() * half_;
  forces_->publish(l, u_0_, displacements);
}

}  // namespace sunder::solver
