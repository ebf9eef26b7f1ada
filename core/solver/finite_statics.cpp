// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_statics.hpp"

#include <algorithm>
#include <cmath>

#include "material/linear.hpp"
#include "solver/finite_start.hpp"
#include "solver/grip_stiffness.hpp"
#include "solver/instrument_block.hpp"
#include "solver/kept_pressures.hpp"
#include "solver/lowest_mode.hpp"
#include "solver/new_base_timer.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

constexpr double kProbe = 1e-6;  // of the grips' motion, to feel what it pulls on
// Back-solves on a factor that was made where the one before stalled.
constexpr int kBackSolvesPerFactor = 10;
// A push out of an unstable rest: of the body's size the first, each next one so many times larger
// while the energy falls.
constexpr double kFirstPush = 1e-5, kPushGrowth = 2, kLastPush = 0.1;
constexpr int kMostPushes = 4;  // modes that are left one after the other
// On a damped path, of the residual: an equilibrium may be near.
constexpr double kNearRest = 0.02;
constexpr int kFactorsToFinish = 3;  // of a damped path
constexpr int kOfAGoodBase = 2;      // back-solves of a step
// Pressures are kept where kappa is so many times mu (nu .495): below it Newton's method by
// energies needs fewer factors, at .499 a pull of the paper's board takes 26 to 29 back-solves and
// 5 to 8 factors instead of 47 to 103 and 4 to 9.
constexpr double kVolumeOverShape = 100;

/// Whether some patch resists a change of volume so much more than one of shape.
bool hardly_compressible(const Problem& problem) {
  const fem::Pools* pools = problem.pools();
  for (Index p = 0; pools && p < pools->count(); ++p) {
    const double mu = problem.small_strain(pools->elements(p).front()).mu;
    if (pools->bulk(p) > kVolumeOverShape * mu) return true;
  }
  return false;
}

/// Of the bounding box: its diagonal.
double size_of(const Problem& problem) {
  Vec3 low = problem.mesh().nodes.front(), high = low;
  for (const Vec3& x : problem.mesh().nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).norm();
}

}  // namespace

FiniteStatics::FiniteStatics(const fem::HyperelasticBody& body, FiniteStaticsOptions options,
                             FiniteDevice* device)
    : body_(body),
      options_(options),
      resting_(body),
      potential_(resting_, options.stress, device),
      minimiser_(potential_, options.pairs),
      scale_(finite_scale(body.problem)),
      pattern_(body.problem),
      u_(body.problem.dofs().size(), 0.0),
      reached_(potential_.target({})),
      check_after_(options.check_after),
      keeps_pressures_(hardly_compressible(body.problem)),
      path_(potential_, minimiser_, pattern_),
      renewal_(options.rest, options.inverse),
      linear_(std::ranges::all_of(body.law_of_volume, [](const Law* l) { return l == &kLinear; })) {
  shown_.u = u_;
  shown_.f.assign(u_.size(), 0.0);
}

void FiniteStatics::leave_device() {
  potential_.leave_device();
  body_changed();
}

void FiniteStatics::update_parts() {
  resting_.look();
  potential_.body_changed();
  before_.clear();
  path_.body_changed();
}

void FiniteStatics::go_on_from(FiniteStatics& before, const fem::Parting& parting) {
  u_ = before.u_;
  parting.nodal(u_);
  reached_ = before.reached_;
  parting.forces(reached_.force);
  fem::add_parted_grips(body_.problem, reached_.grips);
  first_ = before.first_;
  suspected_ = before.suspected_;
  since_check_ = before.since_check_;
  check_after_ = before.check_after_;
  shown_.u = u_;
  potential_.evaluate(reached_, false, shown_);
  parted_ = true;
  worn_ = before.worn_;
  base_ = std::move(before.base_);
  if (base_ && !base_->part(body_.problem, parting, {})) base_.reset();
}

