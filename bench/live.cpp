// SPDX-License-Identifier: Apache-2.0
// A live body: taking hold of it, taking events back, what keeping them costs a step, removing and
// cutting, and the surface after one rupture. Cells of the board set its size: 2,000, 8,000 and
// 30,000 elements.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <memory>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "sunder/skin.hpp"
#include "sunder/surface.hpp"
#include "tearing_board.hpp"
#include "torn_patch.hpp"

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Pulled by a constant force, nothing breaks by itself.
struct LiveBoard {
  LiveBoard(Index cells, Route route) : LiveBoard(cells, route, true) {}
  /// `all`: anything may be removed; else a patch at the right edge, which route condensed
  /// computes.
  LiveBoard(Index cells, Route route, bool all, CrackWay crack = CrackWay::destroyed)
      : board(cells) {
    Scene scene = all ? TearingBoard::scene({cells, cells, 1, 50, 50, 2.5}) : patch_scene(cells);
    scene.instruments.clear();
    scene.instruments.push_back(
        {"forceps", Pull{Box{Vec3(49.99, -0.01, -1), Vec3(50.01, 0.01, 4)}, Vec3(0, -1, 0)}, {}});
    scene.solver.route = route;
    scene.fracture.model = FractureModel::b;
    scene.fracture.crack = crack;
    scene.live = all;
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

/// A blade of 5 mm into the right edge: the search, and the removal or the faces that open.
void cut(benchmark::State& state, Index cells, Route route, CrackWay crack) {
  LiveBoard live(cells, route, true, crack);
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
  state.counters["removed_or_opened"] = removed;
}

/// Ten nodes near the board's right edge, above the tear.
std::vector<Index> ten_nodes(const Problem& problem) {
  std::vector<Index> nodes;
  for (Index n = 0; n < problem.node_count() && nodes.size() < 10; ++n) {
    const Vec3& x = problem.mesh().nodes[static_cast<std::size_t>(n)];
    if (x.x() > 44 && x.y() > 26.5) nodes.push_back(n);
  }
  return nodes;
}

/// Taking hold of ten nodes and the first frame, in which the grip has moved.
void grasp(benchmark::State& state, Index cells, Route route, bool all) {
  LiveBoard live(cells, route, all);
  live.keep();
  const std::vector<Index> nodes = ten_nodes(*live.problem);
  if (all) live.tear(0, 20);
  live.simulation->step();
  for (auto _ : state) {
    const auto start = Clock::now();
    const int grip = live.simulation->grasp(nodes, true);
    live.simulation->pose(
        grip, {live.simulation->centre_of(grip) + Vec3(0.02, 0.01, 0), {0, 0, 0.01, 1}});
    live.simulation->step();
    state.SetIterationTime(since(start));
    live.simulation->undo();
  }
  state.counters["tets"] = static_cast<double>(live.problem->tet_count());
}

/// A frame in which the grip goes another way than before: a new load.
void pose(benchmark::State& state, Index cells, Route route, bool all) {
  LiveBoard live(cells, route, all);
  if (all) live.tear(0, 20);
  live.simulation->step();
  const int grip = live.simulation->grasp(ten_nodes(*live.problem), true);
  const Vec3 centre = live.simulation->centre_of(grip);
  double at = 0;
  for (auto _ : state) {
    at += 1;
    const auto start = Clock::now();
    live.simulation->pose(grip, {centre + 0.02 * Vec3(std::sin(at), std::cos(1.7 * at), 0),
                                 {0, 0, 0.01 * std::sin(2.3 * at), 1}});
    live.simulation->step();
    state.SetIterationTime(since(start));
  }
}

/// A frame under a force that goes another way than before, with no grip there.
void new_load(benchmark::State& state, Index cells, Route route, bool all) {
  LiveBoard live(cells, route, all);
  if (all) live.tear(0, 20);
  double at = 0;
  for (auto _ : state) {
    at += 1;
    live.simulation->drive(0, Vec3(std::sin(at), -1, std::cos(1.7 * at)));
    const auto start = Clock::now();
    live.simulation->step();
    state.SetIterationTime(since(start));
  }
}

/// The first step of all, or the second, both another way than any before.
void first_step(benchmark::State& state, Index cells, Route route, bool warm, int number) {
  int back_solves = 0;
  double seconds = 0;
  for (auto _ : state) {
    LiveBoard live(cells, route);
    if (warm) live.simulation->warm_up();
    for (int step = 0; step < number; ++step) {
      live.simulation->drive(0, Vec3(std::sin(1.0 + step), -1, std::cos(1.7 * step)));
      const auto start = Clock::now();
      back_solves = live.simulation->step().back_solves;
      seconds = since(start);
    }
    state.SetIterationTime(seconds);
  }
  state.counters["back_solves"] = back_solves;
}

/// Letting go, with the frame after it.
void release(benchmark::State& state, Index cells, Route route, bool all) {
  LiveBoard live(cells, route, all);
  live.keep();
  if (all) live.tear(0, 20);
  live.simulation->step();
  const int grip = live.simulation->grasp(ten_nodes(*live.problem), true);
  live.simulation->pose(grip, {live.simulation->centre_of(grip) + Vec3(0.02, 0.01, 0)});
  live.simulation->step();
  for (auto _ : state) {
    const auto start = Clock::now();
    live.simulation->release(grip);
    live.simulation->step();
    state.SetIterationTime(since(start));
    live.simulation->undo();
  }
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

// Undo, steps, and changes of elements of a board; `of` is the rest of a row's name.
void add_changes(int cells, Route route, const std::string& of) {
  for (int events : {1, 10, 100}) {
    add("undo" + of + "/" + std::to_string(events),
        [=](auto& s) { undo(s, cells, route, events); });
  }
  for (bool history : {false, true}) {
    add(std::string("step") + of + (history ? "/history" : "/none"),
        [=](auto& s) { step(s, cells, route, history); });
  }
  add("remove" + of, [=](auto& s) { remove(s, cells, route); });
  add("cut" + of, [=](auto& s) { cut(s, cells, route, CrackWay::destroyed); });
  for (bool warm : {false, true}) {
    for (int number : {1, 2}) {
      const std::string name = "first_step" + of + (warm ? "/warm/" : "/cold/");
      benchmark::RegisterBenchmark((name + std::to_string(number)).c_str(),
                                   [=](auto& s) { first_step(s, cells, route, warm, number); })
          ->Unit(benchmark::kMillisecond)
          ->UseManualTime()
          ->Iterations(5);
    }
  }
  if (route == Route::condensed) return;  // cracks do not split there
  add("split_cut" + of, [=](auto& s) { cut(s, cells, route, CrackWay::split); });
}

void add_grips(int cells, Route route, const std::string& of) {
  const bool all = route != Route::condensed;
  add("grasp" + of, [=](auto& s) { grasp(s, cells, route, all); });
  add("pose" + of, [=](auto& s) { pose(s, cells, route, all); });
  add("new_load" + of, [=](auto& s) { new_load(s, cells, route, all); });
  add("release" + of, [=](auto& s) { release(s, cells, route, all); });
}

void add_surfaces(int cells, const std::string& of) {
  add("surface_of_one_rupture" + of, [=](auto& s) { surface(s, cells, true); });
  add("surface_of_nothing" + of, [=](auto& s) { surface(s, cells, false); });
  add(
      "surface_points" + of, [=](auto& s) { points(s, cells); }, false);
  add(
      "skin" + of, [=](auto& s) { skin(s, cells); }, false);
}

const bool kRows = [] {
  for (const auto& [cells, size] : {std::pair{18, "/1944"}, {36, "/7776"}, {71, "/30246"}}) {
    for (const auto& [route, word] : {std::pair{Route::inverse, "/inverse"},
                                      {Route::condensed, "/condensed"},
                                      {Route::factor, "/factor"}}) {
      const std::string of = word + std::string(size);
      if (route == Route::factor || cells == 18) add_changes(cells, route, of);
      // The dense inverse of 30,246 elements takes 8 GB.
      if (route != Route::inverse || cells <= 36) add_grips(cells, route, of);
    }
    add_surfaces(cells, size);
  }
  return true;
}();

}  // namespace
}  // namespace sunder::bench
