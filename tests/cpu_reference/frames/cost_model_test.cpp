// SPDX-License-Identifier: Apache-2.0
// The predicted milliseconds order scenes and routes as their work does.
#include <gtest/gtest.h>

#include <numeric>

#include "cpu_reference/routes.hpp"
#include "solver/frame_cost.hpp"
#include "support/body.hpp"
#include "support/table1_board.hpp"

namespace sunder::cpu_reference {
namespace {

using solver::FrameCost;
using solver::FrameShape;
using solver::takes_new_factor;

FrameCost frame_cost(const FrameShape& shape) { return solver::frame_cost(shape, {}); }

/// A board of 120,000 tetrahedra of which a patch of 1,000 unknowns can tear.
FrameShape organ(Route route) {
  FrameShape s;
  s.route = route;
  s.damage = true;
  s.unknowns = 120000;
  s.kept = route == Route::condensed ? 1000 : s.unknowns;
  s.loaded = 6;
  s.entries = 60'000'000;
  s.path = 10'000'000;
  s.load_path = 2'000'000;
  s.elements = 120000;
  s.stressed = route == Route::condensed ? 900 : s.elements;
  return s;
}

TEST(CostModel, OrdersTheRoutesOfALargeOrgan) {
  const FrameCost condensed = frame_cost(organ(Route::condensed));
  const FrameCost factor = frame_cost(organ(Route::factor));
  const FrameCost cg = frame_cost(organ(Route::cg));
  EXPECT_LT(10 * condensed.quiet.ms, factor.quiet.ms);
  EXPECT_LT(10 * condensed.fracture.ms, factor.fracture.ms);
  EXPECT_LT(factor.fracture.ms, cg.fracture.ms);
  // Forward along 2 million values, backward through 60 million, of 8 bytes at 10 GB/s.
  EXPECT_GT(factor.quiet.ms, 49.6);
  EXPECT_LT(factor.quiet.ms, 55);
}

TEST(CostModel, TakesAFractureForMoreWorkThanNone) {
  for (Route route : {Route::inverse, Route::condensed, Route::factor, Route::cg}) {
    FrameShape s = organ(route);
    const FrameCost cost = frame_cost(s);
    EXPECT_GT(cost.fracture.ms, cost.quiet.ms);
    s.damage = false;
    EXPECT_EQ(frame_cost(s).fracture.ms, 0);
    EXPECT_EQ(frame_cost(s).quiet.ms, cost.quiet.ms);
    s.stressed /= 2;
    EXPECT_LT(frame_cost(s).quiet.ms, cost.quiet.ms);
  }
  FrameShape eager = organ(Route::inverse), deferred = eager;
  eager.eager = true;
  EXPECT_GT(frame_cost(eager).fracture.ms, 100 * frame_cost(deferred).fracture.ms);
}

// Four new unknowns an element; an eighth of all, but not under 64 and not over 600.
TEST(CostModel, TakesANewFactorForEventsThatTouchAnEighthOfTheBody) {
  for (const auto& [unknowns, most] : {std::pair<std::size_t, std::size_t>{100, 16},
                                       {1600, 50},
                                       {2052, 64},
                                       {7992, 150},
                                       {120132, 150}}) {
    EXPECT_FALSE(takes_new_factor(unknowns, most)) << unknowns;
    EXPECT_TRUE(takes_new_factor(unknowns, most + 1)) << unknowns;
  }
}

TEST(CostModel, IsTheRuleOfTheDeferredRoutes) {
  for (Route route : {Route::inverse, Route::factor}) {
    Scene scene = test::pulled_board();
    scene.solver.route = route;
    scene.solver.update = Update::deferred;
    const auto problem = std::make_shared<Problem>(std::move(scene));
    const auto unknowns = static_cast<std::size_t>(problem->dof_count());
    std::size_t most = 1;
    while (!takes_new_factor(unknowns, most + 1)) ++most;
    ASSERT_LT(most + 1, problem->mesh().tets.size());
    std::vector<Index> elements(most + 1);
    std::iota(elements.begin(), elements.end(), 0);
    for (std::size_t count : {most, most + 1}) {
      DamagedBody body(problem);
      IntactBody intact(*problem, true, *fem::analyse(*problem));
      const auto own = deferred_route(body, intact, route == Route::inverse, {});
      body.destroy(std::span(elements).first(count));
      own->follow({.leave = std::span(elements).first(count)});
      EXPECT_EQ(own->bases(), count > most ? 2 : 1) << count << " elements";
    }
  }
}

/// A board pulled at some of its nodes, on the factor.
Scene pulled_at(const Box& nodes) {
  Scene scene = test::pulled_board();
  scene.instruments = {{"pull", Pull{nodes, Vec3(0, -1, 0)}, {}}};
  scene.solver.route = Route::factor;
  return scene;
}

// FactorBase solves forward where the load reaches (elimination tree), backward everywhere.
TEST(CostModel, CountsTheWayForwardOfTheLoadedUnknownsAlone) {
  constexpr double kBytesPerMillisecond = 30e6;
  std::vector<double> entries, quiet_ms;
  for (const Box& nodes : {test::lower_right_corner(), Box{Vec3(-1, -1, -1), Vec3(51, 49, 51)}}) {
    const Scene scene = pulled_at(nodes);
    const Problem problem(scene);
    std::vector<Index> loaded;
    for (Index n : problem.instrument_nodes()[0].nodes) {
      for (int axis = 0; axis < 3; ++axis) loaded.push_back(problem.dof(n, axis));
    }
    entries.push_back(static_cast<double>(
        IntactBody(problem, false, *fem::analyse(problem)).factor.path_entries(loaded)));
    quiet_ms.push_back(test::Body(scene).backend->info().quiet_ms);
  }
  ASSERT_LT(2 * entries[0], entries[1]);
  EXPECT_NEAR(quiet_ms[1] - quiet_ms[0], 8 * (entries[1] - entries[0]) / kBytesPerMillisecond,
              1e-9);
}

// An element has twelve unknowns and, as it resists no translation, nine differences of them.
TEST(CostModel, CountsNineColumnsOfAFirstFracture) {
  FrameShape s = organ(Route::factor), twice = s;
  twice.path = 2 * s.path;
  EXPECT_NEAR(frame_cost(twice).fracture.ms - frame_cost(s).fracture.ms,
              1e3 * 2 * 9 * 10'000'000 / 10e9, 1e-9);
  const FrameCost condensed = frame_cost(organ(Route::condensed));
  EXPECT_GT(condensed.fracture.ms - condensed.quiet.ms, 1e3 * 12 * 1000 * 8 / 30e9);
}

// A residual comes with the stress; without one it is a loop of its own over the elements.
TEST(CostModel, TakesTheResidualOfAFrameWithoutStressByItself) {
  FrameShape with = organ(Route::factor), without = with;
  without.stressed = 0;
  EXPECT_NEAR(frame_cost(without).quiet.ms - frame_cost(with).quiet.ms,
              1e3 * 120000 * (120e-9 - 15e-9), 1e-9);
  with = without = organ(Route::condensed);
  without.stressed = 0;
  EXPECT_LT(frame_cost(without).quiet.ms, frame_cost(with).quiet.ms);
}

TEST(CostModel, SpeaksForEveryRouteOfABackend) {
  for (Route route : {Route::inverse, Route::condensed, Route::factor, Route::cg}) {
    Scene scene = test::pulled_board();
    scene.solver.route = route;
    const test::Body body(std::move(scene));
    const BackendInfo info = body.backend->info();
    EXPECT_GT(info.quiet_ms, 1e-3) << info.route;
    EXPECT_LT(info.quiet_ms, 10) << info.route;
    EXPECT_GT(info.fracture_ms, info.quiet_ms) << info.route;
  }
}

}  // namespace
}  // namespace sunder::cpu_reference
