// SPDX-License-Identifier: Apache-2.0
#include "frame_passes.hpp"

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <ctime>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "body/hyperelastic_pass.hpp"
#include "tearing_board.hpp"

namespace sunder::bench {
namespace {

double us_by(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Least microseconds of a call, by the clock and of all processors.
struct Least {
  double wall = std::numeric_limits<double>::infinity(), processors = wall;
  void time(const std::function<void()>& run) {
    const double cpu = us_by(CLOCK_PROCESS_CPUTIME_ID), start = us_by(CLOCK_MONOTONIC);
    run();
    wall = std::min(wall, us_by(CLOCK_MONOTONIC) - start);
    processors = std::min(processors, us_by(CLOCK_PROCESS_CPUTIME_ID) - cpu);
  }
};

/// Turned by 30 deg, stretched by 30 % and sheared, every node off by up to 4 % of a cell.
std::vector<double> deformed(const Problem& problem, Index cells) {
  Mat3 f = Eigen::AngleAxisd(std::numbers::pi / 6, Vec3(1, 2, 3).normalized()).matrix() *
           Vec3(1.3, 0.9, 0.85).asDiagonal();
  f(0, 1) += 0.1;
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> any(-2.0 / cells, 2.0 / cells);
  std::vector<double> u;
  for (const Vec3& x : problem.mesh().nodes) {
    const Vec3 moved = (f - Mat3::Identity()) * x;
    for (int axis = 0; axis < 3; ++axis) u.push_back(moved[axis] + any(generator));
  }
  return u;
}

void passes(benchmark::State& state, const Law& law, Index cells, int threads) {
  const TearingBoard board(cells);
  const Problem& problem = *board.problem;
  const auto of = fem::one_law(problem, law);
  const fem::HyperelasticBody body{problem, of};
  fem::HyperelasticPass pass(body, threads);
  const std::vector<double> u = deformed(problem, cells);
  std::vector<double> f(u.size());
  std::vector<Voigt> stress(problem.mesh().tets.size());
  const auto with = [&](bool deformation) {
    benchmark::DoNotOptimize(pass.run(u, {.forces = f,
                                          .stress = stress,
                                          .measure = StressMeasure::cauchy,
                                          .deformation = deformation}));
  };
  Least scalar, lanes, stressed, all;
  for (auto _ : state) {
    scalar.time([&] { benchmark::DoNotOptimize(fem::internal_forces(body, u, f)); });
    for (int i = 0; i < 4; ++i) {
      lanes.time([&] { benchmark::DoNotOptimize(pass.internal_forces(u, f)); });
    }
    state.counters["repaired"] = static_cast<double>(pass.repaired());
    stressed.time([&] { with(false); });
    all.time([&] { with(true); });
  }
  state.counters["scalar_us"] = scalar.processors;
  state.counters["pass_us"] = lanes.wall;
  state.counters["processors_us"] = lanes.processors;
  state.counters["ns_per_tet"] = 1e3 * lanes.processors / static_cast<double>(problem.tet_count());
  state.counters["with_stress_us"] = stressed.processors;
  state.counters["with_deformation_us"] = all.processors;
}

}  // namespace

void register_passes() {
  for (const Law* law : laws()) {
    for (Index cells : {18, 36, 71}) {
      for (int threads : {1, 2}) {
        const std::string row = "passes/" + std::string(law->name) + "/" +
                                std::to_string(6 * cells * cells) + "/" + std::to_string(threads);
        benchmark::RegisterBenchmark(row.c_str(), [=](auto& s) { passes(s, *law, cells, threads); })
            ->Iterations(cells > 36 ? 30 : 100)
            ->Unit(benchmark::kMicrosecond);
      }
    }
  }
}

}  // namespace sunder::bench
