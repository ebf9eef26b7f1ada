// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/cost_model.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::cpu_reference {
namespace {

// Nominal rates of one core of a 2.4 GHz server of 2021.
constexpr double kCacheBytes = 16e6;        // sets up to here stay in the cache between frames
constexpr double kFromCache = 30e9;         // bytes a second
constexpr double kFromMemory = 10e9;        // bytes a second
constexpr double kFlops = 10e9;             // of panels with a dozen columns
constexpr double kStressSeconds = 15e-9;    // per element, kernel of core/solver/stress_kernel.hpp
constexpr double kProductSeconds = 120e-9;  // per element of a product K u
constexpr double kCall = 5e-6;              // of a frame's small change
constexpr double kFactorFlops = 26e9;       // of a factor's dense products
constexpr double kCheckSeconds = 200e-9;    // per element of a full check by plain loops

constexpr double kValue = sizeof(double);
constexpr double kTouched = 12;     // unknowns of a first fracture
constexpr double kDifferences = 9;  // of them, that the element resists: columns of the damage
// Iterations of conjugate gradients preconditioned by the intact body: none broken, one broken.
constexpr double kQuietIterations = 1, kFractureIterations = 6;
// By an incomplete factor, for the cube root of the unknowns; a new crack hardly adds to them.
constexpr double kIncompleteIterations = 8;
constexpr double kStiffness = 22;  // entries of the stiffness for each unknown, lower triangle

double seconds(double values_read) {
  const double bytes = kValue * values_read;
  return bytes / (bytes > kCacheBytes ? kFromMemory : kFromCache);
}

/// Values read by one solution with `touched` unknowns of damage.
double solution_values(const FrameShape& s, double touched) {
  // Forward from the loaded unknowns along their path alone, backward through all of it.
  if (s.route == Route::factor) return static_cast<double>(s.load_path + s.entries);
  const double both = 2 * static_cast<double>(s.entries);
  const double dense = static_cast<double>(s.kept) * (static_cast<double>(s.loaded) + touched);
  if (s.route == Route::condensed) return dense;
  return std::min(dense, both);
}

/// Seconds of the residual K u - f where no stress is at hand that it could be taken from.
double plain_check(const FrameShape& s) {
  const bool deferred = s.route == Route::factor || (s.route == Route::inverse && !s.eager);
  return deferred && s.stressed == 0 ? kProductSeconds * static_cast<double>(s.elements) : 0;
}

double solution(const FrameShape& s, double touched, double iterations) {
  if (s.route != Route::cg) return seconds(solution_values(s, touched));
  const double product = kProductSeconds * static_cast<double>(s.elements);
  if (s.entries == 0) {
    const double unknowns = static_cast<double>(s.unknowns);
    const double incomplete = seconds(2 * kStiffness * unknowns);
    return kIncompleteIterations * std::cbrt(unknowns) * (product + incomplete);
  }
  return (iterations + 1) * (seconds(2 * static_cast<double>(s.entries)) + product);
}

double update(const FrameShape& s) {
  const double n = static_cast<double>(s.kept);
  if (s.eager) return seconds(2 * n * n);
  if (s.route == Route::cg) return 0;
  if (s.route == Route::factor) {
    const double path = static_cast<double>(s.path);
    return std::max(seconds(path), 2 * kDifferences * path / kFlops);
  }
  return seconds(2 * kDifferences * kDifferences);
}

/// Multiply-adds of a factor: each column of a panel with those after it.
double multiply_adds(const linear_algebra::Supernodes& nodes) {
  double sum = 0;
  for (Index s = 0; s < nodes.count(); ++s) {
    const double width = nodes.width(s), below = nodes.height(s) - width;
    sum += width * (below * below / 2 + width * below / 2 + width * width / 6);
  }
  return sum;
}

}  // namespace

int frames_of_a_factor(const linear_algebra::SupernodalCholesky& factor, std::size_t elements) {
  constexpr double kSolutions = 4;  // of the check, each forward and backward
  constexpr double kUpdate = 3e-5;  // seconds of a frame with a fracture, whatever the size
  // The thread follows meanwhile, and a busy machine takes twice as long: a frame is not to wait.
  constexpr double kAllowance = 4;
  const double solve = seconds(static_cast<double>(factor.entries()));
  const double count = static_cast<double>(elements);
  const double making = 2 * multiply_adds(factor.supernodes()) / kFactorFlops +
                        kCheckSeconds * count + 2 * kSolutions * solve;
  const double frame = 1.5 * solve + kStressSeconds * count + kUpdate;
  return std::clamp(static_cast<int>(kAllowance * making / frame), 48, 256);
}

bool takes_new_factor(std::size_t unknowns, std::size_t elements) {
  // An event that touches more new unknowns than this costs more than a new factor: a share of all
  // within limits. Boards of 486 to 30,246 elements (bench_reconstruction, bench_engine).
  constexpr double kLargestShare = 0.125, kSmallBody = 64, kLargestEvent = 600;
  constexpr double kTouchedByOne = 4;
  return kTouchedByOne * static_cast<double>(elements) >
         std::clamp(kLargestShare * static_cast<double>(unknowns), kSmallBody, kLargestEvent);
}

FrameCost frame_cost(const FrameShape& s) {
  const bool region = s.route == Route::condensed;
  const double vectors = 6 * static_cast<double>(region ? s.kept : s.unknowns);
  const double rest = kCall + seconds(vectors) + plain_check(s) +
                      kStressSeconds * static_cast<double>(s.stressed) /
                          static_cast<double>(std::max<std::size_t>(s.threads, 1));
  FrameCost cost;
  cost.quiet_ms = 1e3 * (rest + solution(s, 0, kQuietIterations));
  if (s.damage) {
    cost.fracture_ms =
        1e3 * (rest + kCall + update(s) + solution(s, kTouched, kFractureIterations));
  }
  return cost;
}

}  // namespace sunder::cpu_reference
