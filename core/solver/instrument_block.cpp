// SPDX-License-Identifier: Apache-2.0
#include "solver/instrument_block.hpp"

#include <algorithm>

#include "sunder/error.hpp"

namespace sunder::solver {

std::span<const double> Anchors::of(std::span<const Index> gripped) {
  if (stiffness_.size() == gripped.size() && std::ranges::equal(gripped, gripped_)) {
    return stiffness_;
  }
  gripped_.assign(gripped.begin(), gripped.end());
  stiffness_.assign(gripped.size(), 0.0);
  for (Index d : problem_.anchored_dofs()) {
    const auto g = std::ranges::find(gripped_, d) - gripped_.begin();
    if (g < static_cast<std::ptrdiff_t>(gripped_.size())) {
      stiffness_[static_cast<std::size_t>(g)] = problem_.anchor_stiffness();
    }
  }
  return stiffness_;
}

InstrumentBlock::InstrumentBlock(const Problem& problem) : anchors_(problem) {
  const auto gripped = problem.gripped_dofs();
  forces_ = std::make_shared<InstrumentForces>(anchors_.of(gripped));
  f_ = half_ = u_0_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(gripped.size()));
}

void InstrumentBlock::publish(std::span<const Index> gripped,
                              const Eigen::Ref<const Eigen::MatrixXd>& l,
                              std::span<const double> reactions,
                              std::span<const double> displacements) {
  const auto g = static_cast<Eigen::Index>(reactions.size());
  if (l.rows() != g || gripped.size() != reactions.size())
    throw UsageError("a compliance of other grips than the reactions'");
  const Eigen::Map<const Eigen::VectorXd> r(reactions.data(), g), d(displacements.data(), g),
      anchors(this->anchors(gripped).data(), g);
  f_ = r.array() + anchors.array() * d.array();  // anchors pull as well
  half_.noalias() = l.transpose().triangularView<Eigen::Upper>() * f_;
  u_0_ = d;
  u_0_.noalias() -= l.triangularView<Eigen::Lower>() * half_;
  forces_->publish(l, u_0_, displacements);
}

}  // namespace sunder::solver
