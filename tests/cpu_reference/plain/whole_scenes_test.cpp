// SPDX-License-Identifier: Apache-2.0
// Every route and update of the CPU against the yardstick along a crack: the same elements in the
// same events, and the fields of every frame within the accuracy table.
#include <gtest/gtest.h>

#include "cpu_reference/cpu_reference.hpp"
#include "support/whole_run.hpp"

namespace sunder::test {
namespace {

class WholeScene : public ::testing::TestWithParam<RunCase> {};

void expect_same_deformation(const WholeRun& right, const WholeRun& run) {
  for (std::size_t i = 0; i < right.deformation.size(); ++i) {
    const Deformation &a = run.deformation[i], &b = right.deformation[i];
    SCOPED_TRACE("step " + std::to_string(i));
    EXPECT_NEAR(a.strain, b.strain, 1e-7 * std::abs(b.strain));
    EXPECT_NEAR(a.rotation_deg, b.rotation_deg, 1e-3 * b.rotation_deg);  // promised: 0.1 %
    EXPECT_EQ(a.inverted, b.inverted);
  }
}

TEST_P(WholeScene, TearsByEveryRouteAsByTheYardstick) {
  const Scene scene = GetParam().scene();
  const WholeRun right = yardstick_run(scene);
  ASSERT_GE(right.elements.size(), 50u);
  for (const auto& [route, update] :
       {std::pair(Route::inverse, Update::deferred), std::pair(Route::inverse, Update::eager),
        std::pair(Route::factor, Update::deferred), std::pair(Route::condensed, Update::deferred),
        std::pair(Route::cg, Update::automatic)}) {
    Scene routed = scene;
    routed.solver.route = route;
    routed.solver.update = update;
    const auto problem = std::make_shared<const Problem>(std::move(routed));
    auto backend = cpu_reference::create(problem, needs_of(*problem));
    SCOPED_TRACE(backend->info().route + " " + backend->info().update);
    const WholeRun run = whole_run(problem, std::move(backend), kRunFractures);
    ASSERT_NO_FATAL_FAILURE(expect_same_fractures(right, run));
    ASSERT_NO_FATAL_FAILURE(expect_same_frames(*problem, right, run, kCrackTolerance));
    if (route != Route::condensed) expect_same_deformation(right, run);  // it has a region's
  }
}

INSTANTIATE_TEST_SUITE_P(Cracks, WholeScene, ::testing::ValuesIn(run_cases()),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace sunder::test