/// The force of a grip that has let go acts on as a part of the load, and leaves with the next
/// step.
void FiniteStatics::go_on_from(FiniteStatics& before) {
  u_ = before.u_;
  reached_ = {before.reached_.force, potential_.grips(u_)};
  first_ = before.first_;
  suspected_ = before.suspected_;
  since_check_ = before.since_check_;
  check_after_ = before.check_after_;
  worn_ = before.worn_;
  shown_.u = u_;
  potential_.evaluate(reached_, false, shown_);
  std::vector<std::uint8_t> held(static_cast<std::size_t>(body_.problem.dof_count()), 0);
  for (Index d : before.body_.problem.gripped_dofs()) held[static_cast<std::size_t>(d)] = 1;
  for (Index d : body_.problem.gripped_dofs()) held[static_cast<std::size_t>(d)] = 0;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const Index d = body_.problem.dofs()[i];
    if (d != kNone && held[static_cast<std::size_t>(d)]) reached_.force[d] = shown_.f[i];
  }
  base_ = std::move(before.base_);
  if (base_ && !base_->grip(body_.problem)) base_.reset();
}

void FiniteStatics::destroyed(std::span<const Index>) { update_parts(); }

Eigen::MatrixXd FiniteStatics::grip_stiffness() {
  if (!base_) return {};
  return solver::grip_stiffness(resting_, shown_.u, pattern_.get(), *base_, {});
}

void FiniteStatics::body_changed() {
  update_parts();
  renewal_.give_up();
  base_.reset();
}

/// Makes a base; false: the tangent is not positive definite.
bool FiniteStatics::renew(const std::vector<double>& u, fem::Tangent kind, Report& report) {
  const NewBaseTimer timer(report.new_bases);
  if (kind == fem::Tangent::projected) {
    base_ = projected_base(resting_.body(), u, pattern_.get(), report.factors,
                           linear_algebra::work_at_once());
    return base_ != nullptr;
  }
  ++report.factors;
  try {
    base_ = std::make_unique<FiniteBase>(resting_.body(), u, kind, pattern_.get(), fem::Inertia{},
                                         linear_algebra::work_at_once());
  } catch (const NumericalError&) {
    base_.reset();
  }
  return base_ != nullptr;
}

/// One that knows what is destroyed.
bool FiniteStatics::ensure_base(const std::vector<double>& u, Report& report) {
  if (base_ && !base_->follow(resting_, options_.most_rank)) base_.reset();
  if (!base_) {
    if (!renew(u, fem::Tangent::projected, report)) return false;
    if (options_.inverse && !parted_) base_->keep_inverse(linear_algebra::work_at_once());
  }
  report.rank = std::max(report.rank, base_->rank());
  return true;
}

/// state_ <- where to begin: the last state, turned as a whole with its grips, those moved and the
/// rest following as the base says; or the last step once more, where its energy is less. The base
/// is turned to there.
void FiniteStatics::predict(const FiniteTarget& target) {
  const bool pulled = target.grips != reached_.grips;
  state_.u = u_;
  if (pulled) {
    const auto turned = follow_grips_rigidly(body_.problem, u_, target.grips);
    if (!turned.empty()) state_.u = turned;
    if (options_.turn) base_->turn(resting_, state_.u);
  }
  potential_.evaluate(target, false, state_);
  if (pulled) move_grips(target);
  extrapolate(target);
  if (options_.turn) base_->turn(resting_, state_.u);
}

