// SPDX-License-Identifier: Apache-2.0
#include "bench/study/finite_body.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/study/yardstick.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/finite_newton.hpp"

namespace sunder::bench {
namespace {

constexpr double kSide = kFiniteSide;
constexpr int kMostCalls = 400;  // of a step whose path goes on
constexpr double kMostContrast = 1e4, kNewtonResidual = 1e-7;
constexpr double kSameState = 1e-2;  // of the tolerance's own scale: a state found again

Needs needs() {
  Needs needs;
  needs.stress = needs.damage = true;
  return needs;
}

/// Where there is none, as after a rigid motion, a millionth of the material's modulus is as
/// good.
double stress_error(std::span<const std::uint8_t> destroyed, std::span<const Voigt> found,
                    std::span<const Voigt> exact) {
  double apart = 0, most = 1e-6 * 5;
  for (std::size_t e = 0; e < found.size(); ++e) {
    if (destroyed[e]) continue;
    const double d = test::tensor_norm(found[e] - exact[e]);
    if (!std::isfinite(d)) return d;
    apart = std::max(apart, d);
    most = std::max(most, test::tensor_norm(exact[e]));
  }
  return apart / most;
}

}  // namespace

FiniteBodyOfStudy::FiniteBodyOfStudy(const FiniteCell& cell, const SolverOptions& solver)
    : contrast_(cell.contrast),
      problem_(std::make_shared<Problem>(finite_scene(cell, solver))),
      criterion_(make_criterion(*problem_)),
      loads_(*problem_),
      backend_(std::move(create_backend(problem_, needs()).backend)) {
  at_ = load_of({});
}

StepOutcome FiniteBodyOfStudy::take(const Step& step) {
  StepOutcome outcome;
  if (!step.destroyed.empty()) backend_->destroy(step.destroyed);
  const Load load = load_of(step.hands);
  const std::vector<double> before = displacement();
  try {
    SolveReport report = solve(load, outcome);
    outcome.estimate = report.error;
    if (report.unfinished) {
      outcome.verdict = "unfinished";
      return outcome;
    }
    at_ = load;
    judge(load, step.rigid, outcome);
  } catch (const NumericalError& error) {
    outcome.verdict = "refused";
    outcome.reason = error.what();
    if (displacement() != before) {
      outcome.reason += "; what can be read then is no state at rest";
    }
    if (!usable(before, step.destroyed.empty())) {
      outcome.verdict = "WRONG";
      outcome.reason = "the state before is lost after: " + outcome.reason;
    }
  }
  return outcome;
}

Load FiniteBodyOfStudy::load_of(const Hands& hands) {
  loads_.drive(0, hands.lower);
  loads_.turn(0, hands.lower_turn);
  loads_.drive(1, hands.upper);
  loads_.turn(1, hands.upper_turn);
  std::vector<Finding> findings;
  loads_.update(0, *criterion_, backend_->destroyed(), findings);
  return loads_.load();
}

std::vector<double> FiniteBodyOfStudy::displacement() const {
  std::vector<double> u(problem_->dofs().size());
  if (solved_) backend_->read_displacement(u);
  return u;
}

SolveReport FiniteBodyOfStudy::solve(const Load& load, StepOutcome& outcome) {
  backend_->set_load(load);
  SolveReport report;
  do {
    report = backend_->solve();
    solved_ = true;
    outcome.back_solves += report.back_solves;
  } while (report.unfinished && ++outcome.calls < kMostCalls);
  return report;
}

/// The load before can be solved again, and where nothing has left that leads back.
bool FiniteBodyOfStudy::usable(const std::vector<double>& before, bool same_body) {
  StepOutcome again;
  try {
    if (solve(at_, again).unfinished) return true;
  } catch (const NumericalError&) {
    return !same_body;
  }
  double apart = 0, most = 0;
  const std::vector<double> u = displacement();
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (!std::isfinite(u[i])) return false;
    apart = std::max(apart, std::abs(u[i] - before[i]));
    most = std::max(most, std::abs(before[i]));
  }
  return !same_body || apart <= kSameState * std::max(most, 1e-3 * kSide);
}

