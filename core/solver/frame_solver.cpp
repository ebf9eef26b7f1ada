// SPDX-License-Identifier: Apache-2.0
#include "solver/frame_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "solver/check_terms.hpp"
#include "solver/load_room.hpp"
#include "solver/stress_bounds.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

constexpr int kRefinements = 8;
// A first refinement has not shown how much it gains. Had it taken a fifth of the error alone, four
// times what it changed would be left.
constexpr double kUnmeasured = 4;
// The errors of a fresh base and of those events later differ by less where it is the body that
// lets them be no smaller.
constexpr double kLikeFresh = 10;
// Iterations have no base; after so many events a full check is due as after a new one. The stress
// that a residual is worth stayed within 2.8 times over the 12, 9 and 9 events of scenes notch-b,
// board-pull-b and nearly-incompressible by Vulkan cg, of the ten that FrameCheck allows for.
constexpr int kEventsOfACheck = 16;
// What rounding of the displacement costs by its bound, so many times, is no fault of the base.
constexpr double kRoundings = 10;

[[noreturn]] void fail(const SolveReport& report) {
  std::ostringstream message;
  message << "the solution cannot be brought under the tolerance: estimated stress error "
          << report.error << ", residual " << report.residual
          << "; raise solver.tolerance or ease contrast, Poisson's ratio or slivers";
  throw NumericalError(message.str());
}

}  // namespace

FrameSolver::FrameSolver(const Problem& problem, FrameDevice& device)
    : problem_(problem),
      device_(device),
      precision_(device.precision()),
      kept_error_(std::min(precision_.kept, tolerance())) {
  if (device.condensed()) {
    energy_checks_.emplace(problem);
  } else if (device.deferred() || device.iterates()) {
    checks_.emplace(problem, precision_.promised);
  }
  reserve(last_.load, problem);
}

void FrameSolver::grips_changed() {
  last_.holds = false;
  checked_base_.other_grips = true;
  if (checks_) {
    for (FrameCheck& check : checks_->all()) check.forget();
  }
  if (energy_checks_) {
    for (EnergyCheck& check : energy_checks_->all()) check.forget();
  }
}

void FrameSolver::event() {
  last_.holds = false;
  ++events_;
  if (checks_) {
    for (FrameCheck& check : checks_->all()) check.event();
  }
  if (!energy_checks_) return;
  for (EnergyCheck& check : energy_checks_->all()) check.event();
}

std::shared_ptr<const FrameSolver::State> FrameSolver::state() const {
  return std::make_shared<const State>(*this);
}

void FrameSolver::restore(const State& state) {
  if (state.checks_) checks_.emplace(*state.checks_);
  if (state.energy_checks_) energy_checks_.emplace(*state.energy_checks_);
  kept_error_ = state.kept_error_;
  events_ = state.events_;
  last_ = state.last_;
  checked_base_ = state.checked_base_;
  checked_fully_ = state.checked_fully_;
  first_adds_ = state.first_adds_;
  check_ = nullptr;
  load_ = nullptr;
}

SolveReport FrameSolver::solve(const Load& load) {
  load_ = &load;
  everywhere_ = true;
  if (energy_checks_) return solve_condensed(load);
  if (auto report = solve_known(load)) return *report;
  last_.holds = false;
  const SolveReport report = solve_everywhere(load);
  if (!device_.residual_costs()) return report;
  last_ = {load, report, !refined_ && report.error <= std::min(precision_.promised, tolerance())};
  last_.report.polished = false;
  return report;
}

bool FrameSolver::known(const Load& load) const {
  return device_.residual_costs() && last_.holds && multiple(load, last_.load).has_value();
}

/// The solution is linear in the load: its relative error is the last one's.
std::optional<SolveReport> FrameSolver::solve_known(const Load& load) {
  if (!known(load)) return std::nullopt;
  SolveReport report = last_.report;
  report.iterations = device_.solve(0, Residual::none);
  report.back_solves = 1;
  if (!device_.finite()) return std::nullopt;
  return report;
}

SolveReport FrameSolver::solve_everywhere(const Load& load) {
  SolveReport report;
  refined_ = false;
  check_ = check_of(load);
  const auto expected = check_ ? check_->expected(load, bases()) : std::nullopt;
  // Where the last one had a full check this one may need it too.
  solve_once(expected ? check_->energy_tolerance(*expected) : 0,
             expected && !checked_fully_ ? Residual::size : Residual::whole, report);
  const auto known =
      expected && speaks_for_itself() ? check_->error(*expected, solution()) : std::nullopt;
  checked_fully_ = !known;
  if (known) {
    report.error = *known;
  } else {
    first_adds_ = first_adds_ || expected;  // it was not good enough to be known
    check_fully(report);
  }
  return report;
}

