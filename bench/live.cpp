// SPDX-License-Identifier: Apache-2.0
// A live body: taking events back, what keeping them costs a step, removing and cutting, and the
// surface after one rupture. Cells of the board set its size: 2,000, 8,000 and 30,000 elements.
#include <benchmark/benchmark.h>

#include <chrono>
#include <memory>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "sunder/skin.hpp"
#include "sunder/surface.hpp"
#include "tearing_board.hpp"

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Pulled by a constant force, nothing breaks by itself.
struct LiveBoard {
  LiveBoard(Index cells, Route route) : board(cells) {
    Scene scene = TearingBoard::scene({cells, cells, 1, 50, 50, 2.5});
    scene.instruments.push_back(
        {"forceps", Pull{Box{Vec3(49.99, -0.01, -1), Vec3(50.01, 0.01, 4)}, Vec3(0, -1, 0)}, {}});
    scene.solver.route = route;
    scene.fracture.model = FractureModel::b;
    scene.live = true;
    scene.steps = 1 << 30;
    problem = std::make_shared<const Problem>(std::move(scene));
    simulation = std::make_unique<Simulation>(problem, create());
  }
  [[nodiscard]] std::unique_ptr<Backend> create() const {
    return cpu_reference::create(problem, needs_of(*problem));
  }
  void keep() {
    simulation->keep_history([this] { return create(); });
  }
  /// The tear's elements from one to another, an event each, with a step after each.
  void tear(std::size_t from, std::size_t to) {
    const auto order = board.connected(to);
    for (std::size_t i = from; i < to; ++i) {
      simulation->remove(order.subspan(i, 1));
      simulation->step();
    }
  }

  TearingBoard board;
  std::shared_ptr<const Problem> problem;
  std::unique_ptr<Simulation> simulation;
};

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// So many events are taken back at once, from 50 or as many, and done again outside the time.
void undo(benchmark::State& state, Index cells, Route route, int events) {
  LiveBoard live(cells, route);
  live.keep();
  const std::size_t all = std::max<std::size_t>(50, static_cast<std::size_t>(events));
  live.tear(0, all);
  bool replayed = false;
  for (auto _ : state) {
    const auto start = Clock::now();
    replayed = live.simulation->undo(events).replayed || replayed;
    state.SetIterationTime(since(start));
    live.tear(all - static_cast<std::size_t>(events), all);
  }
  state.counters["tets"] = static_cast<double>(live.problem->tet_count());
  state.counters["replayed"] = replayed ? 1 : 0;
}

/// A quiet step, with a history or without.
void step(benchmark::State& state, Index cells, Route route, bool history) {
  LiveBoard live(cells, route);
  if (history) live.keep();
  live.tear(0, 20);
  for (auto _ : state) {
    const auto start = Clock::now();
    live.simulation->step();
    state.SetIterationTime(since(start));
  }
}

/// One element out, its solution and its event included.
void remove(benchmark::State& state, Index cells, Route route) {
  LiveBoard live(cells, route);
  live.keep();
  live.tear(0, 20);
  for (auto _ : state) {
    const auto start = Clock::now();
    live.simulation->remove(live.board.connected(21).subspan(20, 1));
    state.SetIterationTime(since(start));
    live.simulation->undo();
  }
}

/// A blade of 5 mm into the right edge: the search and the removal.
void cut(benchmark::State& state, Index cells, Route route) {
  LiveBoard live(cells, route);
  live.keep();
  live.simulation->step();
  const Vec3 a(45, 25.1, -1), b(45, 25.1, 4), c(51, 25.1, -1), d(51, 25.1, 4);
  const std::vector<std::array<Vec3, 3>> swept{{a, b, c}, {b, d, c}};
  int removed = 0;
  for (auto _ : state) {
    const auto start = Clock::now();
    removed = live.simulation->cut(swept);
    state.SetIterationTime(since(start));
    live.simulation->undo();
  }
  state.counters["removed"] = removed;
}

/// What has changed by one rupture, and nothing.
void surface(benchmark::State& state, Index cells, bool changed) {
  LiveBoard live(cells, Route::factor);
  live.keep();
  live.tear(0, 20);
  Surface surface(*live.simulation);
  std::uint64_t version = surface.version();
  std::size_t count = 0;
  for (auto _ : state) {
    if (changed) live.simulation->remove(live.board.connected(21).subspan(20, 1));
    const auto start = Clock::now();
    surface.update();
    count = surface.changed_since(version).size();
    state.SetIterationTime(since(start));
    version = surface.version();
    if (!changed) continue;
    live.simulation->undo();
    surface.update();
    version = surface.version();
  }
  state.counters["triangles"] = static_cast<double>(surface.triangles().size());
  state.counters["changed"] = static_cast<double>(count);
}

/// Places and normals of the nodes; places of a skin of four vertices an element.
void points(benchmark::State& state, Index cells) {
  LiveBoard live(cells, Route::factor);
  live.simulation->step();
  const Surface surface(*live.simulation);
  std::vector<float> places(3 * surface.node_count()), normals(places);
  for (auto _ : state) surface.points(places, normals);
}

void skin(benchmark::State& state, Index cells) {
  LiveBoard live(cells, Route::factor);
  live.simulation->step();
  std::vector<Vec3> vertices;
  const Mesh& mesh = live.problem->mesh();
  for (const auto& tet : mesh.tets) {
    for (std::size_t a = 0; a < 4; ++a) {
      Vec3 at = Vec3::Zero();
      for (std::size_t b = 0; b < 4; ++b) at += (a == b ? 0.4 : 0.2) * mesh.nodes[tet[b]];
      vertices.push_back(at);
    }
  }
  const Skin skin(*live.simulation, vertices);
  std::vector<float> places(3 * vertices.size());
  for (auto _ : state) skin.places(places, {});
  state.counters["vertices"] = static_cast<double>(vertices.size());
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& run,
         bool by_hand = true) {
  auto* row = benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
  // What is timed is a small part of an iteration.
  if (by_hand) row->UseManualTime()->Iterations(100);
}

const bool kRows = [] {
  for (const auto& [cells, size] : {std::pair{18, "1944"}, {36, "7776"}, {71, "30246"}}) {
    for (const auto& [route, word] : {std::pair{Route::inverse, "inverse"},
                                      {Route::condensed, "condensed"},
                                      {Route::factor, "factor"}}) {
      if (route != Route::factor && cells > 18) continue;
      const std::string of = std::string("/") + word + "/" + size;
      for (int events : {1, 10, 50}) {
        add("undo" + of + "/" + std::to_string(events),
            [=](auto& s) { undo(s, cells, route, events); });
      }
      for (bool history : {false, true}) {
        add(std::string("step") + of + (history ? "/history" : "/none"),
            [=](auto& s) { step(s, cells, route, history); });
      }
      add("remove" + of, [=](auto& s) { remove(s, cells, route); });
      add("cut" + of, [=](auto& s) { cut(s, cells, route); });
    }
    const std::string of = std::string("/") + size;
    add("surface_of_one_rupture" + of, [=](auto& s) { surface(s, cells, true); });
    add("surface_of_nothing" + of, [=](auto& s) { surface(s, cells, false); });
    add(
        "surface_points" + of, [=](auto& s) { points(s, cells); }, false);
    add(
        "skin" + of, [=](auto& s) { skin(s, cells); }, false);
  }
  return true;
}();

}  // namespace
}  // namespace sunder::bench
