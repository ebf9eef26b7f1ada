// SPDX-License-Identifier: Apache-2.0
#include "frame_cascades.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <numeric>
#include <string>

#include "cpu_reference/cpu_reference.hpp"
#include "tearing_board.hpp"
#include "torn_patch.hpp"

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kFractures = 640, kTail = 100, kFirst = 5;

/// This thread's own processor time; work of other threads and waiting for them are not in it.
double thread_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

double us_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

enum Part { kUpdate, kSolve, kWaited, kStress, kAll, kProcessor, kParts };
constexpr std::array<const char*, kParts> kNames{"update_us", "solve_us", "waited_us",
                                                 "stress_us", "all_us",   "processor_us"};
using Frame = std::array<double, kParts>;

struct Tear {
  std::shared_ptr<const Problem> problem;
  Load load;
  std::span<const Index> elements;
};

std::vector<Frame> frames_of(const Tear& tear) {
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const auto backend = cpu_reference::create(tear.problem, needs);
  backend->set_load(tear.load);
  backend->solve();
  backend->stress();
  std::vector<Frame> frames;
  for (const Index& e : tear.elements) {
    Frame frame{};
    const double processor = thread_us();
    const auto start = Clock::now();
    backend->destroy({&e, 1});
    frame[kUpdate] = us_since(start);
    backend->set_load(tear.load);
    // A frame that takes a base waits for it in its update; the next report tells.
    frame[kWaited] = 1e3 * backend->solve().waited_ms;
    frame[kUpdate] -= frame[kWaited];
    frame[kSolve] = us_since(start) - frame[kUpdate] - frame[kWaited];
    const double before = us_since(start);
    backend->stress();
    frame[kAll] = us_since(start);
    frame[kStress] = frame[kAll] - before;
    frame[kProcessor] = thread_us() - processor;
    frames.push_back(frame);
  }
  return frames;
}

void report(benchmark::State& state, const std::string& which, std::span<const Frame> frames) {
  for (std::size_t p = 0; p < kParts; ++p) {
    const double sum = std::accumulate(frames.begin(), frames.end(), 0.0,
                                       [p](double s, const Frame& f) { return s + f[p]; });
    state.counters[which + "_" + kNames[p]] = sum / static_cast<double>(frames.size());
  }
}

void cascade(benchmark::State& state, const Tear& tear) {
  for (auto _ : state) {
    std::vector<Frame> frames = frames_of(tear);
    const auto all = [](double s, const Frame& f) { return s + f[kAll]; };
    state.SetIterationTime(1e-6 * std::accumulate(frames.begin(), frames.end(), 0.0, all));
    report(state, "first", std::span(frames).first(kFirst));
    report(state, "last", std::span(frames).last(kTail));
    std::ranges::sort(frames, {}, [](const Frame& f) { return f[kAll]; });
    const std::size_t n = frames.size();
    report(state, "median", std::span(frames).subspan(n * 45 / 100, n / 10));
    report(state, "slowest", std::span(frames).last((n + 99) / 100));
  }
}

void add(const std::string& route, Index cells, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(
      ("frame_cascade/" + route + "/" + std::to_string(6 * cells * cells)).c_str(), run)
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

void whole_board(benchmark::State& state, Index cells, Route route) {
  const TearingBoard board(cells);
  Scene scene = board.problem->scene();
  scene.solver.route = route;
  cascade(state, {std::make_shared<Problem>(std::move(scene)),
                  {board.load_dofs, board.load_values, {}},
                  board.connected(kFractures)});
}

void patch(benchmark::State& state, Index cells) {
  const TornPatch board(cells, Route::condensed);
  cascade(state,
          {board.problem, {board.load_dofs, board.load_values, {}}, board.connected(kFractures)});
}

}  // namespace

void register_cascades() {
  for (Index cells : {18, 36, 71, 141}) {
    if (cells <= 36) {
      add("inverse", cells, [=](auto& s) { whole_board(s, cells, Route::inverse); });
    }
    add("factor", cells, [=](auto& s) { whole_board(s, cells, Route::factor); });
    add("condensed", cells, [=](auto& s) { patch(s, cells); });
  }
}

}  // namespace sunder::bench
