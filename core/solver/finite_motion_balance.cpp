// SPDX-License-Identifier: Apache-2.0
// Where the energy of a body in motion goes, step by step, and what its motion amounts to.
#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/finite_motion.hpp"

namespace sunder::solver {
namespace {

// What of its way a step is left that its cap ended with too much energy.
constexpr double kPartsOfAWay[] = {0.5, 0.25, 0.125, 0};

}  // namespace

/// Of the step from state_ to next_, v its velocities; at_end_ has what the next one begins with.
/// The equation of the step's end, m a + damping m v + f = load + reaction + residual, times the
/// way.
FiniteMotionBalance FiniteMotion::balance(const FiniteTarget& end, const Scheme& by,
                                          std::span<const double> v) {
  FiniteMotionBalance of;
  of.broken = broken_;
  of.scheme = state_.energy - next_.energy;
  at_end_ = {load_, reaction_, felt_};
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const Index d = potential_.problem().dofs()[i];
    if (d == kNone) continue;
    const double way = next_.u[i] - u_[i], mass = mass_[d];
    const double weight = mass * options_.gravity[static_cast<Eigen::Index>(i % 3)];
    const double load = end.force[d] - weight;
    const double inertia = mass * by.rate * (v[i] - by.v_from[i]);
    const double drag =
        options_.damping * mass * v[i] + (next_.viscous.empty() ? 0 : next_.viscous[i]);
    const double left = inertia + drag + next_.f[i] - load - weight;
    const double reaction = gripped_[d] ? left : 0;
    of.work += (load_[d] + load + reaction_[d] + reaction) / 2 * way;
    of.damped += drag * way;
    // Of kinetic energy, of strain energy, of work: the step's end counts, not its mean.
    of.scheme += inertia * way - mass / 2 * (v[i] * v[i] - v_[i] * v_[i]) + next_.f[i] * way +
                 (load_[d] - load + reaction_[d] - reaction) / 2 * way;
    if (!gripped_[d]) of.unsolved -= left * way;
    at_end_.load[d] = load;
    at_end_.reaction[d] = reaction;
    at_end_.felt[d] = gripped_[d] ? left - inertia : 0;
  }
  return of;
}

/// What slowing the body gives back of the energy that a step has won beyond work; v is slowed.
/// Pieces that fly keep their momentum.
double FiniteMotion::won_back(const FiniteMotionBalance& of, std::vector<double>& v) const {
  const double won = -(of.damped + of.scheme + of.unsolved);
  if (!(won > 0)) return 0;
  const auto slows = [&](std::size_t i) {
    const Index d = potential_.problem().dofs()[i];
    return d != kNone && !gripped_[d] && !moving_.flying()[d];
  };
  double there = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (slows(i)) there += node_mass_[i / 3] / 2 * v[i] * v[i];
  }
  const double taken = std::min(won, there);
  const double share = taken > 0 ? std::sqrt(1 - taken / there) : 1;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (slows(i)) v[i] *= share;
  }
  return taken;
}

/// The residual that a cap leaves pushes the body, and such steps one after the other pump it up.
/// So none ends with more energy than it began with and got by work: the body is slowed, or, where
/// its strain energy alone is more, goes only part of the way. Backward Euler, which is next, asks
/// no more of the past than place and velocity.
void FiniteMotion::stay_within(const FiniteTarget& end, const Scheme& by, std::vector<double>& v,
                               Report& report) {
  const auto keeps = [&] {
    const double taken = won_back(report.balance, v);
    report.balance.unsolved += taken;
    const FiniteMotionBalance& of = report.balance;
    return of.damped + of.scheme + of.unsolved >= -1e-12 * (state_.energy + kinetic_energy());
  };
  if (keeps()) return;
  const std::vector<double> whole = next_.u;
  // Grips that go ahead alone strain the body: then only a better end of the step is a way out.
  const double most =
      potential_.grips(u_) == end.grips ? std::numeric_limits<double>::max() : next_.potential;
  const auto go = [&](double part) {
    next_.u = whole;
    for (std::size_t i = 0; part < 1 && i < u_.size(); ++i) {
      const Index d = potential_.problem().dofs()[i];
      if (d == kNone || gripped_[d] || moving_.flying()[d]) continue;
      next_.u[i] = u_[i] + part * (whole[i] - u_[i]);
    }
    potential_.evaluate(end, false, next_);
    if (part < 1 && !(next_.potential <= most)) return false;
    v = velocity_of(next_, by);
    report.balance = balance(end, by, v);
    return keeps();
  };
  for (const double part : kPartsOfAWay) {
    if (go(part)) return;
  }
  go(1);  // a hand's jump: none of them is better
}

FiniteMotionBalance FiniteMotion::sum() const {
  FiniteMotionBalance of = sum_;
  of.broken += broken_;
  return of;
}

double FiniteMotion::kinetic_energy() const {
  double twice = 0;
  for (std::size_t i = 0; i < v_.size(); ++i) twice += node_mass_[i / 3] * v_[i] * v_[i];
  return twice / 2;
}

double FiniteMotion::gravity_energy() const {
  double of = 0;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    of -= node_mass_[i / 3] * options_.gravity[static_cast<Eigen::Index>(i % 3)] * u_[i];
  }
  return of;
}

Vec3 FiniteMotion::momentum() const {
  Vec3 of = Vec3::Zero();
  for (std::size_t n = 0; n < node_mass_.size(); ++n) of += node_mass_[n] * Vec3(&v_[3 * n]);
  return of;
}

Vec3 FiniteMotion::angular_momentum() const {
  Vec3 of = Vec3::Zero();
  for (std::size_t n = 0; n < node_mass_.size(); ++n) {
    const Vec3 x = potential_.problem().mesh().nodes[n] + Vec3(&u_[3 * n]);
    of += node_mass_[n] * x.cross(Vec3(&v_[3 * n]));
  }
  return of;
}

}  // namespace sunder::solver
