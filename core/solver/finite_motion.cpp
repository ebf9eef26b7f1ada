// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_motion.hpp"

#include <algorithm>
#include <cmath>

#include "material/linear.hpp"
#include "solver/frame_cost.hpp"
#include "solver/grip_stiffness.hpp"
#include "solver/new_base_timer.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

// After a rupture or a step that its cap ended BDF2 carries a force on that is none any more
// (finite.md: energy rises; three steps of backward Euler do not).
constexpr int kEulerSteps = 3;
// A base with so many times the step's inertia, or as little, is another body's.
constexpr double kMostInertiaApart = 4;
constexpr int kMostParts = 64;  // of a step
// Within which a base is taken, whatever its making may be thought to take: a later one is of a
// state long past.
constexpr double kFewestStepsOfABase = 2, kMostStepsOfABase = 12;
// Back-solves that a step takes on a base which is still good (finite.md): the inertia of shorter
// steps makes more of the tangent, so that fewer do.
constexpr int kMostOnAGoodBase = 8, kMostOfShortSteps = 5;
constexpr double kShortStep = 1.0 / 500;  // [s]
// On a factor that was made where the base before it stalled.
constexpr int kOnAnExactFactor = 10;
// A step that would leave no more than this of the forces that act, times the tolerance of stress,
// by ending where it began, does so: of soft bodies a hundredth of what the promise lets it be off.
constexpr double kStill = 1e-3;

/// Of the base: viscous forces make its tangent so many times as stiff, and the whole is divided.
fem::Inertia inertia_of_base(const FiniteTarget& target) {
  return {target.inertia.factor / (1 + target.viscous), target.inertia.mass};
}

bool all_linear(const fem::HyperelasticBody& body) {
  return std::ranges::all_of(body.law_of_volume, [](const Law* law) { return law == &kLinear; });
}

}  // namespace

FiniteMotion::FiniteMotion(const fem::HyperelasticBody& body, std::span<const double> mass,
                           FiniteMotionOptions options, FiniteDevice* device)
    : options_(options),
      moving_(body, RestingBody::Loose::moving),
      potential_(moving_, options.stress, device),
      minimiser_(potential_, options.pairs),
      scale_(finite_scale(body.problem)),
      node_mass_(mass.begin(), mass.end()),
      mass_(static_cast<std::size_t>(body.problem.dof_count()), 0.0),
      u_(body.problem.dofs().size(), 0.0),
      v_(u_.size(), 0.0),
      viscosity_(moving_.body()),
      linear_(all_linear(body)),
      renewal_(options.rest, options.inverse) {
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const Index d = body.problem.dofs()[i];
    if (d != kNone) mass_[d] = node_mass_[i / 3];
  }
  state_.u = u_;
  potential_.evaluate(potential_.target({}), false, state_);
  gripped_.resize(mass_.size());
  for (Index d : body.problem.gripped_dofs()) gripped_[d] = 1;
  load_.setZero(body.problem.dof_count());
  reaction_ = felt_ = load_;
}

void FiniteMotion::set_velocity(std::span<const double> v) {
  sum_.work -= kinetic_energy();
  for (std::size_t i = 0; i < v_.size(); ++i) {
    v_[i] = potential_.problem().dofs()[i] == kNone ? 0 : v[i];
  }
  sum_.work += kinetic_energy();
  euler_ = std::max(euler_, 1);
}

void FiniteMotion::go_on_from(const FiniteMotionPast& past) {
  u_ = past.u;
  v_ = past.v;
  u_before_ = past.u_before;
  v_before_ = past.v_before;
  dt_before_ = past.dt;
  euler_ = past.euler;
  state_.u = u_;
  potential_.evaluate(potential_.target({}), false, state_);
  time_ = past.time;
  load_ = past.load;
  reaction_ = past.reaction;
  felt_ = past.felt;
  viscous_ = past.viscous;
  broken_ = 0;
  sum_ = past.sum;
}

