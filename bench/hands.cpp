// SPDX-License-Identifier: Apache-2.0
// Quiet frames under two hands: both pull in one direction that swells and ebbs, or each wanders as
// it likes; whole, torn by twenty elements, and with a piece cut off. A frame is the step and where
// every node of the surface is; the least, median and 99th percentile of its time, and of the
// thread's processor time, which leaves a device's own threads out [ms].
#include <benchmark/benchmark.h>

#include <time.h>

#include <algorithm>
#include <memory>
#include <random>

#include "has_vulkan.hpp"
#include "quantile.hpp"
#include "sunder/simulation.hpp"
#include "sunder/surface.hpp"
#include "tearing_board.hpp"

namespace sunder::bench {
namespace {

enum class Hands { proportional, wandering };
enum class Damage { none, torn, loose };

struct TwoHands {
  TwoHands(Index cells, const char* backend, Route route, Damage damage) : board(cells) {
    Scene scene = TearingBoard::scene({cells, cells, 1, 50, 50, 2.5});
    const double step = 50.0 / static_cast<double>(cells);
    const auto hand = [&](const char* name, double x, double y) {
      const Box box{Vec3(x - 0.6 * step, y - 0.6 * step, -1),
                    Vec3(x + 0.6 * step, y + 0.6 * step, 4)};
      scene.instruments.push_back({name, Pull{box, Vec3(0, -1, 0)}, {}});
    };
    hand("right", 50, 0);
    hand("left", 0, 25);
    scene.solver.route = route;
    scene.solver.backend = backend;
    scene.fracture.model = FractureModel::b;
    scene.live = true;
    scene.steps = 1 << 30;
    problem = std::make_shared<const Problem>(std::move(scene));
    simulation = std::make_unique<Simulation>(
        problem, std::move(create_backend(problem, needs_of(*problem)).backend));
    simulation->step();
    if (damage == Damage::torn) take_out(board.connected(20));
    if (damage == Damage::loose) take_out(around_a_piece());
  }

  void take_out(std::span<const Index> elements) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
      simulation->remove(elements.subspan(i, 1));
      simulation->step();
    }
  }
  /// A ring of elements in the middle of the right half; what is within it hangs on nothing.
  [[nodiscard]] std::vector<Index> around_a_piece() const {
    std::vector<Index> ring;
    const Mesh& mesh = problem->mesh();
    const double step = 50.0 / std::sqrt(static_cast<double>(problem->tet_count()) / 6);
    const auto within = [&](Index n, double by) {
      const Vec3& x = mesh.nodes[static_cast<std::size_t>(n)];
      return std::abs(x.x() - 35) < by && std::abs(x.y() - 32) < by;
    };
    for (Index e = 0; e < problem->tet_count(); ++e) {
      const auto& tet = mesh.tets[static_cast<std::size_t>(e)];
      const auto in = std::ranges::count_if(tet, [&](Index n) { return within(n, 1.2 * step); });
      if (in > 0 && in < 4) ring.push_back(e);
    }
    return ring;
  }

  TearingBoard board;
  std::shared_ptr<const Problem> problem;
  std::unique_ptr<Simulation> simulation;
};

double ms_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

void quiet(benchmark::State& state, Index cells, const char* backend, Route route, Hands hands,
           Damage damage) {
  TwoHands body(cells, backend, route, damage);
  Simulation& s = *body.simulation;
  Surface surface(s);
  std::vector<float> places(3 * surface.node_count());
  std::mt19937 random(11);
  std::normal_distribution<double> by(0, 0.05);
  std::array<Vec3, 2> pull{Vec3(0, -1, 0), Vec3(0, -1, 0)};
  double phase = 0;
  std::vector<double> times, of_thread;
  const auto frame = [&] {
    for (std::size_t h = 0; h < 2; ++h) {
      if (hands == Hands::wandering) {
        pull[h] += Vec3(by(random), by(random), by(random));
        pull[h] *= std::min(1.0, 1.5 / pull[h].norm());
      } else {
        pull[h] = Vec3(0, -1 - 0.5 * std::sin(phase += 0.05), 0);
      }
    }
    for (std::size_t h = 0; h < 2; ++h) s.drive(h, pull[h]);
    const double start = ms_of(CLOCK_MONOTONIC), thread = ms_of(CLOCK_THREAD_CPUTIME_ID);
    s.step();
    surface.points(places, {});
    of_thread.push_back(ms_of(CLOCK_THREAD_CPUTIME_ID) - thread);
    times.push_back(ms_of(CLOCK_MONOTONIC) - start);
  };
  for (int i = 0; i < 20; ++i) frame();  // as hands had moved before
  times.clear();
  of_thread.clear();
  for (auto _ : state) {
    frame();
    state.SetIterationTime(times.back() / 1e3);
  }
  state.counters["tets"] = static_cast<double>(body.problem->tet_count());
  for (const auto& [unit, values] : {std::pair{"_ms", &times}, {"_cpu_ms", &of_thread}}) {
    for (const auto& [what, q] : {std::pair{"min", 0.0}, {"median", 0.5}, {"p99", 0.99}}) {
      state.counters[std::string(what) + unit] = quantile(*values, q);
    }
  }
}

struct Way {
  const char *name, *backend;
  Route route;
  int most_cells;
  int frames = 200;
};

void add(const Way& way, int cells, const std::string& size, Damage damage,
         const std::string& how) {
  for (const bool wandering : {false, true}) {
    const std::string name = std::string("hands/") + way.name + "/" + size + "/" + how +
                             (wandering ? "/wandering" : "/proportional");
    const auto run = [=](benchmark::State& state) {
      quiet(state, cells, way.backend, way.route,
            wandering ? Hands::wandering : Hands::proportional, damage);
    };
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->Unit(benchmark::kMillisecond)
        ->UseManualTime()
        ->Iterations(way.frames);
  }
}

const bool kRows = [] {
  std::vector<Way> ways{{"inverse", "cpu", Route::inverse, 33},
                        {"condensed", "cpu", Route::condensed, 33},
                        {"factor", "cpu", Route::factor, 61},
                        {"cg", "cpu", Route::cg, 18, 20}};
  if (has_vulkan()) {
    ways.push_back({"vulkan inverse", "vulkan", Route::inverse, 18});
    ways.push_back({"vulkan condensed", "vulkan", Route::condensed, 18});
    ways.push_back({"vulkan cg", "vulkan", Route::cg, 18, 20});
  }
  for (const Way& way : ways) {
    for (const auto& [cells, size] : {std::pair{18, "1944"}, {33, "6534"}, {61, "22326"}}) {
      if (cells > way.most_cells) continue;
      add(way, cells, size, Damage::none, "whole");
      add(way, cells, size, Damage::torn, "torn");
      add(way, cells, size, Damage::loose, "loose");
    }
  }
  return true;
}();

}  // namespace
}  // namespace sunder::bench
