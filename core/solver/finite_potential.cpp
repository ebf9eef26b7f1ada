// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_potential.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::solver {
namespace {

double frobenius(const Voigt& s) {
  return std::sqrt(s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm());
}

}  // namespace

FinitePotential::FinitePotential(const RestingBody& body, StressMeasure stress,
                                 FiniteDevice* device)
    : body_(body),
      grip_places_(body.body().problem.gripped_dofs().size()),
      stress_(stress),
      device_(device),
      pass_(std::make_unique<fem::HyperelasticPass>(body.body())) {
  const auto gripped = problem().gripped_dofs();
  for (std::size_t i = 0; i < problem().dofs().size(); ++i) {
    const auto at = std::ranges::lower_bound(gripped, problem().dofs()[i]);
    if (at != gripped.end() && *at == problem().dofs()[i]) {
      grip_places_[static_cast<std::size_t>(at - gripped.begin())] = i;
    }
  }
  if (device_) device_->attach(body_);
}

void FinitePotential::body_changed() {
  pass_->split_pools(body_.body().split);
  pass_->body_changed();
  if (device_) device_->attach(body_);
}

void FinitePotential::put_grips(const FiniteTarget& target, std::vector<double>& u) const {
  const auto gripped = problem().gripped_dofs();
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    if (!body_.frozen()[gripped[g]]) u[grip_places_[g]] = target.grips[g];
  }
}

std::vector<double> FinitePotential::grips(std::span<const double> u) const {
  std::vector<double> of;
  for (const std::size_t place : grip_places_) of.push_back(u[place]);
  return of;
}

FiniteTarget FinitePotential::target(const Load& load) const {
  FiniteTarget of{Eigen::VectorXd::Zero(problem().dof_count()), load.displacements};
  of.grips.resize(problem().gripped_dofs().size(), 0.0);
  for (std::size_t i = 0; i < load.forces.size(); ++i)
    of.force[load.force_dofs[i]] = load.forces[i];
  return of;
}

void FinitePotential::evaluate(const FiniteTarget& target, bool with_stress,
                               FiniteState& state) const {
  if (device_) {
    device_->evaluate(target, with_stress, state);
    return;
  }
  const fem::HyperelasticBody& body = body_.body();
  state.f.resize(state.u.size());
  state.stress.resize(with_stress ? body.problem.mesh().tets.size() : 0);
  fem::HyperelasticPass::Wanted wanted{.forces = state.f, .stress = state.stress};
  if (with_stress) wanted.measure = stress_;
  state.energy = pass_->run(state.u, wanted).energy;
  state.r = -target.force;
  const bool viscous = target.viscosity != nullptr;
  state.viscous.resize(viscous ? state.u.size() : 0);
  const double damps =
      viscous ? target.viscosity->forces(state.u, target.viscous, state.viscous) : 0;
  double work = 0, held = 0, loaded = 0;
  for (std::size_t i = 0; i < state.f.size(); ++i) {
    const Index d = body.problem.dofs()[i];
    if (d == kNone) {
      held += state.f[i] * state.f[i];
      continue;
    }
    state.r[d] += state.f[i] + (viscous ? state.viscous[i] : 0);
    if (body_.frozen()[d]) continue;
    work += target.force[d] * state.u[i];
    loaded += target.force[d] * target.force[d];
  }
  for (Index d : body.problem.gripped_dofs()) {
    if (!body_.frozen()[d]) held += state.r[d] * state.r[d];
  }
  double springs = 0, accelerates = 0;
  for (std::size_t i = 0; target.ahead && i < state.u.size(); ++i) {
    const Index d = body.problem.dofs()[i];
    if (d == kNone || body_.frozen()[d]) continue;
    const double from = state.u[i] - (*target.ahead)[i], force = target.inertia.of(d) * from;
    state.r[d] += force;
    springs += force * from / 2;
    accelerates += force * force;
  }
  hold(state.r);
  // A fictitious mass is no force that acts.
  state.acting = std::sqrt(loaded + held + (target.inertia.mass.empty() ? 0 : accelerates));
  state.potential = state.energy - work + springs + damps;
}

void FinitePotential::complete(FiniteState& state) const {
  if (!state.stress.empty()) return;
  state.stress.resize(problem().mesh().tets.size());
  pass_->run(state.u, {.stress = state.stress, .measure = stress_});
}

void FinitePotential::move(std::span<const double> from, double part, const Eigen::VectorXd& du,
                           std::vector<double>& to) const {
  to.assign(from.begin(), from.end());
  for (std::size_t i = 0; i < to.size(); ++i) {
    const Index d = problem().dofs()[i];
    if (d != kNone) to[i] += part * du[d];
  }
}

void FinitePotential::difference(std::span<const double> to, std::span<const double> from,
                                 Eigen::VectorXd& s) const {
  s.resize(problem().dof_count());
  for (std::size_t i = 0; i < to.size(); ++i) {
    const Index d = problem().dofs()[i];
    if (d != kNone) s[d] = to[i] - from[i];
  }
}

void FinitePotential::hold(Eigen::VectorXd& of_unknowns) const {
  for (Index d : problem().gripped_dofs()) of_unknowns[d] = 0;
  const auto frozen = body_.frozen();
  for (Index d = 0; d < of_unknowns.size(); ++d) {
    if (frozen[d]) of_unknowns[d] = 0;
  }
}

FinitePotential::StressChange FinitePotential::stress_change(std::span<const Voigt> stress,
                                                             std::span<const Voigt> before) const {
  StressChange of;
  for (std::size_t e = 0; e < stress.size(); ++e) {
    if (body_.out()[e]) continue;
    const double change = frobenius(stress[e] - before[e]);
    if (!(change <= of.change)) of.change = change;  // NaN stays
    of.largest = std::max(of.largest, frobenius(before[e]));
  }
  return of;
}

}  // namespace sunder::solver
