// SPDX-License-Identifier: Apache-2.0
// Statics at finite deformation beside what a user would pick instead (bench/finite_peers): the
// board pulled at its corner until it is strained by about 30 % and buckled out of its plane, then
// frames that pull a little more and events of nine elements at the tip of the tear, all from the
// same state, to the same residual, with the same element code. Frames come 60 times a second; what
// runs beside them has the time between.
//   finite/TETS/frame or event/TOLERANCE/THREADS/METHOD
//   finite_error/LAW/TOLERANCE/METHOD: the same at 1,944 tetrahedra, with the error of stress
// "sunder" ends by the residual as its peers do, "sunder promise" as scenes run: by its estimate of
// the error of stress. A step that is not found within a method's cap is counted (`missed`), and
// its time is none; what it cost is in sequence_cpu_ms.
//   bench_finite [Google Benchmark's options]
//   bench_finite --peers    the methods with their settings
#include <benchmark/benchmark.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <map>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "bench/finite_peers/finite_solver.hpp"
#include "material/corotated.hpp"
#include "material/finite_stress.hpp"
#include "material/law.hpp"
#include "quantile.hpp"
#include "run_rows.hpp"
#include "solver/finite_statics.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/finite_newton.hpp"

extern "C" void openblas_set_num_threads(int);

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kNewtons = 36;       // the paper's board is strained by 29 % then (finite.md)
constexpr double kNewtonsMore = .36;  // a frame
constexpr int kStepsThere = 12;
constexpr std::size_t kElements = 9;  // an event
constexpr int kFramesBetween = 2;     // of two events
constexpr auto kFrame = std::chrono::microseconds(16667);
// Then a method has shown what it can: steps that it misses, and time of all threads for a row.
constexpr int kMostMissed = 2;
constexpr double kMostMs = 60e3;

/// The library's own solver; `promise`: by the estimate of the stress error.
class Own : public FiniteSolver {
 public:
  Own(const FiniteSetting& setting, bool promise)
      : board_(setting.board),
        torn_(setting.board, setting.law),
        statics_(torn_.body, options(setting, promise)) {
    destroy(board_.connected(setting.start.gone));
    for (int i = 1; i <= kStepsThere; ++i) {
      if (!solve(i * setting.start.newtons / kStepsThere).at_rest) {
        throw std::runtime_error("no equilibrium to begin with");
      }
    }
  }
  void destroy(std::span<const Index> elements) override {
    torn_.destroy(elements);
    statics_.destroyed(elements);
  }
  FiniteSolved solve(double newtons) override {
    FiniteSolved found;
    solver::FiniteStaticsReport report;
    do {
      report = statics_.solve(corner_load(board_, newtons));
      found.back_solves += report.back_solves;
      found.factors += report.factors;
    } while (report.unfinished);
    found.iterations = found.back_solves;
    found.at_rest = report.at_rest;
    return found;
  }
  const std::vector<double>& displacement() const override { return statics_.displacement(); }
  std::span<const std::uint8_t> out() const override { return statics_.out(); }

 private:
  static solver::FiniteStaticsOptions options(const FiniteSetting& setting, bool promise) {
    solver::FiniteStaticsOptions options;
    options.tolerance = promise ? setting.tolerance : 0;
    if (!promise) options.residual = setting.tolerance;
    return options;
  }
  const TearingBoard& board_;
  TornBody torn_;
  solver::FiniteStatics statics_;
};

FiniteKind own(const std::string& name, bool promise) {
  return {name,
          promise ? "L-BFGS on a recent tangent until the estimated error of stress is under the "
                    "tolerance, as scenes run"
                  : "L-BFGS on a recent tangent until the residual is under the tolerance",
          false, [=](const FiniteSetting& s) { return std::make_unique<Own>(s, promise); }};
}

std::vector<FiniteKind> kinds() {
  return {own("sunder", false), own("sunder promise", true), newton_cholmod(),  newton_jacobi(),
          newton_incomplete(),  projective_lbfgs(),          warped_stiffness()};
}

const TearingBoard& board_of(Index cells) {
  static std::map<Index, std::unique_ptr<TearingBoard>> boards;
  auto& board = boards[cells];
  if (!board) board = std::make_unique<TearingBoard>(cells);
  return *board;
}