void FiniteStatics::extrapolate(const FiniteTarget& target) {
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

bool FiniteStatics::minimise(const FiniteTarget& target, int most, Report& report) {
  const auto result = minimiser_.minimise(target, base_.get(),
                                          {options_.tolerance, options_.residual}, most, state_);
  report.back_solves += result.back_solves;
  report.residual = result.residual;
  report.error = result.error;
  report.contraction = result.contraction;
  return result.at_rest;
}

/// Of the exact tangent where it is positive definite, else of the projected one.
bool FiniteStatics::by_new_factors(const FiniteTarget& target, int most, Report& report) {
  for (int i = 0; i < most; ++i) {
    suspected_ = !renew(state_.u, fem::Tangent::exact, report);
    if (suspected_ && !renew(state_.u, fem::Tangent::projected, report)) return false;
    if (minimise(target, kBackSolvesPerFactor, report)) return true;
  }
  return false;
}

/// Where volumes are pooled that hardly change.
bool FiniteStatics::by_kept_pressures(const FiniteTarget& target, Report& report) {
  if (!keeps_pressures_) return false;
  // What a patch has lost since makes J jump, but not the pressure that the body keeps.
  if (pressures_.size() != static_cast<std::size_t>(resting_.body().pools()->count())) {
    note_pressures();
  }
  probe_.u = predicted_;
  potential_.evaluate(target, false, probe_);
  if (!newton_with_pressures({potential_, minimiser_, pattern_.get()}, target, pressures_,
                             kNearRest, options_.most_factors, probe_, report.factors)) {
    return false;
  }
  std::swap(state_, probe_);
  return by_new_factors(target, kFactorsToFinish, report);
}

/// Of the last state at rest.
void FiniteStatics::note_pressures() {
  const fem::PatchVolumes volumes(resting_.body(), u_);
  pressures_.assign(volumes.pressure().begin(), volumes.pressure().end());
}

/// From the last state at rest; false: not found, and that state stays.
bool FiniteStatics::approach(const FiniteTarget& target, Report& report) {
  if (!ensure_base(u_, report)) return false;
  predict(target);
  if (!std::isfinite(state_.potential)) return false;
  if (keeps_pressures_) predicted_ = state_.u;
  if (!minimise(target, options_.most_back_solves, report) && !by_kept_pressures(target, report) &&
      !by_new_factors(target, options_.most_factors, report)) {
    return false;
  }
  if (suspected_ && !leave_saddle(target, report)) return false;
  rest_at(target);
  return true;
}

/// state_ is at rest under the target.
void FiniteStatics::rest_at(const FiniteTarget& target) {
  before_ = std::move(u_);
  begin_ = std::move(reached_);
  u_ = state_.u;
  reached_ = target;
  acting_ = state_.acting;
  std::swap(shown_, state_);
  if (keeps_pressures_) note_pressures();
}

/// From state_, at rest, to a stable one. The lowest mode decides to which side: that on which its
/// largest component is positive.
bool FiniteStatics::leave_saddle(const FiniteTarget& target, Report& report) {
  suspected_ = false;
  for (int i = 0; i < kMostPushes; ++i) {
    const LowestMode mode = lowest_mode(resting_, state_.u, pattern_.get());
    report.factors += mode.factors;
    if (!(mode.stiffness < 0) || !push(target, mode.shape)) return true;
    ++report.buckled;
    if (!renew(state_.u, fem::Tangent::projected, report)) return false;
    if (!minimise(target, options_.most_back_solves, report) &&
        !by_new_factors(target, options_.most_factors, report)) {
      return false;
    }
  }
  return true;
}

/// As far along the mode as the energy falls; false: it does not.
bool FiniteStatics::push(const FiniteTarget& target, const Eigen::VectorXd& mode) {
  const double unit = size_of(body_.problem) / mode.cwiseAbs().maxCoeff();
  potential_.evaluate(target, false, state_);
  const std::vector<double> from = state_.u;
  bool falls = false;
  for (double part = kFirstPush; part <= kLastPush; part *= kPushGrowth) {
    potential_.move(from, part * unit, mode, probe_.u);
    potential_.evaluate(target, false, probe_);
    if (!(probe_.potential < state_.potential)) break;
    std::swap(state_, probe_);
    falls = true;
  }
  return falls;
}

/// In steps of the load; false: no equilibrium is near.
bool FiniteStatics::climb(const FiniteTarget& end, Report& report) {
  const FiniteTarget begin = reached_;
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
    suspected_ = false;
    step /= 2;
    const bool same = begin.grips == end.grips && begin.force == end.force;
    if (step < least || same) return false;
  }
  return true;
}

void FiniteStatics::follow_path(const FiniteTarget& end, Report& report) {
  DampedPath::Cost cost;
  report.unfinished = true;
  while (report.damped_steps < options_.most_damped_steps) {
    if (path_.steps() == options_.most_path_steps || !path_.step(end, cost)) {
      path_.end();
      report.unfinished = false;
      break;
    }
    ++report.damped_steps;
    report.residual = minimiser_.residual(path_.state());
    if (!(report.residual <= kNearRest)) continue;
    state_ = path_.state();
    if ((renew(state_.u, fem::Tangent::projected, report) &&
         minimise(end, options_.most_back_solves, report)) ||
        by_new_factors(end, kFactorsToFinish, report)) {
      if (suspected_ && !leave_saddle(end, report)) continue;
      path_.end();
      rest_at(end);
      report.at_rest = true;
      report.unfinished = false;
      report.share = 1;
      break;
    }
  }
  report.back_solves += cost.back_solves;
  report.factors += cost.factors;
  if (!report.at_rest) base_.reset();
}

