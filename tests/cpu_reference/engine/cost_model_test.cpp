// SPDX-License-Identifier: Apache-2.0
// The predicted milliseconds order scenes and routes as their work does.
#include "cpu_reference/cost_model.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "cpu_reference/routes.hpp"
#include "support/body.hpp"
#include "support/table1_board.hpp"

namespace sunder::cpu_reference {
namespace {

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
  s.elements = 120000;
  s.stressed = route == Route::condensed ? 900 : s.elements;
  return s;
}

TEST(CostModel, OrdersTheRoutesOfALargeOrgan) {
  const FrameCost condensed = frame_cost(organ(Route::condensed));
  const FrameCost factor = frame_cost(organ(Route::factor));
  const FrameCost cg = frame_cost(organ(Route::cg));
  EXPECT_LT(10 * condensed.quiet_ms, factor.quiet_ms);
  EXPECT_LT(10 * condensed.fracture_ms, factor.fracture_ms);
  EXPECT_LT(factor.fracture_ms, cg.fracture_ms);
  // 120 million values of 8 bytes at 10 GB/s.
  EXPECT_GT(factor.quiet_ms, 96);
  EXPECT_LT(factor.quiet_ms, 105);
}

TEST(CostModel, TakesAFractureForMoreWorkThanNone) {
  for (Route route : {Route::inverse, Route::condensed, Route::factor, Route::cg}) {
    FrameShape s = organ(route);
    const FrameCost cost = frame_cost(s);
    EXPECT_GT(cost.fracture_ms, cost.quiet_ms);
    s.damage = false;
    EXPECT_EQ(frame_cost(s).fracture_ms, 0);
    EXPECT_EQ(frame_cost(s).quiet_ms, cost.quiet_ms);
    s.stressed = 0;
    EXPECT_LT(frame_cost(s).quiet_ms, cost.quiet_ms);
  }
  FrameShape eager = organ(Route::inverse), deferred = eager;
  eager.eager = true;
  EXPECT_GT(frame_cost(eager).fracture_ms, 100 * frame_cost(deferred).fracture_ms);
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
      IntactBody intact(*problem, true);
      const auto own = deferred_route(body, intact, route == Route::inverse);
      body.destroy(std::span(elements).first(count));
      own->destroy(std::span(elements).first(count));
      EXPECT_EQ(own->bases(), count > most ? 2 : 1) << count << " elements";
    }
  }
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