/// Where everybody begins; found once, by the library's own solver.
const FiniteStart& start_of(Index cells, const Law& law) {
  static std::map<std::pair<Index, const Law*>, FiniteStart> starts;
  auto [at, is_new] = starts.try_emplace({cells, &law});
  if (is_new) {
    at->second = {kNewtons, kElements, {}};
    at->second.u = Own({board_of(cells), law, 1e-10, 0, at->second}, false).displacement();
  }
  return at->second;
}

/// So many processors for this thread and those it starts, until the end.
class Processors {
 public:
  explicit Processors(int count) {
    CPU_ZERO(&before_);
    sched_getaffinity(0, sizeof before_, &before_);
    cpu_set_t some;
    CPU_ZERO(&some);
    for (int cpu = CPU_SETSIZE - 1; cpu >= 0 && count > 0; --cpu) {
      if (CPU_ISSET(cpu, &before_)) CPU_SET(cpu, &some), --count;
    }
    sched_setaffinity(0, sizeof some, &some);
  }
  ~Processors() { sched_setaffinity(0, sizeof before_, &before_); }
  Processors(const Processors&) = delete;
  Processors& operator=(const Processors&) = delete;

 private:
  cpu_set_t before_;
};

/// Of all threads: what others on the machine take is not in it.
double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// The steps of a row, one after the other.
class Steps {
 public:
  Steps(FiniteSolver& solver, const TearingBoard& board) : solver_(solver), board_(board) {}

  /// False: the method has missed often enough, or has taken long enough.
  bool step(std::span<const Index> elements, double newtons, bool counts) {
    std::this_thread::sleep_until(next_);
    const auto start = Clock::now();
    const double cpu_start = cpu_ms();
    if (!elements.empty()) solver_.destroy(elements);
    const FiniteSolved found = solver_.solve(newtons);
    const double cpu = cpu_ms() - cpu_start;
    const auto end = Clock::now();
    next_ = std::max(end, start + kFrame);
    ++steps_;
    missed_ += !found.at_rest;
    if (counts && found.at_rest) {
      ms_.push_back(std::chrono::duration<double, std::milli>(end - start).count());
      cpu_.push_back(cpu);
      back_solves_.push_back(found.back_solves);
      iterations_.push_back(found.iterations);
      factors_.push_back(found.factors);
    }
    if (!found.at_rest) most_ = std::max(most_, found.iterations);
    if (look_ && found.at_rest) look_(newtons);
    return missed_ < kMostMissed && cpu_ms() - cpu_start_ < kMostMs;
  }
  void frames(int count) {
    for (int i = 1; i <= count; ++i) {
      if (!step({}, kNewtons + i * kNewtonsMore, true)) return;
    }
  }
  void events(int count) {
    double newtons = kNewtons;
    for (int i = 1; i <= count; ++i) {
      const auto all = board_.connected(kElements * static_cast<std::size_t>(i + 1));
      if (!step(all.last(kElements), newtons, true)) return;
      for (int k = 0; k < kFramesBetween; ++k) {
        if (!step({}, newtons += kNewtonsMore / 10, false)) return;
      }
    }
  }
  void look_after(std::function<void(double)> look) { look_ = std::move(look); }
  void report(benchmark::State& state) {
    state.counters["missed"] = missed_;
    state.counters["steps"] = steps_;
    state.counters["sequence_cpu_ms"] = (cpu_ms() - cpu_start_) / std::max(1, steps_);
    if (ms_.empty()) {
      state.SkipWithError(("not in " + std::to_string(most_) + " iterations").c_str());
      return;
    }
    state.counters["min_ms"] = quantile(ms_, 0);
    state.counters["median_ms"] = quantile(ms_, .5);
    state.counters["p99_ms"] = quantile(ms_, .99);
    state.counters["cpu_ms"] = quantile(cpu_, .5);
    state.counters["back_solves"] = quantile(back_solves_, .5);
    state.counters["p99_back_solves"] = quantile(back_solves_, .99);
    state.counters["iterations_median"] = quantile(iterations_, .5);
    state.counters["p99_iterations"] = quantile(iterations_, .99);
    state.counters["factors"] =
        std::accumulate(factors_.begin(), factors_.end(), 0.0) / static_cast<double>(ms_.size());
  }
  [[nodiscard]] double median_seconds() const {
    return ms_.empty() ? 1e-9 : 1e-3 * quantile(ms_, .5);
  }

