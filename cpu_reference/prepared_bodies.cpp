// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/prepared_bodies.hpp"

#include <algorithm>

#include "cpu_reference/intact_body.hpp"
#include "solver/inverse_base.hpp"
#include "sunder/same_stiffness.hpp"

namespace sunder::cpu_reference {

std::shared_ptr<const fem::Analysis> PreparedBody::analysis() {
  const std::lock_guard lock(mutex_);
  if (!analysis_) analysis_ = fem::analyse(*problem_);
  return analysis_;
}

std::shared_ptr<const linear_algebra::Factor> PreparedBody::factor() {
  const auto analysed = analysis();
  const std::lock_guard lock(mutex_);
  if (!factor_) factor_ = factor_of(*analysed);
  return factor_;
}

std::shared_ptr<const Eigen::MatrixXd> PreparedBody::inverse() {
  const auto factored = factor();
  const std::lock_guard lock(mutex_);
  if (!inverse_) {
    inverse_ = std::make_shared<const Eigen::MatrixXd>(solver::InverseBase::inverse_of(*factored));
  }
  return inverse_;
}

std::shared_ptr<PreparedBody> PreparedBodies::of(const std::shared_ptr<const Problem>& problem) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(
      bodies_, [&](const auto& body) { return same_stiffness(body->problem(), *problem); });
  if (found != bodies_.end()) {
    bodies_.splice(bodies_.begin(), bodies_, found);
  } else {
    bodies_.push_front(std::make_shared<PreparedBody>(problem));
    if (bodies_.size() > most_) bodies_.pop_back();
  }
  return bodies_.front();
}

}  // namespace sunder::cpu_reference