void FiniteBodyOfStudy::judge(const Load& load, bool rigid, StepOutcome& outcome) {
  backend_->stress();
  const std::vector<double> u = displacement();
  std::vector<Voigt> stress(problem_->mesh().tets.size());
  backend_->read_stress(stress);
  outcome.deformation = backend_->deformation();
  const std::vector<std::uint8_t> destroyed(backend_->destroyed().begin(),
                                            backend_->destroyed().end());
  if (!std::all_of(u.begin(), u.end(), [](double x) { return std::isfinite(x); })) {
    outcome.verdict = "WRONG";
    outcome.reason = "not a number";
    return;
  }
  if (rigid) {  // what the yardstick's residual is measured by is rounding then
    const std::vector<Voigt> none(stress.size(), Voigt::Zero());
    outcome.stress_error = stress_error(destroyed, stress, none);
  } else if (!compare(load, destroyed, u, stress, outcome)) {
    return;
  }
  const double share = outcome.stress_error / problem_->scene().solver.tolerance;
  outcome.verdict = share <= 1 ? "right" : share <= kBand ? "over" : "WRONG";
}

/// Where the body rests, sought from u: by the yardstick; by the study's own, which keeps its
/// displacement in extended precision throughout (the other rounds it to double precision between
/// its iterations, which in a stiff frame or layer is more force than it lets stay) and knows
/// pooled volume; by Newton's method with the library's own tangent. Empty: none comes to rest.
FiniteBodyOfStudy::Rest FiniteBodyOfStudy::rest_from(const Load& load,
                                                     std::span<const std::uint8_t> destroyed,
                                                     const std::vector<double>& u,
                                                     std::string& reason) const {
  const bool pools = pools_volume(*problem_);
  const plain::FiniteBody yardstick(*problem_, destroyed);
  if (!pools) {
    try {
      if (contrast_ > kMostContrast) throw std::runtime_error("too stiff a frame");
      const auto rest = yardstick.solve(load, u).displacement;
      return {rest, yardstick.stress(rest, StressMeasure::cauchy)};
    } catch (const std::runtime_error& error) {
      reason = std::string("yardstick: ") + error.what();
    }
  }
  try {
    const auto rest = Yardstick(*problem_, destroyed).solve(load, u);
    return {rest.u, rest.stress};
  } catch (const std::runtime_error& error) {
    reason += (reason.empty() ? "" : "; ") + std::string("the study's: ") + error.what();
  }
  const auto rest = by_newton(load, destroyed, u);
  if (rest.empty() || pools) return {};
  reason += "; Newton with the library's tangent instead";
  return {rest, yardstick.stress(rest, StressMeasure::cauchy)};
}

/// False: no yardstick comes to rest.
bool FiniteBodyOfStudy::compare(const Load& load, std::span<const std::uint8_t> destroyed,
                                const std::vector<double>& u, std::span<const Voigt> stress,
                                StepOutcome& outcome) {
  const Rest rest = rest_from(load, destroyed, u, outcome.reason);
  if (rest.u.empty()) {
    outcome.verdict = "no yardstick";
    return false;
  }
  outcome.u_error = test::displacement_error(problem_->mesh(), destroyed, u, rest.u);
  outcome.stress_error = stress_error(destroyed, stress, rest.stress);
  return true;
}

/// Empty: its tangent is indefinite, or its residual stays.
std::vector<double> FiniteBodyOfStudy::by_newton(const Load& load,
                                                 std::span<const std::uint8_t> destroyed,
                                                 const std::vector<double>& u) const {
  const auto laws = fem::laws_of(*problem_);
  try {
    const auto rest = test::newton({*problem_, laws, destroyed}, load, u);
    if (rest.residual <= kNewtonResidual) return rest.u;
  } catch (const NumericalError&) {
  }
  return {};
}

}  // namespace sunder::bench
