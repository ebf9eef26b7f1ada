// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/shared_loop.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace sunder::linear_algebra {
namespace {

TEST(SharedLoop, TakesEveryPassOnce) {
  for (const int threads : {-1, 1, 2, 5}) {
    SCOPED_TRACE(threads);
    SharedLoop loop(threads);
    ASSERT_EQ(loop.count(), std::max(threads, 1));
    for (const Index passes : {0, 1, 2, 1000}) {
      std::vector<int> taken(static_cast<std::size_t>(passes), 0);
      std::vector<int> by(static_cast<std::size_t>(loop.count()), 0);
      EXPECT_TRUE(loop.run(passes, [&](Index pass, int worker) {
        ++taken[static_cast<std::size_t>(pass)];
        ++by[static_cast<std::size_t>(worker)];  // one worker's passes do not meet
      }));
      EXPECT_EQ(taken, std::vector<int>(taken.size(), 1));
      int all = 0;
      for (int count : by) all += count;
      EXPECT_EQ(all, passes);
    }
  }
}

// Whoever runs the pass: each throws, and one of them arrives. The loop goes on to serve.
TEST(SharedLoop, ThrowsWhatAPassHasThrown) {
  for (const int threads : {1, 2, 5}) {
    SCOPED_TRACE(threads);
    SharedLoop loop(threads);
    for (const Index bad : {0, 7, 999}) {
      EXPECT_THROW((void)loop.run(1000,
                                  [&](Index pass, int) {
                                    if (pass >= bad) throw std::domain_error("a pass");
                                  }),
                   std::domain_error);
    }
    std::atomic<int> taken{0};
    EXPECT_TRUE(loop.run(100, [&](Index, int) { ++taken; }));
    EXPECT_EQ(taken, 100);
  }
}

TEST(SharedLoop, StopsBetweenPasses) {
  for (const int threads : {1, 3}) {
    SCOPED_TRACE(threads);
    std::atomic<bool> stop{false};
    std::atomic<int> taken{0};
    SharedLoop loop(threads, &stop);
    EXPECT_FALSE(loop.run(1000, [&](Index, int) {
      if (++taken == 10) stop = true;
    }));
    EXPECT_GE(taken, 10);
    EXPECT_LT(taken, 10 + threads);
    EXPECT_FALSE(loop.run(1000, [&](Index, int) { FAIL(); }));
  }
}

TEST(SharedLoop, LeavesProcessorsToTheHost) {
  EXPECT_GE(background_threads(), 1);
  EXPECT_LE(background_threads(), machine_threads());
  EXPECT_EQ(background_threads() == machine_threads(), machine_threads() == 1);
}

}  // namespace
}  // namespace sunder::linear_algebra
