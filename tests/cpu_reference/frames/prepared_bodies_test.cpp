// SPDX-License-Identifier: Apache-2.0
// Backends that share an intact body: the same bits as those that do not, and a body of its own
// wherever the stiffness is another one.
#include "cpu_reference/prepared_bodies.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/same_stiffness.hpp"
#include "sunder/simulation.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

using cpu_reference::PreparedBodies;
using Problems = std::shared_ptr<const Problem>;

Scene tearing_board(Route route, double force = -150) {
  Scene scene = pulled_board(Vec3(0, force, 0));
  scene.fracture.model = FractureModel::b;
  scene.fracture.max_events = 6;
  scene.solver.route = route;
  scene.steps = 3;
  return scene;
}

struct Torn {
  std::vector<Vec3> displacement;
  std::vector<Index> destroyed;
  bool operator==(const Torn&) const = default;
};

Torn tear(const Scene& scene, std::shared_ptr<PreparedBodies> prepared) {
  const auto problem = std::make_shared<const Problem>(scene);
  cpu_reference::CpuOptions options;
  options.prepared = std::move(prepared);
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem), options));
  while (!simulation.done()) simulation.step();
  Torn torn{simulation.displacement(), {}};
  for (const DestroyedElement& d : simulation.destroyed()) torn.destroyed.push_back(d.element);
  return torn;
}

TEST(PreparedBodies, HaveTheSameBitsOnEveryRoute) {
  for (const Route route : {Route::inverse, Route::factor, Route::condensed, Route::cg}) {
    SCOPED_TRACE(static_cast<int>(route));
    const auto prepared = std::make_shared<PreparedBodies>(1);
    const Torn alone = tear(tearing_board(route), nullptr);
    EXPECT_FALSE(alone.destroyed.empty());
    EXPECT_EQ(tear(tearing_board(route), prepared), alone);
    // The second finds what the first has made, and has worn nothing of it.
    EXPECT_EQ(tear(tearing_board(route), prepared), alone);
    const Torn other = tear(tearing_board(route, -200), nullptr);
    EXPECT_EQ(tear(tearing_board(route, -200), prepared), other);
    EXPECT_NE(other, alone);
  }
}

TEST(PreparedBodies, ServeThreadsAtOnce) {
  const Torn alone = tear(tearing_board(Route::inverse), nullptr);
  const auto prepared = std::make_shared<PreparedBodies>(2);
  std::vector<Torn> torn(4);
  std::vector<std::thread> threads;
  for (Torn& one : torn) {
    threads.emplace_back([&] { one = tear(tearing_board(Route::inverse), prepared); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Torn& one : torn) EXPECT_EQ(one, alone);
}

Problems problem(const std::function<void(Scene&)>& change = [](Scene&) {}) {
  Scene scene = tearing_board(Route::inverse);
  change(scene);
  return std::make_shared<const Problem>(std::move(scene));
}

TEST(PreparedBodies, AreOnesOfTheirOwnWhereTheStiffnessIs) {
  const Problems board = problem();
  PreparedBodies prepared(8);
  const auto body = prepared.of(board);
  const auto same = [&](const std::function<void(Scene&)>& change) {
    const Problems other = problem(change);
    EXPECT_EQ(same_stiffness(*board, *other), prepared.of(other) == body);
    return prepared.of(other) == body;
  };
  EXPECT_TRUE(same([](Scene& s) { s.steps = 9; }));
  EXPECT_TRUE(same([](Scene& s) { s.materials.at("upper").yield = 3; }));
  EXPECT_TRUE(same([](Scene& s) { s.fracture.alpha = 1e-3; }));
  EXPECT_TRUE(same([](Scene& s) { s.instruments.clear(); }));
  EXPECT_FALSE(same([](Scene& s) { s.materials.at("upper").young = 6; }));
  EXPECT_FALSE(same([](Scene& s) { s.materials.at("upper").poisson = 0.3; }));
  EXPECT_FALSE(same([](Scene& s) { s.supports.push_back({lower_right_corner(), Axes{4}}); }));
  EXPECT_FALSE(same([](Scene& s) { s.mesh.nodes[100].z() += 1e-3; }));
  EXPECT_FALSE(same([](Scene& s) { std::swap(s.mesh.tets[0], s.mesh.tets[1]); }));
}

TEST(PreparedBodies, SpringsOfGripsBelongToTheStiffness) {
  const auto held_by_a_grip = [](const Box& nodes) {
    return problem([&](Scene& s) {
      s.supports.clear();
      s.instruments.front().action = Grip{nodes, Vec3(0, -1, 0), Axes{7}};
    });
  };
  EXPECT_TRUE(same_stiffness(*held_by_a_grip(top_edge()), *held_by_a_grip(top_edge())));
  EXPECT_FALSE(same_stiffness(*held_by_a_grip(top_edge()),
                              *held_by_a_grip({Vec3(-1, -1, -1), Vec3(51, 0.001, 3)})));
}

TEST(PreparedBodies, OnlyTheLastAreKept) {
  PreparedBodies prepared(2);
  const Problems a = problem();
  const Problems b = problem([](Scene& s) { s.materials.at("upper").young = 6; });
  const Problems c = problem([](Scene& s) { s.materials.at("upper").young = 7; });
  const auto first = prepared.of(a);
  static_cast<void>(prepared.of(b));
  EXPECT_EQ(prepared.of(a), first);  // asked for again: b is the oldest now
  static_cast<void>(prepared.of(c));
  EXPECT_EQ(prepared.of(a), first);
  EXPECT_EQ(&first->problem(), a.get());
  const Problems b_again = problem([](Scene& s) { s.materials.at("upper").young = 6; });
  EXPECT_EQ(&prepared.of(b_again)->problem(), b_again.get());  // b's is gone
}

}  // namespace
}  // namespace sunder::test
