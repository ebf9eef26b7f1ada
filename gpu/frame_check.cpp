// SPDX-License-Identifier: Apache-2.0
#include "gpu/frame_check.hpp"

#include <algorithm>
#include <cmath>

#include "engine/stress_bounds.hpp"

namespace sunder::gpu {
namespace {

// Refined silently down to this stress error: fp64 promises 1e-8 along a crack; fp32 storage
// promises the scene's tolerance, half of which leaves room for the estimate's own error.
constexpr double kFp64Error = 1e-9;
constexpr double kFp32Error = 5e-4;  // however large the tolerance
// Displacement of a nearly incompressible body is off by up to 40 times what its stress is (along a
// crack of 200 fractures at 0.499).
constexpr double kNearlyIncompressible = 0.49, kOfDisplacement = 0.1;
// What fp64 promises of a damaged body.
constexpr double kFp64Damaged = 1e-8;
// The errors of a fresh base and of those events later differ by less where it is the body that
// lets them be no smaller.
constexpr double kLikeFresh = 10;
constexpr double kSameLoad = 1e-14;  // relative: rounding of a ramp's factor
// Rounding's share of two residuals of one base differs in its places, not in its kind.
constexpr double kNoise = 10;

/// Of the stress errors that fp64 promises, what keeps displacement within the same.
double of_displacement(const Problem& problem) {
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (problem.small_strain(e).poisson > kNearlyIncompressible) return kOfDisplacement;
  }
  return 1;
}

/// Whether `now` is a multiple of `then`, other than zero.
bool is_multiple(const Load& now, const Load& then) {
  if (now.force_dofs != then.force_dofs) return false;
  double squared = 0, product = 0;
  const auto each = [&](auto&& visit) {
    for (std::size_t i = 0; i < now.forces.size(); ++i) visit(now.forces[i], then.forces[i]);
    for (std::size_t i = 0; i < now.displacements.size(); ++i) {
      visit(now.displacements[i], then.displacements[i]);
    }
  };
  each([&](double a, double b) {
    squared += b * b;
    product += a * b;
  });
  const double factor = squared > 0 ? product / squared : 0.0;
  bool same = factor != 0;
  each([&](double a, double b) {
    same = same && std::abs(a - factor * b) <= kSameLoad * std::abs(a);
  });
  return same;
}

}  // namespace

FrameCheck::FrameCheck(const Problem& problem, bool fp64)
    : tolerance_(problem.scene().solver.tolerance),
      of_displacement_(fp64 ? of_displacement(problem) : 1),
      target_(std::min(fp64 ? of_displacement_ * kFp64Error : kFp32Error, tolerance_ / 2)),
      keeps_(fp64 ? std::min(kFp64Damaged, tolerance_) : tolerance_),
      fp64_(fp64),
      stress_of_energy_(engine::largest_stress_of_energy(problem)) {}

std::optional<SolveReport> FrameCheck::known(const Load& load) const {
  if (!checked_ || !is_multiple(load, checked_->load)) return std::nullopt;
  return checked_->report;
}

std::optional<double> FrameCheck::bounded(const Load& load, const EnergyBound& energy,
                                          double stress, int bases) const {
  if (energy.whole == 0) return 0.0;
  const double bound = stress_of_energy_ * energy.whole / stress;
  if (bound <= target_) return bound;
  // The promise holds by the bound; what fp64 promises beyond it, by comparison: rounding's
  // residual spreads over all unknowns, where the bound adds up 10,000 times what it comes to.
  if (!fp64_ || !estimated_ || estimated_->bases != bases || !(bound <= tolerance_ / 2) ||
      !is_multiple(load, estimated_->load)) {
    return std::nullopt;
  }
  const double of_noise =
      kNoise * estimated_->error * std::max(1.0, energy.base / stress / estimated_->noise);
  const double error = of_noise + stress_of_energy_ * energy.touched / stress;
  if (!(error <= std::min(of_displacement_ * kFp64Damaged, tolerance_ / 2))) return std::nullopt;
  return error;
}

void FrameCheck::settled(double error) {
  keeps_ = std::max(keeps_, std::min(kLikeFresh * error, tolerance_));
}

void FrameCheck::checked(const Load& load, const SolveReport& report) {
  checked_ = Checked{load, report};
  checked_->report.iterations = 0;
}

void FrameCheck::estimated(const Load& load, double error, const EnergyBound& energy, double stress,
                           int bases) {
  estimated_ = Estimated{load, error, energy.base / stress, bases};
}

}  // namespace sunder::gpu
