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
// A base that drifts has come with events laid over it since it was checked: one gave 280 times as
// much wrong as its check had found.
constexpr double kAmplifiedUnseen = 1000;
// Where they are known it grows with them alone, and by where they act: within so many events it
// came to no more than 2.9 times what those forces explain (11,800 pairs of frames along tears of
// 1,000 to 10,338 unknowns).
constexpr int kRecentEvents = 8;
constexpr double kRecent = 5;
// The deferred update stops refining here: its last step gains some digits more.
constexpr double kRefined = 1e-10;
// A displacement so many times that of the last full check (a piece has come loose) needs another.
constexpr double kGrowth = 10;
// The bound by energy is of the worst element there is. What a refinement has changed stress by is
// some thousandths of it, and stays within so many times that for so many events.
constexpr double kAllowance = 100;
constexpr int kEventsOfAWorth = 16;
// Of what damage lacks alone it stayed within 52 times for so many (197,000 pairs of frames of the
// same tears; 99 of 100 within 4 times).
constexpr int kEventsOfAWorthAlone = 64;
// What rounding of the displacement costs by its bound, so many times.
constexpr double kRoundings = 10;

}  // namespace

EnergyCheck::EnergyCheck(const Problem& problem)
    : problem_(problem),
      stress_of_rounding_(solver::stress_of_rounding(problem, 1)),
      stress_of_energy_(solver::largest_stress_of_energy(problem)),
      known_(problem) {}

void EnergyCheck::checked(const Load& load, const SolveReport& report, double unrefined,
                          double mended, int bases, double forces, double largest_u,
                          double largest) {
  report_ = report;
  unseen_ = false;
  forget_worth();
  if (!takes(load)) of_factor_ = HUGE_VAL;  // of loads on other unknowns
  if (unrefined > 0) {                      // an exact solution says nothing about others
    of_factor_ = std::isfinite(of_factor_) ? std::max(of_factor_, unrefined) : unrefined;
  }
  known_.checked(load, {std::max(unrefined, mended), 0, largest_u, largest, forces}, bases);
}

void EnergyCheck::refined(const Load& load, double unrefined, const Lack& last, int bases,
                          double forces, double largest_u, double largest) {
  unseen_ = false;
  if (last.alone || !knows_worth(bases)) {
    const bool found = last.energy > 0 && last.error > 0;
    worth_ = found ? kAllowance * last.error * largest / std::sqrt(last.energy) : HUGE_VAL;
    worth_base_ = bases;
    worth_events_ = last.alone ? kEventsOfAWorthAlone : kEventsOfAWorth;
    worth_alone_ = last.alone;
  }
  known_.checked(load, {std::max(unrefined, of_factor_), 0, largest_u, largest, forces}, bases);
}

bool EnergyCheck::knows_worth(int bases) const {
  return worth_alone_ && worth_base_ == bases && worth_events_ > 0;
}

bool EnergyCheck::wants_worth(double unrefined, int bases) const {
  return kRecent * unrefined <= kEnough && !knows_worth(bases);
}

void EnergyCheck::forget() {
  known_.forget();
  unseen_ = false;
  of_factor_ = HUGE_VAL;
  forget_worth();
}

void EnergyCheck::forget_worth() {
  worth_ = HUGE_VAL;
  worth_events_ = 0;
}

void EnergyCheck::follow(int bases, const BaseCheck& check, int factor, bool drifts) {
  if (factor != factor_) of_factor_ = HUGE_VAL;
  factor_ = factor;
  if (!known_.follow(bases, check)) return;
  unseen_ = drifts;
  if (!drifts) of_factor_ = check.error;
}

double EnergyCheck::energy_tolerance(const CheckedLoads::Sum& expected) const {
  const double e = kRefined * expected.largest_stress / stress_of_energy_;
  return e * e;
}

/// How much more than expected a base may give wrong, with room.
double EnergyCheck::amplified(const CheckedLoads::Sum& expected, double forces) const {
  if (unseen_) return kAmplifiedUnseen;
  if (expected.events > kRecentEvents || !(expected.forces > 0)) return kAmplified;
  return std::min(kRecent * std::max(1.0, forces / expected.forces), kAmplified);
}

std::optional<SolveReport> EnergyCheck::known(const CheckedLoads::Sum& expected, double energy,
                                              double forces, double largest_u,
                                              double largest) const {
  if (!std::isfinite(largest)) return std::nullopt;  // the load is so large that stress overflows
  SolveReport report = report_;
  report.polished = false;
  report.iterations = 0;
  report.back_solves = 1;
  const double tolerance = problem_.scene().solver.tolerance;
  if (expected.fresh() && expected.alone) {  // the solution of that check, before it was refined
    report.error = std::max(report.error, expected.error);
    if (report.error <= tolerance) return report;
  }
  if (!(largest_u <= kGrowth * expected.largest_u)) return std::nullopt;
  if (!(expected.largest_stress <= kGrowth * largest)) return std::nullopt;  // shares that cancel
  const double of_base = std::max(expected.error, expected.stress_error / largest),
               worth = std::min(stress_of_energy_, worth_),
               lacking = worth * std::sqrt(std::max(0.0, energy)) / largest;
  if (expected.fresh()) {  // the same of a sum
    report.error = std::max(report.error, of_base) + lacking;
    if (report.error <= std::min(kEnough, tolerance)) return report;
  }
  report.error = amplified(expected, forces) * of_base + lacking;
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