int FrameSolver::bases() const {
  return device_.deferred() ? device_.bases() : 1 + events_ / kEventsOfACheck;
}

/// Whether the residual of the solution in work says how good it is. Iterations do not see what
/// rounding of the products costs that they are made of.
bool FrameSolver::speaks_for_itself() const {
  if (const Deferred* deferred = device_.deferred()) return deferred->converged();
  return error_of_rounding() <= precision_.kept;
}

/// Nothing: the route is checked fully in any case.
FrameCheck* FrameSolver::check_of(const Load& load) {
  if (!checks_) return nullptr;
  for (FrameCheck& check : checks_->all()) check.follow(bases(), device_.base_check());
  return &checks_->of(load);
}

/// A condensed frame has no residual outside its region: the energy of what damage lacks bounds
/// its error.
SolveReport FrameSolver::solve_condensed(const Load& load) {
  for (EnergyCheck& each : energy_checks_->all()) {
    each.follow(device_.bases(), device_.base_check(), device_.factor(), device_.drifts());
  }
  EnergyCheck& check = energy_checks_->of(load);
  // The solution without a full check, where one like it has had its check.
  if (const auto expected = check.expected(load, device_.bases())) {
    const auto [largest_u, largest] = device_.solve_region(check.energy_tolerance(*expected));
    const Deferred& damage = *device_.deferred();
    const auto known =
        check.known(*expected, damage.defect_energy(), damage.forces(), largest_u, largest);
    const bool refines = device_.refines_region() &&  // and it could say something
                         check.known_refined(*expected, 0, largest_u, largest);
    if (known && !(refines && check.unseen())) {
      everywhere_ = false;
      return *known;
    }
    if (refines) {
      if (const auto refined = refine_on_region(check, *expected, load)) return *refined;
    }
  }
  if (auto known = solve_by_base(check)) return *known;
  SolveReport report;
  solve_once(0, Residual::whole, report);
  const int base = device_.bases();
  const double by_base = device_.deferred()->forces();
  check_fully(report);
  const double forces = device_.bases() == base ? by_base : 0;
  const auto [largest_u, largest] = device_.on_region();
  check.checked(load, report, unrefined_, device_.mended(), device_.bases(), forces, largest_u,
                largest);
  checked_base_ = {device_.bases(), std::max(unrefined_, device_.mended()), report, false};
  return report;
}

/// Corrects a solution of the region by the factor's own inverse, until what the last time has
/// changed is little enough: a full check takes two solutions of the whole body. Nothing: it needs
/// that.
std::optional<SolveReport> FrameSolver::refine_on_region(EnergyCheck& check,
                                                         const CheckedLoads::Sum& expected,
                                                         const Load& load) {
  double energy = device_.deferred()->defect_energy();
  double error = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt <= kRefinements; ++attempt) {
    const auto refined = device_.refine_region();
    if (!refined) return std::nullopt;
    const auto [largest_u, largest] = refined->solution;
    const double before = error;
    error = refined->stress / largest;
    if (attempt == 0) unrefined_ = error;
    // From the second time on the base's own error is mended, and what damage lacks stands alone.
    if (attempt > 0) energy = device_.deferred()->defect_energy();
    // What the first time leaves is unknown: less than what it has changed, with room.
    const double left = attempt == 0 ? kUnmeasured * error : error;
    if (auto report = check.known_refined(expected, left, largest_u, largest)) {
      if (attempt == 0 && check.wants_worth(unrefined_, device_.bases())) continue;
      report->back_solves = 2 + attempt;
      check.refined(load, unrefined_, {error, energy, attempt > 0}, device_.bases(),
                    device_.deferred()->forces(), largest_u, largest);
      everywhere_ = false;
      return report;
    }
    if (error <= precision_.refined || !(error < before / 2)) break;
  }
  return std::nullopt;
}

/// Under loads of grips that have come or gone since the last full check; nothing: it needs one.
std::optional<SolveReport> FrameSolver::solve_by_base(const EnergyCheck& check) {
  if (!checked_base_.other_grips || checked_base_.number != device_.bases()) return std::nullopt;
  const auto [largest_u, largest] = device_.solve_region(0);
  auto known = check.known_by_base(checked_base_.report, checked_base_.unrefined,
                                   device_.deferred()->defect_energy(), largest_u, largest);
  if (known) everywhere_ = false;
  return known;
}

