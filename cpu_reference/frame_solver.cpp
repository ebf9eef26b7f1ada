// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/frame_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "engine/instrument_block.hpp"
#include "engine/load_room.hpp"
#include "engine/stress_bounds.hpp"
#include "sunder/error.hpp"

namespace sunder::cpu_reference {
namespace {

// A full check refines silently down to these stress errors, for the yardstick a tenth of what
// double precision promises for an intact body; only frames over the scene's tolerance count as
// polished.
constexpr double kReferenceError = 1e-10, kDeferredError = 1e-9;
constexpr int kRefinements = 4;
// What double precision promises of a damaged body.
constexpr double kDamagedError = 1e-8;
// The errors of a fresh base and of those events later differ by less where it is the body that
// lets them be no smaller.
constexpr double kLikeFresh = 10;
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

FrameSolver::FrameSolver(const ChosenRoute& chosen, const DamagedBody& body,
                         const IntactBody* intact, InverseRoute& route, FrameFields& fields)
    : chosen_(chosen),
      body_(body),
      intact_(intact),
      route_(route),
      fields_(fields),
      anchors_(engine::anchors_of(problem())),
      keeps_(std::min(kDamagedError, tolerance())) {
  if (fields.region()) {
    energy_checks_.emplace(problem());
  } else if (route.deferred()) {
    checks_.emplace(problem());
    fields.keep_forces();
  }
  engine::reserve(load_, problem());
  force_.setZero(problem().dof_count());
  u_ = force_;
  reactions_.assign(problem().gripped_dofs().size(), 0.0);
}

void FrameSolver::set_load(const Load& load) {
  for (Index d : load_.force_dofs) force_[d] = 0;
  load_ = load;
  for (std::size_t i = 0; i < load.forces.size(); ++i) force_[load.force_dofs[i]] = load.forces[i];
}

void FrameSolver::event() {
  if (!energy_checks_) return;
  for (engine::EnergyCheck& check : energy_checks_->all()) check.event();
}

SolveReport FrameSolver::solve() { return energy_checks_ ? solve_condensed() : solve_everywhere(); }

SolveReport FrameSolver::solve_everywhere() {
  SolveReport report;
  check_ = check_of_load();
  const auto scale = check_ ? check_->scale_of(load_, route_.bases()) : std::nullopt;
  route_.set_enough(scale ? check_->enough(*scale) : 0);
  solve_by(route_, report);
  const auto known =
      scale && route_.deferred()->converged() ? check_->error(*scale, solution()) : std::nullopt;
  if (known) {
    report.error = *known;
  } else {
    check_fully(report);
  }
  if (!by_fields()) hand_out();
  fields_.publish(route_);
  return report;
}

/// Nothing: the route is checked fully in any case.
engine::FrameCheck* FrameSolver::check_of_load() {
  if (!checks_) return nullptr;
  for (engine::FrameCheck& check : checks_->all())
    check.follow(route_.bases(), route_.base_check());
  return &checks_->of(load_, route_.bases());
}

/// A condensed frame has no residual outside its region: the energy of what damage lacks bounds
/// its error.
SolveReport FrameSolver::solve_condensed() {
  for (engine::EnergyCheck& each : energy_checks_->all())
    each.follow(route_.bases(), route_.base_check());
  engine::EnergyCheck& check = energy_checks_->of(load_, route_.bases());
  if (const auto known = solve_on_region(check)) {
    fields_.publish(route_);
    return *known;
  }
  route_.set_enough(0);
  SolveReport report;
  solve_by(route_, report);
  check_fully(report);
  hand_out();
  fields_.publish_everywhere(u_);
  check.checked(load_, report, unrefined_, route_.bases(), largest_in_region(), largest_);
  return report;
}

/// The solution without a full check, where one like it has had its check.
std::optional<SolveReport> FrameSolver::solve_on_region(engine::EnergyCheck& check) {
  const auto expected = check.expected(load_, route_.bases());
  if (!expected) return std::nullopt;
  route_.set_enough(check.enough(*expected));
  route_.solve(load_, force_, u_);
  hand_out();
  const auto gripped = problem().gripped_dofs();
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    reactions_[g] = grip_force(g) - anchors_[g] * u_[gripped[g]];  // the anchor's share
  }
  return check.known(*expected, route_.deferred()->defect_energy(), largest_in_region(), largest_);
}

/// The solution by a route, with its residual.
void FrameSolver::solve_by(InverseRoute& route, SolveReport& report) {
  report.iterations += route.solve(load_, force_, u_).iterations;
  route.complete(u_);
  look_at(report);
}

/// Residual f - K u and reactions of the solution, and its largest stress.
void FrameSolver::look_at(SolveReport& report) {
  if (by_fields()) {
    hand_out();
    fields_.forces(product_);
  } else {
    body_.apply(u_, product_);
    largest_ = body_.largest_stress(u_);
  }
  r_ = force_ - product_;
  const auto gripped = problem().gripped_dofs();
  double load_norm = force_.squaredNorm();
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    reactions_[g] = -r_[gripped[g]];  // what the grip adds to the applied force
    load_norm += reactions_[g] * reactions_[g];
    r_[gripped[g]] = 0;
  }
  free_residual_ = r_.norm();
  report.residual = load_norm > 0 ? free_residual_ / std::sqrt(load_norm) : 0.0;
}