FiniteStaticsReport FiniteStatics::solve(const Load& load) {
  Report report;
  report.frozen = resting_.parts();
  const FiniteTarget end = potential_.target(load);
  if (before_.empty()) {  // the body has changed, and what acts with it
    state_.u = u_;
    potential_.evaluate(reached_, false, state_);
    acting_ = state_.acting;
  }
  FiniteScale scale = scale_;
  scale.force = std::max(scale.force, acting_);
  minimiser_.set_scale(scale);
  take_renewed(report);
  if (!path_.running()) {
    step_begin_ = u_;
    step_begin_target_ = reached_;
    report.at_rest = climb(end, report);
    climbed_ = report.share;
    if (!report.at_rest) path_.begin(u_);
  }
  if (path_.running()) follow_path(end, report);
  if (report.at_rest) {
    renew_if_due(end, report);
    return report;
  }
  report.share = climbed_;
  if (!report.unfinished) go_back();
  shown_.u = report.unfinished ? path_.state().u : u_;
  potential_.evaluate(end, false, shown_);
  return report;
}

/// To the rest before the step, whatever was found on its way.
void FiniteStatics::go_back() {
  u_ = step_begin_;
  reached_ = step_begin_target_;
  before_.clear();
}

/// At their counts, not when they are ready.
void FiniteStatics::take_renewed(Report& report) {
  ++since_asked_;
  if (renewal_.base_asked() && since_asked_ >= options_.taken_after) {
    const NewBaseTimer timer(report.new_bases);
    if (auto base = renewal_.take_base()) base_ = std::move(base);
  }
  if (renewal_.judgement_asked() && since_asked_ >= 2 * options_.taken_after) {
    judged(renewal_.take_stable());
  }
}

void FiniteStatics::judged(bool stable) {
  since_check_ = 0;
  check_after_ =
      stable ? std::min(2 * check_after_, options_.check_after_most) : options_.check_after;
  if (!stable) suspected_ = true;
}

/// A judgement that is on its way alone makes room for a base.
void FiniteStatics::ask(bool base, bool judgement) {
  const bool on_its_way =
      renewal_.base_asked() || (renewal_.judgement_asked() && !(base && judged_alone_));
  if (on_its_way || !(base || judgement)) return;
  since_asked_ = 0;
  judged_alone_ = !base;
  if (base) worn_ = 0;
  renewal_.ask(resting_.body(), u_, pattern_.get(), base, judgement);
}

/// After a step that came to rest: a base of that state where steps have become hard, and at times
/// whether that rest is stable.
void FiniteStatics::renew_if_due(const FiniteTarget& end, Report& report) {
  ++since_check_;
  worn_ += std::max(0, report.back_solves - kOfAGoodBase);
  const bool hard = worn_ > options_.renew_after || report.rank > options_.most_rank / 2;
  if (hard) check_after_ = options_.check_after;
  // The linear law has one rest, which is stable.
  const bool check = !linear_ && (first_ || since_check_ >= check_after_);
  if (options_.taken_after > 0 && !first_) {
    ask(hard, check);
    return;
  }
  if (!hard && !check) return;
  first_ = false;
  worn_ = 0;
  {
    const NewBaseTimer timer(report.new_bases);
    if (auto base = base_at_rest(resting_.body(), u_, pattern_.get(), report.factors,
                                 linear_algebra::work_at_once())) {
      if (options_.inverse) base->keep_inverse(linear_algebra::work_at_once());
      base_ = std::move(base);
    }
  }
  if (!check) return;
  ++report.factors;
  judged(is_stable(resting_.body(), u_, pattern_.get(), linear_algebra::work_at_once()));
  if (!suspected_) return;
  state_ = shown_;
  const Report at_rest = report;
  if (leave_saddle(end, report)) {
    rest_at(end);
    return;
  }
  report.residual = at_rest.residual;  // the rest stays: what was tried beyond it is not its error
  report.error = at_rest.error;
  report.contraction = at_rest.contraction;
}

}  // namespace sunder::solver
