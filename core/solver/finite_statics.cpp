// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_statics.hpp"

#include <algorithm>
#include <cmath>

#include "body/stiffness_factor.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

constexpr double kProbe = 1e-6;  // of the grips' motion, to feel what it pulls on
// Back-solves on a factor that was made where the one before stalled.
constexpr int kBackSolvesPerFactor = 10;
// Of the largest shear modulus: stress that is as good as none, and rounding.
constexpr double kNoStress = 1e-9, kStressRounding = 1e-13;
// Of the sum of shear modulus and volume: an energy is what terms of that size leave.
constexpr double kSumRounding = 2e-16;

FiniteScale scale_of(const Problem& problem) {
  double stiffest = 0, sum = 0, volume = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    stiffest = std::max(stiffest, problem.small_strain(e).mu);
    volume += problem.shape(e).volume;
    sum += problem.small_strain(e).mu * problem.shape(e).volume;
  }
  const double face = std::pow(volume / std::max(1, problem.tet_count()), 2.0 / 3);
  return {kNoStress * stiffest * face, kNoStress * stiffest, kStressRounding * stiffest * face,
          kStressRounding * stiffest, kSumRounding * sum};
}

}  // namespace

FiniteStatics::FiniteStatics(const fem::HyperelasticBody& body, FiniteStaticsOptions options)
    : body_(body),
      options_(options),
      resting_(body),
      potential_(resting_, options.stress),
      u_(body.problem.dofs().size(), 0.0),
      f_(u_.size(), 0.0),
      reached_(potential_.target({})),
      order_(fem::elimination_order(body.problem)),
      minimiser_(potential_, options.pairs),
      scale_(scale_of(body.problem)) {}

void FiniteStatics::destroyed(std::span<const Index>) {
  resting_.look();
  before_.clear();
}

void FiniteStatics::body_changed() {
  resting_.look();
  before_.clear();
  base_.reset();
}

/// Makes a base; false: the tangent is not positive definite.
bool FiniteStatics::renew(const std::vector<double>& u, fem::Tangent kind,
                          FiniteStaticsReport& report) {
  ++report.factors;
  try {
    base_ = std::make_unique<FiniteBase>(resting_.body(), u, kind, order_);
  } catch (const NumericalError&) {
    base_.reset();
  }
  return base_ != nullptr;
}

/// state_ <- where to begin: the last state, turned as a whole with its grips, those moved and the
/// rest following as the base says; or the last step once more, where its energy is less.
void FiniteStatics::predict(const FiniteTarget& target) {
  state_.u = u_;
  if (target.grips != reached_.grips) {
    const auto turned = follow_grips_rigidly(body_.problem, u_, target.grips);
    if (!turned.empty()) state_.u = turned;
  }
  if (options_.turn) base_->turn(resting_, state_.u);
  potential_.evaluate(target, false, state_);
  if (target.grips != reached_.grips) move_grips(target);
  const double times = before_.empty() ? 0 : continuation(begin_, reached_, target);
  if (times == 0) return;
  probe_.u = u_;
  for (std::size_t i = 0; i < u_.size(); ++i) probe_.u[i] += times * (u_[i] - before_[i]);
  potential_.put_grips(target, probe_.u);
  potential_.evaluate(target, false, probe_);
  if (probe_.potential < state_.potential) std::swap(state_, probe_);
}

/// What a small share of the grips' motion adds to the forces tells what the whole would.
void FiniteStatics::move_grips(const FiniteTarget& target) {
  following_.setZero(state_.r.size());
  probe_.u = state_.u;
  potential_.put_grips(target, probe_.u);
  potential_.difference(probe_.u, state_.u, motion_);
  if (motion_.cwiseAbs().maxCoeff() == 0) return;
  potential_.move(state_.u, kProbe, motion_, probe_.u);
  potential_.evaluate(target, false, probe_);
  const Eigen::VectorXd pulled = -(state_.r + (probe_.r - state_.r) / kProbe);
  base_->solve(pulled, following_);
  potential_.hold(following_);
  potential_.move(state_.u, 1, motion_ + following_, probe_.u);
  potential_.put_grips(target, probe_.u);
  std::swap(state_.u, probe_.u);
  potential_.evaluate(target, false, state_);
}

bool FiniteStatics::minimise(const FiniteTarget& target, int most, FiniteStaticsReport& report) {
  const auto result =
      minimiser_.minimise(target, *base_, {options_.tolerance, options_.residual}, most, state_);
  report.back_solves += result.back_solves;
  report.residual = result.residual;
  report.error = result.error;
  report.contraction = result.contraction;
  return result.at_rest;
}

/// Of the exact tangent where it is positive definite, else of the projected one.
bool FiniteStatics::by_new_factors(const FiniteTarget& target, FiniteStaticsReport& report) {
  for (int i = 0; i < options_.most_factors; ++i) {
    if (!renew(state_.u, fem::Tangent::exact, report) &&
        !renew(state_.u, fem::Tangent::projected, report)) {
      return false;
    }
    if (minimise(target, kBackSolvesPerFactor, report)) return true;
  }
  return false;
}

bool FiniteStatics::approach(const FiniteTarget& target, FiniteStaticsReport& report) {
  const int before = report.back_solves;
  if (base_ && !base_->follow(resting_, options_.most_rank)) base_.reset();
  if (!base_ && !renew(u_, fem::Tangent::projected, report)) return false;
  report.rank = base_->rank();
  predict(target);
  if (!std::isfinite(state_.potential)) return false;
  if (!minimise(target, options_.most_back_solves, report) && !by_new_factors(target, report)) {
    return false;
  }
  before_ = std::move(u_);
  begin_ = std::move(reached_);
  u_ = state_.u;
  f_ = state_.f;
  reached_ = target;
  if (report.back_solves - before > options_.renew_after) base_.reset();
  return true;
}

FiniteStaticsReport FiniteStatics::solve(const Load& load) {
  FiniteStaticsReport report;
  report.frozen = resting_.parts();
  const FiniteTarget begin = reached_, end = potential_.target(load);
  state_.u = u_;
  potential_.evaluate(begin, false, state_);
  FiniteScale scale = scale_;
  scale.force = std::max(scale.force, state_.acting);
  minimiser_.set_scale(scale);
  double step = 1;
  const double least = std::ldexp(1.0, -options_.most_halvings);
  while (report.share < 1) {
    const double share = std::min(1.0, report.share + step);
    FiniteTarget next{begin.force + share * (end.force - begin.force), end.grips};
    for (std::size_t g = 0; g < next.grips.size(); ++g) {
      next.grips[g] = begin.grips[g] + share * (end.grips[g] - begin.grips[g]);
    }
    ++report.load_steps;
    if (approach(next, report)) {
      report.share = share;
      continue;
    }
    base_.reset();  // of the last state at rest
    step /= 2;
    if (step < least) return report;
  }
  report.at_rest = true;
  return report;
}

}  // namespace sunder::solver