void FiniteMotion::go_on_from(FiniteMotion& before, const fem::Parting& parting) {
  FiniteMotionPast past = before.past();
  for (auto* of : {&past.u, &past.v, &past.u_before, &past.v_before, &past.viscous}) {
    parting.nodal(*of);
  }
  for (auto* of : {&past.load, &past.reaction, &past.felt}) parting.forces(*of);
  past.euler = kEulerSteps;
  go_on_from(past);
  rate_ = before.rate_;
  sum_ = before.sum_;
  broken_ = before.broken_;
  parted_ = true;
  base_ = std::move(before.base_);
  if (base_ && !base_->part(potential_.problem(), parting, mass_)) base_.reset();
}

void FiniteMotion::go_on_from(FiniteMotion& before) {
  FiniteMotionPast past = before.past();
  if (past.dt > 0) past.euler = kEulerSteps;  // what a grip changes carries no force on
  for (Index d = 0; d < past.reaction.size(); ++d) {
    if (!gripped_[static_cast<std::size_t>(d)]) past.reaction[d] = past.felt[d] = 0;
  }
  go_on_from(past);
  rate_ = before.rate_;
  sum_ = before.sum_;
  broken_ = before.broken_;
  base_ = std::move(before.base_);
  if (base_ && !base_->grip(potential_.problem())) base_.reset();
}

Eigen::MatrixXd FiniteMotion::grip_stiffness(bool with_inertia) {
  if (!base_ || rate_ == 0) return {};
  const GripTangent of{{rate_ * (rate_ + options_.damping), mass_},
                       options_.viscosity > 0 ? &viscosity_ : nullptr,
                       options_.viscosity * rate_,
                       with_inertia};
  return solver::grip_stiffness(moving_, u_, pattern(), *base_, of);
}

void FiniteMotion::leave_device(const FiniteMotionPast& past) {
  potential_.leave_device();
  potential_.body_changed();
  base_.reset();
  renewal_.give_up();
  go_on_from(past);
  broken_ += past.energy - state_.energy;  // of what has left since
}

void FiniteMotion::destroyed(std::span<const Index>) {
  moving_.look();
  potential_.body_changed();
  const double before = state_.energy;
  potential_.evaluate(potential_.target({}), false, state_);
  broken_ += before - state_.energy;
  if (!viscous_.empty()) viscosity_.forces(u_, options_.viscosity * rate_, viscous_);
  euler_ = kEulerSteps;
}

FiniteMotion::Scheme FiniteMotion::scheme(double dt) const {
  if (euler_ > 0) return {false, 1 / dt, 1, 0, u_, v_};
  // BDF2 with steps of two lengths (Hairer, Norsett and Wanner 1993, III.5).
  const double w = dt / dt_before_, now = (1 + w) * (1 + w) / (1 + 2 * w),
               before = w * w / (1 + 2 * w);
  Scheme by{true, (1 + 2 * w) / (1 + w) / dt, now, before, u_, v_};
  for (std::size_t i = 0; i < u_.size(); ++i) {
    by.u_from[i] = now * u_[i] - before * u_before_[i];
    by.v_from[i] = now * v_[i] - before * v_before_[i];
  }
  return by;
}

/// Forces, and springs to where a step without them ends: a + damping v = k (u - ahead).
FiniteTarget FiniteMotion::target(const Load& load, const Scheme& by) {
  FiniteTarget of = potential_.target(load);
  const double square = by.rate * by.rate, drag = options_.damping * by.rate;
  of.inertia = {square + drag, mass_};
  ahead_ = by.u_from;
  for (std::size_t i = 0; i < ahead_.size(); ++i) {
    const Index d = potential_.problem().dofs()[i];
    if (d == kNone) continue;
    ahead_[i] += square / (square + drag) * by.v_from[i] / by.rate;
    of.force[d] += mass_[d] * options_.gravity[static_cast<Eigen::Index>(i % 3)];
  }
  of.ahead = &ahead_;
  return of;
}

