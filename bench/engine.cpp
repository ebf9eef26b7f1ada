// SPDX-License-Identifier: Apache-2.0
// The engine against CHOLMOD: one event of k connected elements and the solution after it, one
// thread. The engine's load is new to every event; updown_solve keeps its own. An event that the
// library takes a new factor for has one here (core/solver/frame_cost.hpp); rows "forced_" show the
// update that it leaves. bench/run adds the ratios to the peers' rows when all have run
// (suite/ratios.py); `error` is the difference to CHOLMOD's refactored solution.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <thread>
#include "body/stiffness_factor.hpp"

#include "body/assembly.hpp"
#include "cholmod_peer.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/routes.hpp"
#include "cpu_reference/stress.hpp"
#include "machine/memory.hpp"
#include "quantile.hpp"
#include "run_rows.hpp"
#include "solver/deferred.hpp"
#include "solver/factor_base.hpp"
#include "solver/frame_cost.hpp"
#include "solver/inverse_base.hpp"
#include "solver/stress_kernel.hpp"

extern "C" {
void openblas_set_num_threads(int);
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

const TearingBoard& board_of(Index cells) {
  static std::map<Index, std::unique_ptr<TearingBoard>> boards;
  auto& board = boards[cells];
  if (!board) board = std::make_unique<TearingBoard>(cells);
  return *board;
}

const linear_algebra::Factor& factor_of(Index cells) {
  static std::map<Index, std::unique_ptr<linear_algebra::Factor>> factors;
  auto& factor = factors[cells];
  if (!factor)
    factor =
        std::make_unique<linear_algebra::Factor>(fem::factor_stiffness(*board_of(cells).problem));
  return *factor;
}

std::string row(const char* name, Index cells, std::size_t k) {
  return std::string(name) + "/" + std::to_string(6 * cells * cells) + "/k" + std::to_string(k);
}

/// CHOLMOD's solution by a new factor: what the others are compared with.
const Eigen::VectorXd& refactored(Index cells, std::size_t k) {
  static std::map<std::pair<Index, std::size_t>, Eigen::VectorXd> solutions;
  Eigen::VectorXd& u = solutions[{cells, k}];
  if (u.size() == 0) {
    Cholmod cholmod(board_of(cells));
    cholmod.prepare(board_of(cells).connected(k));
    cholmod.refactor();
    u = cholmod.solution();
  }
  return u;
}

/// Repeats prepare (untimed) and run (timed) and reports minimum and median.
void measure(benchmark::State& state, const std::function<void()>& prepare,
             const std::function<void()>& run) {
  std::vector<double> seconds;
  for (auto _ : state) {
    prepare();
    const auto start = Clock::now();
    run();
    seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    state.SetIterationTime(seconds.back());
  }
  std::sort(seconds.begin(), seconds.end());
  state.counters["min_ms"] = 1e3 * seconds.front();
  state.counters["median_ms"] = 1e3 * seconds[seconds.size() / 2];
}

void note_error(benchmark::State& state, Index cells, std::size_t k, const Eigen::VectorXd& u) {
  const Eigen::VectorXd& reference = refactored(cells, k);
  state.counters["error"] = (u - reference).norm() / reference.norm();
}

void cholmod_row(benchmark::State& state, Index cells, std::size_t k, void (Cholmod::*run)()) {
  const TearingBoard& board = board_of(cells);
  Cholmod cholmod(board);
  const auto elements = board.connected(k);
  measure(
      state, [&] { cholmod.prepare(elements); }, [&] { (cholmod.*run)(); });
  note_error(state, cells, k, cholmod.solution());
}

/// Whether the inverse of a board and what else there is fit into the free memory.
bool has_room_for_inverse(Index cells) {
  const auto unknowns = static_cast<std::size_t>(board_of(cells).problem->dof_count());
  return unknowns * unknowns * sizeof(double) < machine::available_memory();
}

/// The engine over an inverse or a factor; one inverse serves all rows of a board. None: no room.
solver::Deferred* deferred_of(Index cells, bool dense) {
  static std::map<std::pair<Index, bool>, std::unique_ptr<solver::Deferred>> all;
  auto& deferred = all[{cells, dense}];
  if (deferred) return deferred.get();
  std::unique_ptr<solver::Base> base;
  if (!dense) {
    base = std::make_unique<solver::FactorBase>(factor_of(cells));
  } else if (has_room_for_inverse(cells)) {
    base = std::make_unique<solver::InverseBase>(factor_of(cells));
  } else {
    return nullptr;
  }
  deferred = std::make_unique<solver::Deferred>(*board_of(cells).problem, std::move(base));
  return deferred.get();
}

/// A load that is new to every event: the one before, the other way round.
class TurningLoad {
 public:
  explicit TurningLoad(const TearingBoard& board) : load{board.load_dofs, board.load_values, {}} {}
  void turn() {
    for (double& f : load.forces) f = -f;
    sign_ = -sign_;
  }
  /// The solution as it is under the board's own load.
  [[nodiscard]] Eigen::VectorXd turned_back(const Eigen::VectorXd& u) const { return sign_ * u; }

  Load load;

 private:
  double sign_ = 1;
};

void engine_row(benchmark::State& state, Index cells, std::size_t k, bool dense) {
  const TearingBoard& board = board_of(cells);
  solver::Deferred* deferred = deferred_of(cells, dense);
  if (!deferred) return state.SkipWithError("refused: the inverse is larger than the free memory");
  const auto elements = board.connected(k);
  TurningLoad turning(board);
  Eigen::VectorXd u;
  measure(
      state,
      [&] {
        if (deferred->events() > 0) deferred->take_back();
        turning.turn();
      },
      [&] {
        if (!deferred->destroy(elements)) state.SkipWithError("not definite");
        deferred->solve({turning.load.force_dofs, turning.load.forces}, {}, u);
      });
  state.counters["rank"] = deferred->rank();
  deferred->take_back();
  note_error(state, cells, k, turning.turned_back(u));
}

/// The library's own route, made anew for each event.
void route_row(benchmark::State& state, Index cells, std::size_t k, bool dense) {
  const TearingBoard& board = board_of(cells);
  const auto elements = board.connected(k);
  const auto analysis = fem::analyse(*board.problem);
  TurningLoad turning(board);
  std::optional<cpu_reference::DamagedBody> body;
  std::optional<cpu_reference::IntactBody> intact;
  std::unique_ptr<cpu_reference::InverseRoute> route;
  Eigen::VectorXd f, u;  // f: of routes that read all of it
  measure(
      state,
      [&] {
        route.reset();
        body.emplace(board.problem);
        intact.emplace(*board.problem, true, *analysis);
        route = cpu_reference::deferred_route(*body, *intact, dense, {});
        route->solve(turning.load, f, u);
        turning.turn();
      },
      [&] {
        body->destroy(elements);
        route->follow({.leave = elements});
        route->solve(turning.load, f, u);
      });
  state.counters["new_bases"] = route->bases() - 1;
  note_error(state, cells, k, turning.turned_back(u));
}

/// Assembly and order of elimination included; CHOLMOD is given the matrix and keeps its order.
void own_refactor(benchmark::State& state, Index cells) {
  const TearingBoard& board = board_of(cells);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(board.problem->dof_count()), u;
  for (std::size_t i = 0; i < board.load_dofs.size(); ++i) {
    f[board.load_dofs[i]] = board.load_values[i];
  }
  measure(
      state, [] {}, [&] { u = fem::factor_stiffness(*board.problem).solve(f); });
  state.counters["nnz_L"] = static_cast<double>(factor_of(cells).entries());
}

/// What a user without an update does with a dense inverse: all of it anew, and its loaded columns.
void openblas_row(benchmark::State& state, Index cells, std::size_t k) {
  const TearingBoard& board = board_of(cells);
  std::vector<double> scale(board.problem->mesh().tets.size(), 1.0);
  for (Index e : board.connected(k)) scale[e] = board.problem->scene().fracture.alpha;
  const Eigen::MatrixXd stiffness(fem::assemble_lower(*board.problem, scale));
  Eigen::MatrixXd a;
  Eigen::VectorXd u;
  measure(
      state, [&] { a = stiffness; },
      [&] {
        const int n = static_cast<int>(a.rows());
        int info = 0;
        dpotrf_("L", &n, a.data(), &n, &info);
        if (info == 0) dpotri_("L", &n, a.data(), &n, &info);
        if (info != 0) state.SkipWithError("not definite");
        u.setZero(n);
        for (std::size_t i = 0; i < board.load_dofs.size(); ++i) {
          const Index d = board.load_dofs[i];  // the lower triangle is the inverse's
          u.head(d) += board.load_values[i] * a.row(d).head(d).transpose();
          u.tail(n - d) += board.load_values[i] * a.col(d).tail(n - d);
        }
        benchmark::DoNotOptimize(u.data());
      });
}

/// A thread's own processor time: what a frame costs when others share the machine. Work of other
/// threads and waiting for them are not in it.
double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

void report_frames(benchmark::State& state, const std::string& unit, std::vector<double> ms) {
  const std::size_t tail = std::min<std::size_t>(100, ms.size() / 2);
  state.counters["first_" + unit] = median_of({ms.begin(), ms.begin() + 5});
  state.counters["last_" + unit] =
      median_of({ms.end() - static_cast<std::ptrdiff_t>(tail), ms.end()});
  std::sort(ms.begin(), ms.end());
  state.counters["min_" + unit] = ms.front();
  state.counters["median_" + unit] = ms[ms.size() / 2];
  state.counters["p99_" + unit] = ms[ms.size() * 99 / 100];
  state.counters["worst_" + unit] = ms.back();
}

/// A cascade: fractures one by one, each with its frame (update, solution with its check, stress
/// with its summary), as the backend does them.
void cascade(benchmark::State& state, Index cells, std::size_t fractures, Route route) {
  Scene scene = board_of(cells).problem->scene();
  scene.solver.route = route;
  const auto problem = std::make_shared<Problem>(std::move(scene));
  const TearingBoard& board = board_of(cells);
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const Load load{board.load_dofs, board.load_values, {}};
  for (auto _ : state) {
    const auto backend = cpu_reference::create(problem, needs);
    backend->set_load(load);
    backend->solve();
    backend->stress();
    std::vector<double> ms, cpu;
    double waited = 0;
    for (const Index& e : board.connected(fractures)) {
      const auto start = Clock::now();
      const double cpu_start = thread_ms();
      backend->destroy({&e, 1});
      backend->set_load(load);
      waited += backend->solve().waited_ms;
      backend->stress();
      cpu.push_back(thread_ms() - cpu_start);
      ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    }
    state.SetIterationTime(1e-3 * std::accumulate(ms.begin(), ms.end(), 0.0));
    report_frames(state, "ms", std::move(ms));
    report_frames(state, "cpu_ms", std::move(cpu));
    state.counters["waited_ms"] = waited;
  }
}

/// The haptic thread's questions (1 kHz and faster) while frames tear a gripped board.
void instrument_row(benchmark::State& state, Index cells) {
  Scene scene = board_of(cells).problem->scene();
  Instrument forceps;
  forceps.action = Grip{Box{Vec3(49.99, -1, -1), Vec3(51, 0.01, 4)}, Vec3(0, -1, 0), Axes{7}};
  scene.instruments.push_back(forceps);
  const auto problem = std::make_shared<Problem>(std::move(scene));
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const std::size_t grips = problem->gripped_dofs().size();
  Load load;
  for (std::size_t i = 0; i < grips; ++i) load.displacements.push_back(i % 3 == 1 ? -1.0 : 0.0);
  for (auto _ : state) {
    const auto backend = cpu_reference::create(problem, needs);
    const auto instruments = backend->instrument_forces();
    backend->set_load(load);
    backend->solve();
    std::vector<double> us, cpu;
    us.reserve(1 << 20);
    cpu.reserve(1 << 20);
    std::atomic<bool> done{false};
    std::size_t failed = 0;
    std::thread haptics([&] {
      std::vector<double> forces(grips);
      while (!done.load()) {
        const auto start = Clock::now();
        const double cpu_start = thread_ms();
        if (!instruments->forces(load.displacements, forces)) ++failed;
        cpu.push_back(1e3 * (thread_ms() - cpu_start));
        us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
        for (double f : forces) failed += !std::isfinite(f);
        std::this_thread::sleep_for(std::chrono::microseconds(100));
      }
    });
    for (const Index& e : board_of(cells).connected(640)) {
      backend->destroy({&e, 1});
      backend->set_load(load);
      backend->solve();
      backend->stress();
    }
    done = true;
    haptics.join();
    state.SetIterationTime(1e-6 * std::accumulate(us.begin(), us.end(), 0.0));
    if (failed > 0) state.SkipWithError("an answer was missing or not finite");
    state.counters["answers"] = static_cast<double>(us.size());
    state.counters["grips"] = static_cast<double>(grips);
    report_frames(state, "us", std::move(us));
    report_frames(state, "cpu_us", std::move(cpu));
  }
}

/// Element stress of the board: the vectorised kernel on one thread and on all, and the plain loop.
void stress_row(benchmark::State& state, Index cells, int threads) {
  const auto& problem = board_of(cells).problem;
  solver::StressKernel kernel(problem, {}, threads);
  kernel.keep_bounds();
  std::vector<double> u(problem->dofs().size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = std::sin(0.1 * static_cast<double>(i));
  std::vector<Voigt> stress(problem->mesh().tets.size());
  const std::vector<double> scale(stress.size(), 1.0);
  measure(
      state, [] {},
      [&] {
        if (threads > 0) {
          kernel.run(u, stress);
        } else {
          cpu_reference::element_stress(*problem, scale, u, stress);
        }
      });
  state.counters["ns_per_tet"] =
      1e6 * state.counters["min_ms"] / static_cast<double>(problem->tet_count());
}

void add(const std::string& name, double seconds,
         const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->UseManualTime()
      ->MinTime(seconds)
      ->Unit(benchmark::kMillisecond);
}

void add_once(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

/// An event as the library follows it.
void add_event(const std::string& base, Index cells, std::size_t k) {
  const bool dense = base == "inverse";
  const std::string name = row((base + "_deferred").c_str(), cells, k);
  const auto update = [=](auto& s) { engine_row(s, cells, k, dense); };
  const auto unknowns = static_cast<std::size_t>(board_of(cells).problem->dof_count());
  if (solver::takes_new_factor(unknowns, k)) {
    add("sunder_" + name, 0.1, [=](auto& s) { route_row(s, cells, k, dense); });
    add("forced_" + name, 0.1, update);
  } else {
    add("sunder_" + name, 0.1, update);
  }
}

/// `full`: cascades of 120,000 elements as well, some minutes. An inverse of 30,000 elements takes
/// 7.5 GB and half a minute: bench/run --full asks for it once.
void register_rows(bool full) {
  for (Index cells : {18, 36, 71, 141}) {
    if (cells == 18) {
      add(row("openblas_inverse", cells, 1), 0.5, [=](auto& s) { openblas_row(s, cells, 1); });
    }
    for (std::size_t k : {std::size_t{1}, std::size_t{10}, std::size_t{100}}) {
      const auto peer = [=](const char* name, void (Cholmod::*run)()) {
        add(row(name, cells, k), 0.1, [=](auto& s) { cholmod_row(s, cells, k, run); });
      };
      peer("cholmod_refactor", &Cholmod::refactor);
      peer("cholmod_updown", &Cholmod::updown_then_solve);
      peer("cholmod_updown_solve", &Cholmod::updown_solve);
      if (cells <= 71) add_event("inverse", cells, k);
      add_event("factor", cells, k);
    }
    add(row("sunder_factor_anew", cells, 1), 0.1, [=](auto& s) { own_refactor(s, cells); });
  }
  for (Index cells : {18, 36, 71, 141}) {
    if (cells == 141 && !full) continue;
    for (std::size_t fractures : {std::size_t{200}, std::size_t{640}}) {
      for (Route route : {Route::inverse, Route::factor}) {
        if (route == Route::inverse && cells > 36) continue;
        const std::string name =
            std::string("cascade_") + (route == Route::inverse ? "inverse" : "factor") + "/" +
            std::to_string(6 * cells * cells) + "/" + std::to_string(fractures);
        add_once(name, [=](auto& s) { cascade(s, cells, fractures, route); });
      }
    }
    for (int threads : {0, 1, 2}) {
      const std::string name = threads == 0 ? "stress_plain" : "stress_threads";
      add(name + "/" + std::to_string(6 * cells * cells) + "/" + std::to_string(threads), 0.1,
          [=](auto& s) { stress_row(s, cells, threads); });
    }
  }
  add_once("instrument_forces/1944", [](auto& s) { instrument_row(s, 18); });
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  openblas_set_num_threads(1);
  const auto end = std::remove(argv, argv + argc, std::string_view("--full"));
  const bool full = end != argv + argc;
  argc = static_cast<int>(end - argv);
  sunder::bench::register_rows(full);
  return sunder::bench::run_rows(argc, argv);
}
