// SPDX-License-Identifier: Apache-2.0
// Ten thousand random actions by every way.
#include "core/frame/live_random.hpp"

namespace sunder::test {
namespace {

class LiveSoak : public testing::TestWithParam<LiveWay> {};

TEST_P(LiveSoak, TenThousandActionsLeadToWhatTheBodyIsAnew) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    const Played played = play_at_random(live_strip(GetParam()), 100 + seed, 1000, 10, 50);
    EXPECT_GE(played.checked, 80);
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, LiveSoak, testing::ValuesIn(kLiveWays),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace sunder::test