void FiniteMotion::add_viscosity(const Scheme& by, FiniteTarget& target) {
  if (options_.viscosity == 0 || target.viscosity) return;
  viscosity_.start(u_, by.now, u_before_, by.before);
  target.viscosity = &viscosity_;
  target.viscous = options_.viscosity * by.rate;
}

/// Whether the step ends where it begins, as good as exactly: what a body at rest asks of a step.
/// No pass over the elements tells, but for viscous forces while anything moves yet.
bool FiniteMotion::is_still(const Scheme& by, FiniteTarget& target) {
  if (potential_.grips(u_) != target.grips) return false;
  const double least = std::max(kStill * options_.tolerance * std::max(state_.acting, scale_.force),
                                scale_.force_rounding);
  std::vector<double> viscous;
  const auto holds = [&] {
    double square = 0;
    for (std::size_t i = 0; i < u_.size(); ++i) {
      const Index d = potential_.problem().dofs()[i];
      if (d == kNone || gripped_[d]) continue;
      const double left = state_.f[i] - target.force[d] +
                          target.inertia.of(d) * (u_[i] - ahead_[i]) +
                          (viscous.empty() ? 0 : viscous[i]);
      square += left * left;
    }
    return std::sqrt(square) <= least;
  };
  if (!holds()) return false;
  // Without a velocity and a way there is no rate.
  if (options_.viscosity == 0 || u_before_.empty() || u_before_ == u_) return true;
  add_viscosity(by, target);
  viscous.resize(u_.size());
  viscosity_.forces(u_, target.viscous, viscous);
  return holds();
}

FiniteMotionReport FiniteMotion::stay(const FiniteTarget& end, const Scheme& by, double dt) {
  Report report;
  report.still = true;
  report.second_order = by.second_order;
  report.balance.broken = std::exchange(broken_, 0.0);
  report.balance.scheme = kinetic_energy();  // of what is as good as no velocity
  sum_ += report.balance;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const Index d = potential_.problem().dofs()[i];
    if (d == kNone) continue;
    load_[d] = end.force[d] - mass_[d] * options_.gravity[static_cast<Eigen::Index>(i % 3)];
    felt_[d] = reaction_[d] = gripped_[d] ? state_.f[i] - end.force[d] : 0;
  }
  u_before_ = u_;
  v_.assign(u_.size(), 0.0);
  v_before_ = v_;
  if (!viscous_.empty()) viscous_.assign(u_.size(), 0.0);
  dt_before_ = dt;
  rate_ = by.rate;
  time_ += dt;
  euler_ = std::max(0, euler_ - 1);
  return report;
}

/// next_ <- where the step looks first: as the body goes, of what nothing holds with the forces on
/// it, else where it is.
bool FiniteMotion::begin(const FiniteTarget& target, double dt) {
  next_.u = u_;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const Index d = potential_.problem().dofs()[i];
    if (d != kNone && moving_.flying()[d] && mass_[d] > 0) {
      next_.u[i] = ahead_[i] + target.force[d] / (target.inertia.of(d));
    } else {
      next_.u[i] += dt * v_[i];
    }
  }
  for (int i = 0; i < 2; ++i) {
    potential_.put_grips(target, next_.u);
    potential_.evaluate(target, false, next_);
    const bool known = std::isfinite(next_.potential);
    if (i == 1 || (known && !better_where_it_is(target))) return known;
    next_.u = u_;
  }
  return false;
}

/// Whether what a step minimises is less where it begins than at next_: of what creeps, velocities
/// are mostly what the iterations left. No pass over the elements tells.
bool FiniteMotion::better_where_it_is(const FiniteTarget& target) const {
  if (potential_.grips(u_) != target.grips) return false;
  double potential = state_.energy;  // no viscous potential, as good as without a way
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const Index d = potential_.problem().dofs()[i];
    if (d == kNone) continue;
    if (moving_.flying()[d]) return false;
    const double from = u_[i] - ahead_[i];
    potential += target.inertia.of(d) * from * from / 2 - target.force[d] * u_[i];
  }
  return potential < next_.potential;
}

