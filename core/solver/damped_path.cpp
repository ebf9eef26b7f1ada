// SPDX-License-Identifier: Apache-2.0
#include "solver/damped_path.hpp"

#include <algorithm>
#include <cmath>

#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

// Of the median stiffness of an unknown: mass over dt squared in the first step.
constexpr double kFirstInertia = 0.01;
constexpr int kEasy = 8;          // back-solves of a step after which the next may be longer
constexpr int kMostPerStep = 15;  // back-solves on one base
constexpr double kLonger = 1.5, kShorter = 0.5;
constexpr int kMostShortenings = 12;
constexpr double kStepResidual = 1e-3;
// A base of another inertia than the step's: over this ratio it leads nowhere.
constexpr double kAlikeInertia = 6;

double median_stiffness(const RestingBody& body, const std::vector<double>& u,
                        const fem::TangentPattern& pattern) {
  const Eigen::VectorXd diagonal =
      pattern.diagonal(pattern.tangent(body.body(), u, fem::Tangent::projected));
  std::vector<double> of;
  for (Index d = 0; d < diagonal.size(); ++d) {
    if (!body.frozen()[d] && diagonal[d] > 0) of.push_back(diagonal[d]);
  }
  if (of.empty()) return 1;
  std::ranges::nth_element(of, of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2));
  return of[of.size() / 2];
}

}  // namespace

void DampedPath::begin(const std::vector<double>& u) {
  running_ = true;
  paused_ = false;
  steps_ = 0;
  kinetic_ = 0;
  dt_ = 1;
  inertia_ = kFirstInertia * median_stiffness(potential_.resting(), u, pattern_.get());
  velocity_.setZero(potential_.problem().dof_count());
  state_.u = u;
  base_.reset();
}

bool DampedPath::renew(Cost& cost) {
  ++cost.factors;
  try {
    base_ =
        std::make_unique<FiniteBase>(potential_.resting().body(), state_.u, fem::Tangent::projected,
                                     pattern_.get(), fem::Inertia{inertia_ / (dt_ * dt_)});
  } catch (const NumericalError&) {
    base_.reset();
  }
  return base_ != nullptr;
}

/// Of the present dt; false: the iteration stalls.
bool DampedPath::try_step(const FiniteTarget& target, Cost& cost) {
  const double inertia = inertia_ / (dt_ * dt_);
  const bool other = base_ && !(base_->inertia() < kAlikeInertia * inertia &&
                                inertia < kAlikeInertia * base_->inertia());
  const bool fresh = !base_ || other;
  if (fresh && !renew(cost)) return false;
  potential_.move(state_.u, dt_, velocity_, ahead_);
  FiniteTarget moving = target;
  moving.inertia = {inertia};
  moving.ahead = &ahead_;
  for (const std::vector<double>& start : {ahead_, state_.u}) {
    next_.u = start;
    potential_.put_grips(target, next_.u);
    potential_.evaluate(moving, false, next_);
    if (std::isfinite(next_.potential)) break;
  }
  if (!std::isfinite(next_.potential)) return false;
  const double before = next_.potential;
  for (bool again = !fresh;; again = false) {
    const auto result =
        minimiser_.minimise(moving, base_.get(), {0, kStepResidual}, kMostPerStep, next_);
    cost.back_solves += result.back_solves;
    easy_ = result.at_rest && result.back_solves <= kEasy;
    hard_ = !result.at_rest;
    if (result.at_rest) return true;
    // An inexact step will do as long as it leads downhill: only the path's end counts.
    if (!again) return next_.potential < before;
    if (!renew(cost)) return false;
  }
}

bool DampedPath::step(const FiniteTarget& target, Cost& cost) {
  for (int i = 0; i < kMostShortenings; ++i) {
    if (try_step(target, cost)) {
      take();
      potential_.evaluate(target, false, state_);
      return true;
    }
    base_.reset();
    dt_ *= kShorter;
  }
  return false;
}

/// The step's end is the next one's begin.
void DampedPath::take() {
  ++steps_;
  potential_.difference(next_.u, state_.u, moved_);
  potential_.hold(moved_);
  velocity_ = moved_ / dt_;
  const double kinetic = velocity_.squaredNorm();
  paused_ = kinetic < kinetic_;
  kinetic_ = paused_ ? 0 : kinetic;
  if (paused_) velocity_.setZero();
  std::swap(state_.u, next_.u);
  if (easy_) {
    dt_ *= kLonger;
  } else {
    base_.reset();
    if (hard_) dt_ *= kShorter;
  }
}

}  // namespace sunder::solver
