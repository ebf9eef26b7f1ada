// SPDX-License-Identifier: Apache-2.0
// Ten thousand random live actions on boards whose cracks split.
#include "split_live.hpp"

namespace sunder::test {
namespace {

TEST(SplitLiveSoak, TenThousandActionsLeadToWhatTheBodyIsAnew) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE(seed);
    play_split({{}, Route::factor, seed % 2 == 0}, 100 + seed, 1000, 10, 25);
    play_split({{}, Route::inverse, seed % 2 == 1}, 200 + seed, 1000, 10, 25);
  }
}

}  // namespace
}  // namespace sunder::test