bool FiniteMotion::renew(const std::vector<double>& u, const fem::Inertia& inertia,
                         Report& report) {
  const NewBaseTimer timer(report.new_bases);
  base_ = projected_base(moving_.body(), u, pattern(), report.factors,
                         linear_algebra::work_at_once(), inertia);
  if (base_ && options_.inverse && !parted_) base_->keep_inverse(linear_algebra::work_at_once());
  return base_ != nullptr;
}

bool FiniteMotion::needs_base() const {
  const FiniteDevice* device = potential_.device();
  return !device || device->needs() != FiniteDevice::Needs::nothing;
}

const fem::TangentPattern& FiniteMotion::pattern() {
  if (!pattern_) pattern_.emplace(potential_.problem());
  return *pattern_;
}

bool FiniteMotion::ensure_base(const fem::Inertia& inertia, Report& report) {
  if (!needs_base()) return true;
  const bool alike = base_ && base_->inertia() < kMostInertiaApart * inertia.factor &&
                     inertia.factor < kMostInertiaApart * base_->inertia();
  if (!alike || !base_->follow(moving_, options_.most_rank)) base_.reset();
  if (!base_ && !renew(u_, inertia, report)) return false;
  report.rank = base_->rank();
  return true;
}

/// next_ <- the step's end; false: neither the base nor new factors lead to it.
bool FiniteMotion::minimise(const FiniteTarget& target, Report& report) {
  const auto once = [&](int most) {
    const auto result = minimiser_.minimise(
        target, base_.get(), {options_.tolerance, options_.residual, true}, most, next_);
    report.back_solves += result.back_solves;
    report.residual = result.residual;
    report.error = result.error;
    report.contraction = result.contraction;
    return result.at_rest;
  };
  if (options_.most_iterations > 0) {
    report.capped = !once(options_.most_iterations);
    return true;
  }
  if (once(options_.most_back_solves)) return true;
  if (!needs_base()) return false;
  for (int i = 0; i < options_.most_factors; ++i) {
    if (!take_exact(next_.u, inertia_of_base(target), report) &&
        !renew(next_.u, inertia_of_base(target), report)) {
      return false;
    }
    if (once(kOnAnExactFactor)) return true;
  }
  return false;
}

/// A base of the exact tangent, for the state in work alone; false: it is not positive definite.
bool FiniteMotion::take_exact(const std::vector<double>& u, const fem::Inertia& inertia,
                              Report& report) {
  const NewBaseTimer timer(report.new_bases);
  ++report.factors;
  try {
    base_ = std::make_unique<FiniteBase>(moving_.body(), u, fem::Tangent::exact, pattern(), inertia,
                                         linear_algebra::work_at_once());
    return true;
  } catch (const NumericalError&) {
    return false;
  }
}

FiniteMotionReport FiniteMotion::step(const Load& load, double dt) {
  const Report report = one_step(load, dt);
  return report.stuck ? in_parts(load, dt, report) : report;
}

/// A hand that jumps, or a jump of the body itself, in so many steps of less time.
FiniteMotionReport FiniteMotion::in_parts(const Load& load, double dt, const Report& first) {
  const FiniteMotionPast start = past();
  const std::vector<double> from = potential_.grips(u_);
  Report all = first;
  for (int parts = 2; parts <= kMostParts; parts *= 2) {
    all.parts = parts;
    all.stuck = all.capped = false;
    all.balance = {};
    for (int i = 1; i <= parts && !all.stuck; ++i) {
      const double share = static_cast<double>(i) / parts;
      Load on_the_way = load;
      for (std::size_t g = 0; g < from.size(); ++g) {
        on_the_way.displacements[g] = from[g] + share * (load.displacements[g] - from[g]);
      }
      const Report part = one_step(i < parts ? on_the_way : load, dt / parts);
      all.back_solves += part.back_solves;
      all.factors += part.factors;
      all.new_bases += part.new_bases;
      all.bases += part.bases;
      all.stuck = part.stuck;
      all.capped = all.capped || part.capped;
      all.second_order = part.second_order;
      all.residual = part.residual;
      all.error = part.error;
      all.contraction = part.contraction;
      all.rank = part.rank;
      all.balance += part.balance;
    }
    if (!all.stuck) return all;
    go_on_from(start);
  }
  return all;
}

