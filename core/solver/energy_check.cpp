// SPDX-License-Identifier: Apache-2.0
#include "solver/energy_check.hpp"

#include <algorithm>
#include <cmath>

#include "solver/stress_bounds.hpp"

namespace sunder::solver {
namespace {

// A bound on the stress error that needs no closer look: what double precision promises along a
// crack, or a tenth of the scene's tolerance.
constexpr double kEnough = 1e-8;
// What a base gives wrong grows with the forces of the damage: they reach 30 times the load as a
// board opens.
constexpr double kAmplified = 100;
// The deferred update stops refining here: its last step gains some digits more.
constexpr double kRefined = 1e-10;
// A displacement so many times that of the last full check (a piece has come loose) needs another.
constexpr double kGrowth = 10;
// The bound by energy is of the worst element there is. What a refinement has changed stress by is
// some thousandths of it, and stays within so many times that for so many events.
constexpr double kAllowance = 100;
constexpr int kEventsOfAWorth = 16;
// What rounding of the displacement costs by its bound, so many times.
constexpr double kRoundings = 10;

}  // namespace

EnergyCheck::EnergyCheck(const Problem& problem)
    : problem_(problem),
      stress_of_rounding_(solver::stress_of_rounding(problem, 1)),
      stress_of_energy_(solver::largest_stress_of_energy(problem)),
      known_(problem) {}

void EnergyCheck::checked(const Load& load, const SolveReport& report, double unrefined,
                          double mended, int bases, double largest_u, double largest) {
  report_ = report;
  worth_ = HUGE_VAL;
  if (!takes(load)) of_factor_ = HUGE_VAL;  // of loads on other unknowns
  if (unrefined > 0) {                      // an exact solution says nothing about others
    of_factor_ = std::isfinite(of_factor_) ? std::max(of_factor_, unrefined) : unrefined;
  }
  known_.checked(load, {std::max(unrefined, mended), 0, largest_u, largest}, bases);
}

void EnergyCheck::refined(const Load& load, double unrefined, double energy, int bases,
                          double largest_u, double largest) {
  const bool found = energy > 0 && unrefined > 0;
  worth_ = found ? kAllowance * unrefined * largest / std::sqrt(energy) : HUGE_VAL;
  worth_base_ = bases;
  worth_events_ = kEventsOfAWorth;
  known_.checked(load, {std::max(unrefined, of_factor_), 0, largest_u, largest}, bases);
}

void EnergyCheck::forget() {
  known_.forget();
  of_factor_ = worth_ = HUGE_VAL;
}

void EnergyCheck::follow(int bases, const BaseCheck& check, int factor, bool drifts) {
  if (factor != factor_) of_factor_ = HUGE_VAL;
  factor_ = factor;
  if (known_.follow(bases, check) && !drifts) of_factor_ = check.error;
}

double EnergyCheck::energy_tolerance(const CheckedLoads::Sum& expected) const {
  const double e = kRefined * expected.largest_stress / stress_of_energy_;
  return e * e;
}

std::optional<SolveReport> EnergyCheck::known(const CheckedLoads::Sum& expected, double energy,
                                              double largest_u, double largest) const {
  if (!std::isfinite(largest)) return std::nullopt;  // the load is so large that stress overflows
  SolveReport report = report_;
  report.polished = false;
  report.iterations = 0;
  report.back_solves = 1;
  const double tolerance = problem_.scene().solver.tolerance;
  if (expected.fresh && expected.alone) {  // the solution of that check, before it was refined
    report.error = std::max(report.error, expected.error);
    if (report.error <= tolerance) return report;
  }
  if (!(largest_u <= kGrowth * expected.largest_u)) return std::nullopt;
  if (!(expected.largest_stress <= kGrowth * largest)) return std::nullopt;  // shares that cancel
  const double of_base = std::max(expected.error, expected.stress_error / largest),
               worth = std::min(stress_of_energy_, worth_),
               lacking = worth * std::sqrt(std::max(0.0, energy)) / largest;
  if (expected.fresh) {  // the same of a sum
    report.error = std::max(report.error, of_base) + lacking;
    if (report.error <= std::min(kEnough, tolerance)) return report;
  }
  report.error = kAmplified * of_base + lacking;
  if (!(report.error <= std::min(kEnough, tolerance / 10))) return std::nullopt;
  return report;
}

std::optional<SolveReport> EnergyCheck::known_refined(const CheckedLoads::Sum& expected,
                                                      double error, double largest_u,
                                                      double largest) const {
  if (!(largest > 0) || !std::isfinite(largest)) return std::nullopt;
  if (!(largest_u <= kGrowth * expected.largest_u)) return std::nullopt;
  if (!(expected.largest_stress <= kGrowth * largest)) return std::nullopt;  // shares that cancel
  SolveReport known = report_;
  known.polished = false;
  known.iterations = 0;
  known.error =
      error + kAmplified * of_factor_ + kRoundings * stress_of_rounding_ * largest_u / largest;
  if (!(known.error <= std::min(kEnough, problem_.scene().solver.tolerance / 10))) {
    return std::nullopt;
  }
  return known;
}

std::optional<SolveReport> EnergyCheck::known_by_base(const SolveReport& report, double unrefined,
                                                      double energy, double largest_u,
                                                      double largest) const {
  if (!(largest > 0) || !std::isfinite(largest)) return std::nullopt;
  if (!(unrefined > 0)) return std::nullopt;  // an exact solution says nothing about others
  SolveReport known = report;
  known.polished = false;
  known.iterations = 0;
  known.back_solves = 1;
  known.error = kAmplified * unrefined + kRoundings * stress_of_rounding_ * largest_u / largest +
                stress_of_energy_ * std::sqrt(std::max(0.0, energy)) / largest;
  if (!(known.error <= std::min(kEnough, problem_.scene().solver.tolerance / 10))) {
    return std::nullopt;
  }
  return known;
}

}  // namespace sunder::solver
