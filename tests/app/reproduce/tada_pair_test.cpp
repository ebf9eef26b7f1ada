// SPDX-License-Identifier: Apache-2.0
// The force pair on an edge crack against its two known limits.
#include "app/reproduce/tada_pair.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sunder::test {
namespace {

using namespace app::reproduce;

TEST(TadaPair, NearTheTipItIsEq4) {
  // K = 2 P/sqrt(2 pi b') of an infinite body.
  for (const double length : {8.0, 16.0, 25.0})
    EXPECT_NEAR(
        tada_pair(1e-4 * length, length, 50) * std::sqrt(2 * std::numbers::pi * 1e-4 * length) / 2,
        1, 0.01)
        << length;
}

TEST(TadaPair, AtTheMouthOfAShortCrackItIsTheHalfPlanes) {
  // 2.594 P/sqrt(pi a) for a pair at the mouth of an edge crack in a half plane (same handbook).
  EXPECT_NEAR(tada_pair(8, 8, 1e6) * std::sqrt(std::numbers::pi * 8), 2.594, 0.02 * 2.594);
}

TEST(TadaPair, TurnsBetweenTipAndMouthAndEarlierTheDeeperTheCrack) {
  const double deep = tada_turn(25, 50), half = tada_turn(16, 50);
  EXPECT_LT(deep, half);
  EXPECT_GT(deep, 0.1);
  EXPECT_LT(half, 1);
  EXPECT_LT(tada_pair(16 * half, 16, 50), tada_pair(16 * 0.9 * half, 16, 50));
  EXPECT_LT(tada_pair(16 * half, 16, 50), tada_pair(16, 16, 50));
}

}  // namespace
}  // namespace sunder::test
