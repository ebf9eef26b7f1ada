// SPDX-License-Identifier: Apache-2.0
#include "solver/host_steps.hpp"

#include <utility>

namespace sunder::solver {
namespace {

FinitePoint point_of(const FiniteState& state) {
  return {state.potential, state.r.norm(), state.acting};
}

}  // namespace

FinitePoint HostSteps::begin(const FiniteTarget& target, FiniteBase* base, FiniteState& state) {
  hessian_.clear();
  target_ = &target;
  base_ = base;
  state_ = &state;
  return point_of(state);
}

FiniteTrial HostSteps::whole(bool with_stress) {
  hessian_.direction(
      state_->r,
      [&](const Eigen::VectorXd& q, Eigen::VectorXd& x) {
        base_->solve(q, x);
        if (target_->viscous > 0) x /= 1 + target_->viscous;  // the tangent of viscous forces
        potential_.hold(x);
      },
      du_);
  return trial(1, with_stress);
}

FiniteTrial HostSteps::part(double of, bool with_stress) { return trial(of, with_stress); }

FiniteTrial HostSteps::trial(double part, bool with_stress) {
  potential_.move(state_->u, part, du_, next_.u);
  potential_.evaluate(*target_, with_stress, next_);
  potential_.difference(next_.u, state_->u, s_);
  y_ = next_.r - state_->r;
  FiniteTrial of{point_of(next_), state_->r.dot(du_), s_.dot(y_)};
  if (with_stress) {
    potential_.complete(*state_);
    const auto [change, largest] = potential_.stress_change(next_.stress, state_->stress);
    of.change = change;
    of.largest = largest;
  }
  return of;
}

void HostSteps::take() {
  hessian_.learn(s_, y_);
  std::swap(*state_, next_);
}

}  // namespace sunder::solver
