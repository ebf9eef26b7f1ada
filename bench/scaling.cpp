// SPDX-License-Identifier: Apache-2.0
// Size of the board against set-up, quiet frame, fracture frame and memory, every route. The time
// of a row is that of a frame in which one element breaks; the others are counters. floor_ms is the
// time in which the machine copies as many bytes as the backend holds: no route that reads all it
// holds can be faster; cg_iterations: the most that such a frame took. quiet_ms: of a frame under a
// load turned a little, proportional_ms under one that has grown; predicted_*: what a plan says of
// the latter and of a row's time (`sunder devices --measure` first). Rows above 200,000 tetrahedra
// take minutes: choose them by
// --benchmark_filter.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstring>

#include "bench/study/method.hpp"
#include "quantile.hpp"
#include "run_rows.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "tearing_board.hpp"

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Bytes read per millisecond by a large copy, one thread.
double copy_rate() {
  static const double rate = [] {
    const std::size_t bytes = std::size_t{256} << 20;
    std::vector<char> from(bytes, 1), to(bytes);
    double best = 1e300;
    for (int i = 0; i < 5; ++i) {
      const auto start = Clock::now();
      std::memcpy(to.data(), from.data(), bytes);
      benchmark::DoNotOptimize(to.data());
      best = std::min(best, milliseconds_since(start));
    }
    return static_cast<double>(bytes) / best;
  }();
  return rate;
}

struct Frame {
  double ms = 0;
  int iterations = 0;  ///< of conjugate gradients
};

Frame frame(Backend& backend, const Load& load, std::span<const Index> broken) {
  const auto start = Clock::now();
  if (!broken.empty()) backend.destroy(broken);
  backend.set_load(load);
  const int iterations = backend.solve().iterations;
  backend.stress();
  return {milliseconds_since(start), iterations};
}

void size_row(benchmark::State& state, const Method& method, const test::BoardShape& shape) {
  const TearingBoard board(shape);
  Scene scene = board.problem->scene();
  scene.solver = method.options;
  const auto problem = std::make_shared<Problem>(std::move(scene));
  Needs needs;
  needs.stress = needs.damage = true;
  try {
    const auto start = Clock::now();
    const auto backend = create_backend(problem, needs).backend;
    Load load{board.load_dofs, board.load_values, {}};
    frame(*backend, load, {});
    state.counters["setup_ms"] = milliseconds_since(start);
    double quiet = 1e300;
    std::vector<double> fractures;
    int iterations = 0;
    const auto order = board.connected(40);
    for (auto _ : state) {
      const Frame broke = frame(*backend, load, order.subspan(fractures.size(), 1));
      fractures.push_back(broke.ms);
      state.SetIterationTime(1e-3 * broke.ms);
      iterations = std::max(iterations, broke.iterations);
      load.forces[0] *= 1.001;
      quiet = std::min(quiet, frame(*backend, load, {}).ms);
    }
    double proportional = 1e300;
    for (int i = 0; i < 5; ++i) {
      for (double& force : load.forces) force *= 1.001;
      proportional = std::min(proportional, frame(*backend, load, {}).ms);
    }
    const BackendInfo info = backend->info();
    const auto bytes = static_cast<double>(info.memory_bytes);
    state.counters["quiet_ms"] = quiet;
    state.counters["median_ms"] = median_of(fractures);  // the first may make kernels
    state.counters["proportional_ms"] = proportional;
    state.counters["predicted_ms"] = info.fracture_ms;
    state.counters["predicted_proportional_ms"] = info.quiet_ms;
    state.counters["MiB"] = bytes / 1048576;
    if (iterations > 0) state.counters["cg_iterations"] = iterations;
    state.counters["floor_ms"] = bytes / copy_rate();
    state.counters["unknowns"] = static_cast<double>(problem->dof_count());
  } catch (const Error& error) {
    state.SkipWithError((std::string("refused: ") + error.what()).c_str());
  }
}

/// Cells along an edge up to which a route is worth its rows: memory n^2, or a minute a frame where
/// the Vulkan device is a software renderer (and iterations are the same in both precisions).
Index most_cells(const Method& method, bool software) {
  const bool slow = software && method.options.backend == "vulkan";
  const bool fp64 = method.options.precision == Precision::fp64;
  if (method.options.route != Route::inverse) return slow && !fp64 ? 141 : 409;
  if (method.options.update == Update::eager) return 18;
  const bool gpu = !software && method.options.backend == "vulkan";
  return gpu && fp64 ? 71 : 36;  // 7.5 GB, which a GPU inverts in some seconds
}

bool software_renderer_only() {
  const auto all = devices();
  return std::all_of(all.begin(), all.end(), [](const DeviceInfo& device) {
    return device.backend != "vulkan" || device.name.find("llvmpipe") != std::string::npos;
  });
}

/// Frames with a fracture, each followed by a quiet one; few where they take seconds.
int frames(const Method& method, Index cells, bool software) {
  if (software && method.options.backend == "vulkan" && cells > 36) return 1;
  return cells > 141 ? 3 : 10;
}

/// Bodies as thick as wide, whose groups of nodes have more neighbours.
void register_blocks(const Method& method) {
  if (method.options.backend != "vulkan" || method.options.precision != Precision::fp64) return;
  for (Index cells : {18, 26, 55}) {
    const std::string name =
        "scaling_block/" + method.name + "/" + std::to_string(6 * cells * cells * cells);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [=](auto& state) {
                                   size_row(state, method, {cells, cells, cells, 50, 50, 50});
                                 })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
}

void register_rows() {
  const bool software = software_renderer_only();
  for (const Method& method : methods()) {
    if (method.options.route == Route::condensed) continue;  // a matter of the scene, not of size
    for (Index cells : {9, 18, 36, 71, 141, 289, 409}) {
      if (cells > most_cells(method, software)) break;
      const std::string name = "scaling/" + method.name + "/" + std::to_string(6 * cells * cells);
      benchmark::RegisterBenchmark(name.c_str(),
                                   [=](auto& state) {
                                     size_row(state, method, {cells, cells, 1, 50, 50, 2.5});
                                   })
          ->UseManualTime()
          ->Iterations(frames(method, cells, software))
          ->Unit(benchmark::kMillisecond);
    }
    if (method.options.route == Route::cg) register_blocks(method);
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  sunder::bench::register_rows();
  return sunder::bench::run_rows(argc, argv);
}
