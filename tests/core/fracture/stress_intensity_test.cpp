// SPDX-License-Identifier: Apache-2.0
// Eq. 1-4 against hand values (method.md 6-9).
#include "fracture/stress_intensity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sunder::fracture {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;

TEST(TrescaZone, SixtyDegreesIsTheMaximumWith27Over16) {
  EXPECT_DOUBLE_EQ(reach(1, 1, 60 * kDegree) / reach(1, 1, 0), 27.0 / 16);
  for (int degrees = -180; degrees <= 180; ++degrees)
    EXPECT_LE(zone_shape(degrees * kDegree), zone_shape(60 * kDegree)) << degrees;
}

TEST(TrescaZone, IsEvenAndVanishesBehindTheTip) {
  EXPECT_NEAR(zone_shape(kPi), 0, 1e-30);
  EXPECT_EQ(zone_shape(0.7), zone_shape(-0.7));
  EXPECT_EQ(zone_shape(0), 1);
}

TEST(TrescaZone, ReachIsKSquaredOver2PiYieldSquared) {
  // K = 6 MPa sqrt(mm), yield 3 MPa: 36/(18 pi) = 2/pi mm straight ahead.
  EXPECT_DOUBLE_EQ(reach(6, 3, 0), 2 / kPi);
  EXPECT_DOUBLE_EQ(reach(6, 6, 0), reach(6, 3, 0) / 4);
  EXPECT_EQ(reach(0, 3, 1), 0);
}

TEST(ExpansionIntensity, FollowsTheSquareOfCosBeta) {
  const double straight = expansion_intensity(1.5, 1, 2, 4);
  EXPECT_DOUBLE_EQ(straight, 1.5 * 2 * std::sqrt(4 * kPi));
  EXPECT_NEAR(expansion_intensity(1.5, std::cos(30 * kDegree), 2, 4) / straight, 0.75, 1e-14);
  EXPECT_NEAR(expansion_intensity(1.5, std::cos(60 * kDegree), 2, 4) / straight, 0.25, 1e-14);
}

TEST(ExpansionIntensity, CompressionOpensNothing) {
  EXPECT_EQ(expansion_intensity(1.5, 1, -2, 4), 0);
}

TEST(PressureIntensity, BalancedPairAndSurplus) {
  // b' = 8/pi makes sqrt(2 pi b') = 4.
  const double distance = 8 / kPi;
  EXPECT_DOUBLE_EQ(balanced_intensity(3, 5, distance), 2 * 3 / 4.0);
  EXPECT_DOUBLE_EQ(one_sided_intensity(3, 5, distance), 2 / 4.0);
  EXPECT_DOUBLE_EQ(one_sided_intensity(5, 3, distance), 2 / 4.0);
  EXPECT_EQ(balanced_intensity(0, 5, distance), 0);
}

TEST(PressureIntensity, FallsWithTheRootOfTheDistance) {
  for (double b1 : {0.7, 3.0, 19.0}) {
    for (double b2 : {1.3, 11.0}) {
      const double ratio = balanced_intensity(2, 2, b1) / balanced_intensity(2, 2, b2);
      EXPECT_NEAR(ratio, std::sqrt(b2 / b1), 1e-12 * ratio);
    }
  }
}

TEST(TotalIntensity, SurplusActsWithOrAgainstTheExpansion) {
  EXPECT_EQ(total_intensity(5, 1, 2, 1), 8);
  EXPECT_EQ(total_intensity(5, 1, 2, -1), 4);
  EXPECT_EQ(total_intensity(1, 0, 2, -1), 0);
}

TEST(TotalIntensity, SignOfThePressureAgainstTheResultant) {
  const Vec3 up(0, 1, 0);
  EXPECT_EQ(pressure_sign(up, Vec3(3, 4, 0)), 1);
  EXPECT_EQ(pressure_sign(up, Vec3(3, -4, 0)), -1);
  EXPECT_EQ(pressure_sign(up, Vec3::Zero()), 1);
  EXPECT_EQ(pressure_sign(up, Vec3(1, -1e-10, 0)), 1) << "under 1e-9 of the resultant";
  EXPECT_EQ(pressure_sign(up, Vec3(1, -1e-8, 0)), -1);
}

TEST(GrowthAngle, CounterClockwiseIsPositiveAndClampedToRightAngles) {
  const Vec2 d(1, 0);
  EXPECT_NEAR(growth_angle(d, Vec2(1, 1)), 45 * kDegree, 1e-15);
  EXPECT_NEAR(growth_angle(d, Vec2(1, -1)), -45 * kDegree, 1e-15);
  EXPECT_DOUBLE_EQ(growth_angle(d, Vec2(-1, 0.1)), kPi / 2);
  EXPECT_DOUBLE_EQ(growth_angle(d, Vec2(-1, -0.1)), -kPi / 2);
  // Seen from a crack that runs to the left, up is to the right.
  EXPECT_NEAR(growth_angle(Vec2(-1, 0), Vec2(-1, 1)), -45 * kDegree, 1e-15);
}

TEST(GrowthAngle, TurningByItGivesTheDirection) {
  const Vec2 d = Vec2(3, -4) / 5, v(2, 1);
  EXPECT_NEAR((turned(d, growth_angle(d, v)) - v.normalized()).norm(), 0, 1e-15);
  EXPECT_EQ(turned(d, 0), d);
}

}  // namespace
}  // namespace sunder::fracture