 private:
  FiniteSolver& solver_;
  const TearingBoard& board_;
  std::vector<double> ms_, cpu_, back_solves_, iterations_, factors_;
  int steps_ = 0, missed_ = 0, most_ = 0;
  Clock::time_point next_ = Clock::now();
  double cpu_start_ = cpu_ms();
  std::function<void(double)> look_;
};

struct Count {
  int frames, events;
};

void row(benchmark::State& state, const FiniteKind& kind, Index cells, bool event, double tolerance,
         int threads, Count count) {
  const FiniteStart& start = start_of(cells, kCorotated);
  const Processors processors(threads);
  openblas_set_num_threads(1);  // a peer may choose more
  for (auto _ : state) {
    const auto solver = kind.create({board_of(cells), kCorotated, tolerance, threads, start});
    Steps steps(*solver, board_of(cells));
    if (event) {
      steps.events(count.events);
    } else {
      steps.frames(count.frames);
    }
    state.SetIterationTime(steps.median_seconds());
    steps.report(state);
  }
}

/// Stress error of every step against a Newton's method that went to the end from there.
void error_row(benchmark::State& state, const FiniteKind& kind, const Law& law, double tolerance) {
  constexpr Index kCells = 18;
  constexpr Count kCount{6, 3};
  const TearingBoard& board = board_of(kCells);
  const FiniteStart& start = start_of(kCells, law);
  openblas_set_num_threads(1);
  for (auto _ : state) {
    const auto solver = kind.create({board, law, tolerance, 1, start});
    Steps steps(*solver, board);
    double worst = 0;
    int without = 0;
    steps.look_after([&](double newtons) {
      const std::vector<std::uint8_t> out(solver->out().begin(), solver->out().end());
      const auto laws = fem::one_law(*board.problem, law);
      const fem::HyperelasticBody body{*board.problem, laws, out};
      std::vector<Voigt> found(out.size()), exact(out.size());
      fem::element_stresses(body, solver->displacement(), cauchy_stress, found);
      try {
        const auto rest = test::newton(body, corner_load(board, newtons), solver->displacement());
        fem::element_stresses(body, rest.u, cauchy_stress, exact);
      } catch (const NumericalError&) {
        ++without;  // Newton's method does not come to a stable rest from there
        return;
      }
      const double error = test::stress_error(out, found, exact);
      if (!(error <= worst)) worst = error;
    });
    steps.events(kCount.events);
    state.SetIterationTime(steps.median_seconds());
    steps.report(state);
    state.counters["error_stress"] = worst;
    state.counters["without_reference"] = without;
  }
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  const auto guarded = [run](benchmark::State& state) {
    try {
      run(state);
    } catch (const std::runtime_error& error) {
      state.SkipWithError(error.what());
    }
  };
  benchmark::RegisterBenchmark(name.c_str(), guarded)
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

std::string power(double tolerance) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", tolerance);
  return text;
}

void register_rows() {
  for (const auto& [cells, count] :
       {std::pair<Index, Count>{18, {24, 6}}, {36, {24, 6}}, {71, {10, 5}}, {141, {5, 3}}}) {
    for (const bool event : {false, true}) {
      for (const double tolerance : {1e-4, 1e-8}) {
        for (const int threads : {1, 2}) {
          if (tolerance < 1e-4 && threads == 1) continue;
          for (const FiniteKind& kind : kinds()) {
            const std::string name = "finite/" + std::to_string(6 * cells * cells) +
                                     (event ? "/event/" : "/frame/") + power(tolerance) + "/" +
                                     std::to_string(threads) + "/" + kind.name;
            add(name, [=, cells = cells, count = count](auto& s) {
              row(s, kind, cells, event, tolerance, threads, count);
            });
          }
        }
      }
    }
  }
  for (const char* law : {"corotated", "neo-hookean", "saint-venant-kirchhoff"}) {
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
      for (const FiniteKind& kind : kinds()) {
        const Law* of = find_law(law);
        if (kind.corotated_only && of != &kCorotated) continue;
        add(std::string("finite_error/") + law + "/" + power(tolerance) + "/" + kind.name,
            [=](auto& s) { error_row(s, kind, *of, tolerance); });
      }
    }
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--peers") {
    for (const auto& kind : sunder::bench::kinds()) {
      std::printf("%s\t%s\n", kind.name.c_str(), kind.settings.c_str());
    }
    return 0;
  }
  sunder::bench::register_rows();
  return sunder::bench::run_rows(argc, argv);
}
