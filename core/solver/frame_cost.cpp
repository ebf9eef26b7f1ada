// SPDX-License-Identifier: Apache-2.0
#include "solver/frame_cost.hpp"

#include <algorithm>
#include <cmath>

#include "solver/route_table.hpp"

namespace sunder::solver {
namespace {

// Nominal rates of one core of a 2.4 GHz server of 2021, the host of any device.
constexpr double kCacheBytes = 16e6;        // sets up to here stay in the cache between frames
constexpr double kFromCache = 30e9;         // bytes a second
constexpr double kFromMemory = 10e9;        // bytes a second
constexpr double kFlops = 10e9;             // of panels with a dozen columns
constexpr double kProductSeconds = 120e-9;  // per element of a product K u
constexpr double kFactorFlops = 26e9;       // of a factor's dense products
constexpr double kCheckSeconds = 200e-9;    // per element of a full check by plain loops

// A thread beside the frames follows meanwhile, and a busy machine takes twice as long: a frame is
// not to wait.
constexpr double kAllowanceOfAThread = 4;

constexpr double kValue = sizeof(double);
// Of conjugate gradients on a device apart, on boards with frames 100 times stiffer
// (bench_scaling): they grow with the square root of a group's nodes, and take more where groups
// are too few to tell the frames from the tissue.
constexpr double kIterationsOfANode = 25, kIterationsOfFewGroups = 400, kManyGroups = 60;
// Dispatches of one of these, two more over more groups than have a dense inverse; bytes a node of
// its 13 vectors of four values and two places, and of a group's blocks with others and with
// aggregates.
constexpr double kIterationDispatches = 7, kIterationBytes = 13 * 32 + 2 * 16;
constexpr std::size_t kDenseGroups = 64;
constexpr double kGroupBytes = 22 * 160;
// Of an iteration, beside the stiffness: vectors and blocks, for each unknown.
constexpr double kIterationFlops = 40;
// Bytes of an element's stress there: shape, corners, state, displacement of four nodes.
constexpr double kStressBytes = 96 + 16 + 16 + 128;

double real(std::size_t count) { return static_cast<double>(count); }

/// Of a product with a matrix in fp64 or in blocks of it.
double flops_of(std::size_t matrix_bytes) { return 2 * real(matrix_bytes) / kValue; }

double host_seconds(double bytes) {
  return bytes / (bytes > kCacheBytes ? kFromMemory : kFromCache);
}

/// Of a frame; `torn`: with an event before it.
FrameWork work_of(const FrameShape& s, const FrameRates& rates, bool torn) {
  const RouteRow& route = row_of(s.route);
  FrameWork work(rates);
  if (torn) {
    work.seconds(rates.event);
    route.update(work, s);
  }
  work.seconds(rates.frame);
  work.submit();
  route.solution(work, s, torn);
  if (s.grips > 0) work.pass(0);
  work.fields(s, torn || s.grips > 0 || s.route == Route::cg);
  if (torn && s.apart && s.eager) work.check(s);
  return work;
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

void FrameWork::host(double values, double times, double flops) {
  seconds_ += times * std::max(host_seconds(kValue * values), flops / kFlops);
}

void FrameWork::product(double elements) { seconds_ += kProductSeconds * elements; }

void FrameWork::submit() {
  if (!rates_.apart()) return;
  seconds_ += rates_.submit;
  ++apart_.submits;
}

void FrameWork::passes(double dispatches, double bytes, double flops) {
  if (!rates_.apart()) return;
  seconds_ += dispatches * rates_.dispatch + bytes / rates_.bytes;
  apart_.dispatches += dispatches;
  apart_.bytes += bytes;
  apart_.flops += flops;
}

FrameSum FrameWork::sum() const {
  FrameSum sum = apart_;
  sum.ms = 1e3 * seconds_;
  return sum;
}

void FrameWork::fields(const FrameShape& s, bool balance) {
  const double stressed = real(s.stressed);
  if (s.stressed > 0) {
    pass((kStressBytes + (s.stress ? 8 * real(s.real_bytes) : 0)) * stressed,
         kStressFlops * stressed);
    seconds_ += stressed * rates_.stress / real(std::max<std::size_t>(s.threads, 1));
  }
  balance = balance || s.stressed == 0;
  if (!s.apart) {
    host(6 * real(s.route == Route::condensed ? s.kept : s.unknowns));
    const bool deferred = s.route == Route::factor || (s.route == Route::inverse && !s.eager);
    if (s.stressed == 0 && deferred) product(real(s.elements));
  } else if (balance && s.host_corrects) {
    product(real(s.elements));
  } else if (balance) {
    pass(real(s.stiffness_bytes), flops_of(s.stiffness_bytes));
  }
  pass(0);
}

double iterations_apart(const FrameShape& s) {
  const double groups = real(std::max<std::size_t>(s.groups, 1));
  const double nodes = real(s.kept) / 3;
  return std::max(kIterationsOfANode * std::sqrt(nodes / groups),
                  kIterationsOfFewGroups * (1 - groups / kManyGroups));
}

void FrameWork::iterate(const FrameShape& s, double iterations) {
  const bool levels = s.groups > kDenseGroups;
  const double bytes = real(s.stiffness_bytes) + kIterationBytes * real(s.kept) / 3 +
                       (levels ? kGroupBytes * real(s.groups) : 0);
  passes(iterations * (kIterationDispatches + (levels ? 2 : 0)), iterations * bytes,
         iterations * (flops_of(s.stiffness_bytes) + kIterationFlops * real(s.kept)));
}

void FrameWork::check(const FrameShape& s) {
  submit();
  pass(real(s.kept) * real(s.kept) * real(s.inverse_bytes), 2 * real(s.kept) * real(s.kept));
  pass(2 * real(s.kept) * kValue);
  pass(kStressBytes * real(s.elements), kStressFlops * real(s.elements));
  seconds_ += real(s.elements) * rates_.stress;
  pass(0);
}

FrameCost frame_cost(const FrameShape& shape, const FrameRates& rates) {
  FrameCost cost;
  cost.quiet = work_of(shape, rates, false).sum();
  if (shape.damage) cost.fracture = work_of(shape, rates, true).sum();
  return cost;
}

std::size_t loaded_unknowns(const Problem& problem) {
  std::size_t loaded = 0;
  for (const InstrumentNodes& i : problem.instrument_nodes()) {
    loaded += 3 * std::max<std::size_t>(i.nodes.size(), 2);  // 2: a press
  }
  if (!problem.scene().gravity.isZero(0)) loaded = static_cast<std::size_t>(problem.dof_count());
  return std::min(loaded, static_cast<std::size_t>(problem.dof_count()));
}

int frames_of_a_factor(const linear_algebra::SupernodalCholesky& factor, std::size_t elements) {
  constexpr double kUpdate = 3e-5;  // seconds of a frame with a fracture, whatever the size
  const double solve = host_seconds(kValue * real(factor.entries()));
  return frames_of_a_factor(factor, elements,
                            1.5 * solve + FrameRates{}.stress * real(elements) + kUpdate);
}

int frames_of_a_factor(const linear_algebra::SupernodalCholesky& factor, std::size_t elements,
                       double frame) {
  constexpr double kSolutions = 4;  // of the check, each forward and backward
  const double making = 2 * multiply_adds(factor.supernodes()) / kFactorFlops +
                        kCheckSeconds * real(elements) +
                        2 * kSolutions * host_seconds(kValue * real(factor.entries()));
  return std::clamp(static_cast<int>(kAllowanceOfAThread * making / frame), 48, 256);
}

bool takes_new_factor(std::size_t unknowns, std::size_t elements) {
  // An event that touches more new unknowns than this costs more than a new factor: a share of all
  // within limits. Boards of 486 to 30,246 elements (bench_reconstruction, bench_engine).
  constexpr double kLargestShare = 0.125, kSmallBody = 64, kLargestEvent = 600;
  constexpr double kTouchedByOne = 4;
  return kTouchedByOne * real(elements) >
         std::clamp(kLargestShare * real(unknowns), kSmallBody, kLargestEvent);
}

LawCost law_cost(const linear_algebra::Supernodes& order, const Problem& problem,
                 std::size_t dense) {
  // Of an element: energy and forces by lanes of AVX2; with the stress.
  constexpr double kForces = 6e-8, kStress = 8e-8;
  // Back-solves of a step that pulls and of one with a rupture (docs/figures.md "Motion"; of
  // statics method.md), each with a force pass and, near the end, its stress.
  const double quiet = problem.moves() ? 7 : 8, torn = problem.moves() ? 12 : 16;
  const double count = real(problem.mesh().tets.size());
  const double values = dense > 0 ? real(dense) * real(dense) : 2 * real(order.value_begin.back());
  LawCost cost;
  cost.back_solve_ms = 1e3 * host_seconds(kValue * values);
  cost.forces_ms = 1e3 * kForces * count;
  cost.stress_ms = 1e3 * kStress * count;
  cost.tangent_ms = 1e3 * seconds_of_a_tangent(order, problem) / kAllowanceOfAThread;
  const auto step = [&](double back_solves) {
    return back_solves * (cost.back_solve_ms + cost.forces_ms) + 2 * cost.stress_ms;
  };
  cost.quiet_ms = step(quiet);
  cost.torn_ms = step(torn);
  return cost;
}

double seconds_of_a_tangent(const linear_algebra::Supernodes& order, const Problem& problem) {
  constexpr double kElement = 1.6e-6;  // its tangent
  return kAllowanceOfAThread *
         (2 * multiply_adds(order) / kFactorFlops + kElement * real(problem.mesh().tets.size()));
}

}  // namespace sunder::solver
