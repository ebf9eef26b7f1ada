// SPDX-License-Identifier: Apache-2.0
// A few hundred random actions by every way; the soak has more (live_soak_test.cpp).
#include "core/frame/live_random.hpp"

namespace sunder::test {
namespace {

class LiveRandom : public testing::TestWithParam<LiveWay> {};

TEST_P(LiveRandom, ActionsLeadToWhatTheBodyIsAnew) {
  const Played played = play_at_random(live_strip(GetParam()), 7, 300, 10, 10);
  EXPECT_GE(played.checked, 25);
  EXPECT_GE(played.recorded, 2);
  EXPECT_GE(played.grasped, 5);
  EXPECT_GE(played.posed, 10);
  EXPECT_GE(played.released, 3);
  EXPECT_GE(played.removed, 3);
  EXPECT_GE(played.back, 5);
}

INSTANTIATE_TEST_SUITE_P(Ways, LiveRandom, testing::ValuesIn(kLiveWays),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace sunder::test