/// Displacement at all nodes, and its stress.
void FrameSolver::hand_out() {
  if (const auto largest = fields_.take(u_)) largest_ = *largest;
}

void FrameSolver::check_fully(SolveReport& report) {
  refine(route_, report);
  if (!(report.error <= tolerance()) || is_off(report.error)) polish(report);
  if (!(report.error <= tolerance())) fail(report);
}

/// Corrects the solution by a route until the estimate is rounding's.
void FrameSolver::refine(InverseRoute& route, SolveReport& report) {
  const double enough = checks_ || !intact_ ? kDeferredError : kReferenceError;
  report.error = std::numeric_limits<double>::infinity();
  for (int attempt = 0;; ++attempt) {
    const double stress = correction(route, report);
    const double error = stress == 0 ? 0.0 : stress / largest_;
    if (attempt == 0) {
      unrefined_ = error;
      if (check_ && &route == &route_) {
        check_->checked(load_, solution(), stress, route_.bases());
      }
      report.polished = report.polished || !(error <= tolerance());
    }
    // A correction that no longer shrinks is rounding.
    const bool stalled = attempt > 0 && !(error < report.error / 2);
    report.error = error;
    if (!std::isfinite(error)) return;  // overflow: there is no correction
    const bool done = error <= enough && (attempt > 0 || !yardstick());
    if (done || attempt == kRefinements || stalled) return;
    u_ += du_;
    look_at(report);
  }
}

/// du = A^-1 (f - K u); returns its largest stress over live elements, infinite where it was not
/// found.
double FrameSolver::correction(InverseRoute& route, SolveReport& report) {
  if (!std::isfinite(report.residual)) return report.residual;
  const Applied applied = route.apply(r_, du_);
  report.iterations += applied.iterations;
  if (!applied.converged) return std::numeric_limits<double>::infinity();
  return by_fields() ? fields_.largest_stress(du_) : body_.largest_stress(du_);
}

/// More than double precision promises, more than rounding explains, and more than a fresh base
/// came to.
bool FrameSolver::is_off(double error) const {
  if (!(error > keeps_)) return false;
  return error > kRoundings * engine::stress_of_rounding(problem(), largest_u()) / largest_;
}

/// Refinement converges only while the updated inverse is one; once it has drifted too far it is
/// computed anew, and if that is not enough conjugate gradients on the intact base have the word.
void FrameSolver::polish(SolveReport& report) {
  if (route_.rebase()) {
    solve_by(route_, report);
    refine(route_, report);
  }
  if (!(report.error <= tolerance()) && chosen_.route != Route::cg) {
    const auto cg = conjugate_gradient_route(body_, *intact_);
    solve_by(*cg, report);
    refine(*cg, report);
  }
  keeps_ = std::max(keeps_, std::min(kLikeFresh * report.error, tolerance()));
}

/// The plain routes are what others are measured by: they refine once in any case.
bool FrameSolver::yardstick() const {
  return (chosen_.route == Route::cg && intact_) ||
         (chosen_.route == Route::inverse && chosen_.update == Update::eager);
}

double FrameSolver::grip_force(std::size_t g) const {
  return route_.deferred()->grip_forces()[static_cast<Eigen::Index>(g)];
}

double FrameSolver::largest_u() const { return u_.size() > 0 ? u_.cwiseAbs().maxCoeff() : 0.0; }

double FrameSolver::largest_in_region() const {
  double largest = 0;
  for (Index d : fields_.region()->dofs) largest = std::max(largest, std::abs(u_[d]));
  return largest;
}

engine::FrameCheck::Solution FrameSolver::solution() const {
  return {free_residual_, largest_u(), largest_};
}

}  // namespace sunder::cpu_reference