FiniteMotionReport FiniteMotion::one_step(const Load& load, double dt) {
  Report report;
  const Scheme by = scheme(dt);
  report.second_order = by.second_order;
  FiniteTarget end = target(load, by);
  if (is_still(by, end)) return stay(end, by, dt);
  if (renewal_.base_asked() && --until_taken_ <= 0) {
    const NewBaseTimer timer(report.new_bases);
    if (auto base = renewal_.take_base()) {
      base_ = std::move(base);
      ++report.bases;
    }
  }
  add_viscosity(by, end);
  const fem::Inertia inertia = inertia_of_base(end);
  FiniteScale scale = scale_;
  scale.force = std::max(scale.force, state_.acting);
  scale.force_rounding *= 1 + end.viscous;
  scale.energy_rounding *= 1 + end.viscous;
  minimiser_.set_scale(scale);
  report.stuck = !ensure_base(inertia, report) || !begin(end, dt);
  if (!report.stuck) {
    if (options_.turn && base_) base_->turn(moving_, next_.u);
    report.stuck = !minimise(end, report);
  }
  if (report.stuck) {
    base_.reset();
    return report;
  }
  take(end, by, dt, report);
  euler_ = report.capped ? kEulerSteps : std::max(0, euler_ - 1);
  renew_if_due(inertia, dt, report);
  return report;
}

std::vector<double> FiniteMotion::velocity_of(const FiniteState& state, const Scheme& by) const {
  std::vector<double> v(u_.size());
  for (std::size_t i = 0; i < u_.size(); ++i) v[i] = by.rate * (state.u[i] - by.u_from[i]);
  return v;
}

/// The step's end is the state.
void FiniteMotion::take(const FiniteTarget& end, const Scheme& by, double dt, Report& report) {
  std::vector<double> v = velocity_of(next_, by);
  report.balance = balance(end, by, v);
  if (report.capped) stay_within(end, by, v, report);
  sum_ += report.balance;
  broken_ = 0;
  std::swap(load_, at_end_.load);
  std::swap(reaction_, at_end_.reaction);
  std::swap(felt_, at_end_.felt);
  std::swap(state_, next_);
  u_before_ = std::exchange(u_, state_.u);
  v_before_ = std::exchange(v_, std::move(v));
  viscous_ = state_.viscous;
  dt_before_ = dt;
  rate_ = by.rate;
  time_ += dt;
}

int FiniteMotion::most_on_a_good_base(double dt) const {
  int most = options_.renew_after.value_or(dt < kShortStep ? kMostOfShortSteps : kMostOnAGoodBase);
  // Below the cap, or a base that no longer does would never be renewed.
  if (options_.most_iterations > 0) most = std::min(most, options_.most_iterations - 1);
  return most;
}

int FiniteMotion::steps_of_a_base(double dt) {
  if (options_.taken_after) return *options_.taken_after;
  const double making = seconds_of_a_tangent(*pattern().supernodes(), potential_.problem());
  return static_cast<int>(
      std::clamp(std::ceil(making / dt), kFewestStepsOfABase, kMostStepsOfABase));
}

void FiniteMotion::renew_if_due(const fem::Inertia& inertia, double dt, Report& report) {
  // The linear law's tangent is the same in every state: one base serves for ever.
  const bool worn = !linear_ && report.back_solves > most_on_a_good_base(dt);
  const bool hard = worn || report.rank > options_.most_rank / 2;
  if (!hard || renewal_.base_asked() || !needs_base()) return;
  until_taken_ = steps_of_a_base(dt);
  if (until_taken_ == 0) {
    if (!renew(u_, inertia, report)) base_.reset();
    return;
  }
  renewal_.ask(moving_.body(), u_, pattern(), true, false, inertia);
}

}  // namespace sunder::solver
