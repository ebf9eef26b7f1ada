// SPDX-License-Identifier: Apache-2.0
// Two hundred advances of a split crack on the device, in fp64 and over an inverse in fp32, against
// a fresh factor of the split mesh.
#include <gtest/gtest.h>

#include <random>

#include "core/split/split_against_fresh.hpp"
#include "gpu_body.hpp"

namespace sunder::test {
namespace {

class LongCracksOnTheDevice : public WithVulkan<testing::TestWithParam<Precision>> {};

TEST_P(LongCracksOnTheDevice, AreAsAFreshFactorSays) {
  const Precision precision = GetParam();
  const Route route = precision == Precision::fp32 ? Route::inverse : Route::automatic;
  const SplitCase c{route, false, 0.3, false};
  std::mt19937 random(7);
  Scene scene = scene_of(c, shaken_board({205, 3, 1, 205, 3, 1}, random, 0.2));
  const WatchedBackend watched(scene, {.precision = precision, .tolerance = 1e-10, .route = route});
  const auto backend = watched.create();
  const Problem& problem = *watched.problem;
  const auto force = shared_force(problem.mesh(), problem.instrument_nodes()[0].nodes, kBy);
  EdgeSplit crack(problem);
  backend->change(crack.begin(0).change);
  for (int i = 1; i <= 200; ++i) {
    auto step = crack.advance(0);
    ASSERT_TRUE(step.moved() && !step.through) << i;
    step.change.held = true;  // it hangs together before it runs through
    backend->change(step.change);
    if (i != 1 && i % 10 != 0) continue;
    backend->set_load(load_of(problem, force, {}));
    static_cast<void>(backend->solve());
    static_cast<void>(backend->stress());
    if (i == 1 || i == 10 || i == 50 || i == 100 || i == 200) {
      expect_as_fresh(crack, c, *backend, force);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, LongCracksOnTheDevice,
                         testing::Values(Precision::fp64, Precision::fp32), [](const auto& of) {
                           return of.param == Precision::fp64 ? "fp64" : "fp32";
                         });

}  // namespace
}  // namespace sunder::test
