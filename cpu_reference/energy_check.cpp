// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/energy_check.hpp"

#include <algorithm>
#include <cmath>

#include "cpu_reference/check_terms.hpp"

namespace sunder::cpu_reference {
namespace {

// A bound on the stress error that needs no closer look: what double precision promises for an
// intact body, or a tenth of the scene's tolerance.
constexpr double kEnough = 1e-9;
// What a base gives wrong grows with the forces of the damage: they reach 30 times the load as a
// board opens.
constexpr double kAmplified = 100;
// The deferred update stops refining here: its last step gains some digits more.
constexpr double kRefined = 1e-10;
// A displacement so many times that of the last full check (a piece has come loose) needs another.
constexpr double kGrowth = 10;

}  // namespace

EnergyCheck::EnergyCheck(const Problem& problem)
    : problem_(problem), stress_of_energy_(largest_stress_of_energy(problem)) {}

void EnergyCheck::checked(const Load& load, const SolveReport& report, double unrefined, int bases,
                          double largest_u, double largest) {
  unrefined_ = unrefined;
  load_ = load;
  report_ = last_ = report;
  bases_ = bases;
  largest_u_ = largest_u;
  largest_ = largest;
  changed_ = false;
}

std::optional<double> EnergyCheck::scale_of(const Load& load, const InverseRoute& route) const {
  if (route.bases() != bases_) return std::nullopt;
  return multiple(load, load_);
}

double EnergyCheck::enough(double scale) const {
  const double e = kRefined * scale * largest_ / stress_of_energy_;
  return e * e;
}

std::optional<SolveReport> EnergyCheck::known(double scale, const InverseRoute& route,
                                              double largest_u, double largest) {
  if (!std::isfinite(largest)) return std::nullopt;  // the load is so large that stress overflows
  if (!changed_) return last_;
  if (!(largest_u <= kGrowth * scale * largest_u_)) return std::nullopt;
  SolveReport report = report_;
  report.polished = false;
  report.iterations = 0;
  const double energy = std::max(0.0, route.deferred()->defect_energy());
  report.error = kAmplified * unrefined_ + stress_of_energy_ * std::sqrt(energy) / largest;
  if (!(report.error <= std::min(kEnough, problem_.scene().solver.tolerance / 10))) {
    return std::nullopt;
  }
  changed_ = false;
  last_ = report;
  return report;
}

}  // namespace sunder::cpu_reference
