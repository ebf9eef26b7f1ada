// SPDX-License-Identifier: Apache-2.0
// Every route of Vulkan against the yardstick along a crack: the same elements in the same events,
// and the fields of every frame within the accuracy table.
#include "agreement.hpp"
#include "support/whole_run.hpp"

namespace sunder::test {
namespace {

class AgainstTheYardstick : public WithVulkan<testing::TestWithParam<RunCase>> {};

std::vector<Way> ways() {
  std::vector<Way> all;
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    for (const Route route : {Route::inverse, Route::condensed, Route::cg}) {
      const Update update = route == Route::cg ? Update::automatic : Update::deferred;
      all.push_back({.precision = precision, .update = update, .route = route});
    }
  }
  all.push_back({.variant = gpu::Variant::gpu, .precision = Precision::fp64});
  all.push_back({.precision = Precision::fp64, .update = Update::eager});
  return all;
}

TEST_P(AgainstTheYardstick, TearsByEveryRoute) {
  const Scene scene = GetParam().scene();
  const WholeRun right = yardstick_run(scene);
  ASSERT_GE(right.elements.size(), 50u);
  const std::string name = GetParam().name;
  for (const Way& way : ways()) {
    if (!kSoak && way.route == Route::cg && name != "NotchB") continue;  // time: up to a minute
    const WatchedBackend watched(scene, way);
    auto backend = watched.create();
    SCOPED_TRACE(name_of(way) + " " + backend->info().route);
    const WholeRun run = whole_run(watched.problem, std::move(backend), kRunFractures);
    ASSERT_NO_FATAL_FAILURE(expect_same_fractures(right, run));
    ASSERT_NO_FATAL_FAILURE(
        expect_same_frames(*watched.problem, right, run,
                           way.precision == Precision::fp64 ? kCrackTolerance : kFp32Tolerance));
  }
}

INSTANTIATE_TEST_SUITE_P(Cracks, AgainstTheYardstick, testing::ValuesIn(run_cases()),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace sunder::test
