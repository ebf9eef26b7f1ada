// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/energy_check.hpp"

#include <algorithm>
#include <cmath>

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

/// |sigma|^2 <= c (sigma : eps) with c the largest eigenvalue of the elasticity of tensors, and
/// V (sigma : eps) is at most the energy u^T K u of the whole body.
double largest_stress_per_energy(const Problem& problem) {
  double largest = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& m = problem.material(e);
    const double c = std::max(m.young / (1 - 2 * m.poisson), m.young / (1 + m.poisson));
    largest = std::max(largest, c / problem.shape(e).volume);
  }
  return std::sqrt(largest);
}

bool proportional(std::span<const double> a, std::span<const double> b, double s) {
  return std::ranges::equal(a, b, [s](double x, double y) {
    return std::abs(x - s * y) <= 1e-15 * std::abs(x);  // a ramp's rounding
  });
}

}  // namespace

EnergyCheck::EnergyCheck(const Problem& problem)
    : problem_(problem), stress_of_energy_(largest_stress_per_energy(problem)) {}

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
  if (route.bases() != bases_ || load.force_dofs != load_.force_dofs) return std::nullopt;
  const auto ratio = [](std::span<const double> a, std::span<const double> b) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (b[i] != 0) return a[i] / b[i];
    }
    return 0.0;
  };
  const double s =
      std::max(ratio(load.forces, load_.forces), ratio(load.displacements, load_.displacements));
  if (!(s > 0) || !proportional(load.forces, load_.forces, s) ||
      !proportional(load.displacements, load_.displacements, s)) {
    return std::nullopt;
  }
  return s;
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