void FrameSolver::solve_once(double energy_tolerance, Residual residual, SolveReport& report) {
  report.iterations += device_.solve(energy_tolerance, residual);
  ++report.back_solves;
  read_balance(report);
}

void FrameSolver::read_balance(SolveReport& report) {
  balance_ = device_.balance();
  report.residual =
      balance_.load_squared > 0 ? balance_.residual / std::sqrt(balance_.load_squared) : 0.0;
}

void FrameSolver::check_fully(SolveReport& report) {
  // Where rounding may cost that much no estimate by the usual residual shows it.
  const bool by_elements = error_of_rounding() > precision_.kept && device_.sum_by_elements(true);
  refine(report, !by_elements);
  if (!by_elements && !(report.error <= precision_.kept) && device_.sum_by_elements(true)) {
    refine(report, false);
  }
  if (!(report.error <= tolerance()) || misses_precision(report.error)) polish(report);
  device_.sum_by_elements(false);
  if (!(report.error <= tolerance())) fail(report);
}

/// Whether to add a correction before it is known: it is likely to be needed, and that costs less.
/// `before`: error of the last one.
bool FrameSolver::adds_at_once(int attempt, double before) const {
  if (!device_.adds_at_once() || attempt == kRefinements) return false;
  // Each leaves about the same share of what there was.
  return attempt == 0 ? first_adds_ : before * unrefined_ > precision_.refined;
}

/// Corrects the solution until the estimate is rounding's. One that was added before it was known
/// to be small enough has made the solution better.
void FrameSolver::refine(SolveReport& report, bool by_base) {
  report.error = std::numeric_limits<double>::infinity();
  bool stalled = false;
  for (int attempt = 0;; ++attempt) {
    double stress = std::numeric_limits<double>::infinity();  // overflow
    const bool added = !stalled && adds_at_once(attempt, report.error);
    if (std::isfinite(report.residual) && std::isfinite(balance_.largest_stress)) {
      const FrameDevice::Correction correction = device_.correct(added);
      report.iterations += correction.iterations;
      ++report.back_solves;
      stress = correction.stress;
    }
    const double error = stress == 0             ? 0.0
                         : std::isfinite(stress) ? stress / balance_.largest_stress
                                                 : stress;
    if (attempt == 0) {
      unrefined_ = error;
      if (check_ && by_base) check_->checked(*load_, solution(), stress, bases());
      report.polished = report.polished || !(error <= tolerance());
    }
    // A correction that no longer shrinks is rounding. One that was added has another look.
    stalled = attempt > 0 && !(error < report.error / 2);
    report.error = error;
    if (!std::isfinite(error)) {  // there is no correction
      if (added) solve_once(0, Residual::whole, report);
      return;
    }
    const bool done = error <= precision_.refined && (attempt > 0 || !device_.yardstick()),
               ends = done || attempt == kRefinements || (stalled && !added);
    if (attempt == 0) first_adds_ = !ends;
    if (ends && !added) return;
    if (!added) device_.add_correction();
    refined_ = true;
    read_balance(report);
    if (ends) return;
  }
}

/// More than the precision promises, more than rounding explains, and more than a fresh base came
/// to.
bool FrameSolver::misses_precision(double error) const {
  return error > kept_error_ && error > error_of_rounding();
}

/// What rounding of the displacement may cost the stress, with room.
double FrameSolver::error_of_rounding() const {
  if (!stress_of_1_mm_) stress_of_1_mm_ = stress_of_rounding(problem_, 1);
  return kRoundings * *stress_of_1_mm_ * balance_.largest_u / balance_.largest_stress;
}

/// Refinement converges only while the updated inverse is one; once it has drifted too far it is
/// computed anew, and if that is not enough conjugate gradients on the intact base have the word.
void FrameSolver::polish(SolveReport& report) {
  if (device_.rebase()) {
    solve_once(0, Residual::whole, report);
    refine(report, true);
  }
  if (!(report.error <= tolerance()) && device_.fall_back(true)) {
    const double of_base = unrefined_;
    solve_once(0, Residual::whole, report);
    refine(report, false);
    unrefined_ = of_base;
    device_.fall_back(false);
  }
  kept_error_ = std::max(kept_error_, std::min(kLikeFresh * report.error, tolerance()));
}

FrameCheck::Solution FrameSolver::solution() const {
  return {balance_.residual, balance_.largest_u, balance_.largest_stress};
}

}  // namespace sunder::solver
