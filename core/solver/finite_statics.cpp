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

double largest_modulus(const Problem& problem) {
  double stiffest = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    stiffest = std::max(stiffest, problem.small_strain(e).mu);
  }
  return stiffest;
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
      minimiser_(potential_, options.pairs) {}

void FiniteStatics::destroyed(std::span<const Index>) { body_changed(); }

void FiniteStatics::body_changed() {
  resting_.look();
  base_.reset();
}

/// Makes a base; false: the tangent is not positive definite.
bool FiniteStatics::renew(const std::vector<double>& u, fem::Tangent kind,
                          FiniteStaticsReport& report) {
  ++report.factors;
  try {
    base_.emplace(resting_, u, kind, order_);
  } catch (const NumericalError&) {
    base_.reset();
  }
  return base_.has_value();
}

/// The last state, its grips moved and the rest following as the base says: what a small share of
/// that motion adds to the forces tells what the whole would.
void FiniteStatics::predict(const FiniteTarget& target) {
  const auto gripped = body_.problem.gripped_dofs();
  state_.u = u_;
  potential_.evaluate(target, false, state_);
  if (target.grips == reached_.grips) return;
  motion_.setZero(state_.r.size());
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    if (resting_.frozen()[gripped[g]]) continue;
    motion_[gripped[g]] = target.grips[g] - reached_.grips[g];
  }
  potential_.move(u_, kProbe, motion_, probe_.u);
  potential_.evaluate(target, false, probe_);
  const Eigen::VectorXd pulled = -(state_.r + (probe_.r - state_.r) / kProbe);
  base_->solve(pulled, following_);
  potential_.hold(following_);
  potential_.move(u_, 1, motion_ + following_, state_.u);
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
  if (!base_ && !renew(u_, fem::Tangent::projected, report)) return false;
  predict(target);
  if (!std::isfinite(state_.potential)) return false;
  if (!minimise(target, options_.most_back_solves, report) && !by_new_factors(target, report)) {
    return false;
  }
  u_ = state_.u;
  f_ = state_.f;
  if (report.back_solves - before > options_.renew_after) base_.reset();
  return true;
}

FiniteStaticsReport FiniteStatics::solve(const Load& load) {
  FiniteStaticsReport report;
  report.frozen = resting_.parts();
  const FiniteTarget begin = reached_, end = potential_.target(load);
  state_.u = u_;
  potential_.evaluate(begin, false, state_);
  const double modulus = largest_modulus(body_.problem);
  minimiser_.set_scale({state_.acting, kNoStress * modulus, kStressRounding * modulus});
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
      reached_ = std::move(next);
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
