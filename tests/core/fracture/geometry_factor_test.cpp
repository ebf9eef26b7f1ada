// SPDX-License-Identifier: Apache-2.0
// Geometry factors against published values: single edge notch and centre crack (Tada).
#include "fracture/geometry_factor.hpp"

#include <gtest/gtest.h>

#include <array>

namespace sunder::fracture {
namespace {

// x = 0.1 ... 0.6, printed to three decimals.
constexpr std::array<double, 6> kPolynomial{1.184, 1.371, 1.660, 2.104, 2.826, 4.026};
constexpr std::array<double, 6> kTada{1.196, 1.367, 1.655, 2.108, 2.827, 4.043};
constexpr std::array<double, 6> kCentre{1.006, 1.024, 1.058, 1.109, 1.186, 1.303};
constexpr double kPrinted = 5.1e-4;  // half of the last printed digit

TEST(EdgeFactor, MatchesThePublishedTables) {
  for (std::size_t i = 0; i < kPolynomial.size(); ++i) {
    const double x = 0.1 * static_cast<double>(i + 1);
    EXPECT_NEAR(edge_factor_polynomial(x), kPolynomial[i], kPrinted) << x;
    EXPECT_NEAR(edge_factor_tada(x), kTada[i], kPrinted) << x;
  }
}

TEST(EdgeFactor, ShortCrackOfAHalfPlane) { EXPECT_EQ(edge_factor(0), 1.12); }

TEST(EdgeFactor, PolynomialUpToSixTenthsThenTada) {
  EXPECT_EQ(edge_factor(0.6), edge_factor_polynomial(0.6));
  EXPECT_EQ(edge_factor(0.601), edge_factor_tada(0.601));
  EXPECT_GT(edge_factor(0.8), edge_factor(0.7));
}

TEST(EdgeFactor, LongCracksAreClampedAt95Percent) {
  EXPECT_EQ(edge_factor(1.0), edge_factor(0.95));
  EXPECT_EQ(edge_factor(7.0), edge_factor_tada(0.95));
}

TEST(InternalFactor, MatchesThePublishedTable) {
  for (std::size_t i = 0; i < kCentre.size(); ++i)
    EXPECT_NEAR(internal_factor(0.1 * static_cast<double>(i + 1)), kCentre[i], kPrinted) << i;
}

TEST(InternalFactor, IsOneForAShortCrackAndClamped) {
  EXPECT_EQ(internal_factor(0), 1);
  EXPECT_EQ(internal_factor(1.5), internal_factor(0.95));
}

}  // namespace
}  // namespace sunder::fracture
