// SPDX-License-Identifier: Apache-2.0
// Kinks: published values, expansions by hand, and the turn that a tissue with fibres prefers.
#include "fracture/kinked_crack.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;

const BoardPlane& plane() {
  static const BoardPlane of{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), {}, {}, 0, 1, 1};
  return of;
}

/// K_c^2 = 1 along fibres at an angle to x, `ratio` across.
TipResistance fibres_at(double angle, double ratio) {
  TipResistance of;
  const Vec3 along(std::cos(angle), std::sin(angle), 0);
  of.along = 1;
  of.across = (ratio - 1) * along * along.transpose();
  of.plane = &plane();
  return of;
}

/// Nuismer's approximation (Int. J. Fracture 11, 1975) of G(theta) E', from the stress on the ray.
double nuismer(double k_1, double k_2, double theta) {
  const double half = std::cos(theta / 2) / 2, c = std::cos(theta), s = std::sin(theta);
  const double opening = half * (k_1 * (1 + c) - 3 * k_2 * s);
  const double sliding = half * (k_1 * s + k_2 * (3 * c - 1));
  return opening * opening + sliding * sliding;
}

// First terms of the expansion: k_1 = K_I - 3/2 theta K_II, k_2 = K_II + theta/2 K_I (Cotterell and
// Rice, Int. J. Fracture 16, 1980).
TEST(KinkedCrack, SmallTurnsAreThoseOfFirstOrder) {
  for (const double theta : {-1e-4, 2e-4}) {
    const KinkIntensity k = kinked(2, 3, theta);
    EXPECT_NEAR(k.k_1, 2 - 4.5 * theta, 1e-6);
    EXPECT_NEAR(k.k_2, 3 + theta, 1e-6);
  }
  EXPECT_EQ(kinked(2, 3, 0).k_1, 2);
  EXPECT_EQ(kinked(2, 3, 0).k_2, 3);
  EXPECT_EQ(kinked(-2, 0, 0.3).squared(), 0) << "closed";
}

// A sheared crack: k_2 = 0 at 77.3 deg; the largest energy, a degree or two before (Amestoy and
// Leblond 1992).
TEST(KinkedCrack, OfShearTurnsAsPublished) {
  EXPECT_LT(kinked(0, 1, -77.2 * kOneDegree).k_2 * kinked(0, 1, -77.5 * kOneDegree).k_2, 0);
  const auto turn = easiest_turn(0, 1, Vec2::UnitX(), fibres_at(0, 1));
  ASSERT_TRUE(turn);
  EXPECT_NEAR(turn->theta / kOneDegree, -75.7, 0.3);
}

TEST(KinkedCrack, IsNuismersUpToItsHigherOrders) {
  // Of shear they begin with theta^2: 1 - 3/8 theta^2 - (2 theta/pi)^2 for 1 - 7/8 theta^2.
  const double of_shear = 1 - 8 / (std::numbers::pi * std::numbers::pi);
  for (const double degrees : {-25.0, -5.0, 10.0, 20.0}) {
    const double theta = degrees * kOneDegree, square = theta * theta;
    EXPECT_NEAR(kinked(1, 0, theta).squared(), nuismer(1, 0, theta), 0.006 * square * square);
    const double beyond = kinked(0, 1, theta).squared() - nuismer(0, 1, theta);
    EXPECT_NEAR(beyond, of_shear * square, 0.015 * square) << degrees;
  }
}

TEST(KinkedCrack, TurnsTowardsFibresAsEnergyOverToughnessSays) {
  for (const double fibres : {20.0, 45.0, 60.0, -30.0}) {
    for (const double ratio : {1.5, 4.0, 9.0}) {
      const TipResistance resistance = fibres_at(fibres * kOneDegree, ratio);
      const auto turn = easiest_turn(1, 0, Vec2::UnitX(), resistance);
      ASSERT_TRUE(turn);
      double best = 0, expected = 0;
      for (double degrees = -80; degrees <= 80; degrees += 0.02) {
        const double across = std::sin((degrees - fibres) * kOneDegree);
        const double g = nuismer(1, 0, degrees * kOneDegree) / (1 + (ratio - 1) * across * across);
        if (g > best) {
          best = g;
          expected = degrees;
        }
      }
      EXPECT_NEAR(turn->theta / kOneDegree, expected, 0.3) << fibres << ", " << ratio;
      EXPECT_NEAR(turn->intensity * turn->intensity, nuismer(1, 0, turn->theta), 0.01);
    }
  }
}

// The frame turns with the crack: the same tissue seen from a crack in another direction.
TEST(KinkedCrack, SeesFibresFromItsOwnDirection) {
  const double turned_by = 0.7;
  const auto one = easiest_turn(1, 0.2, Vec2::UnitX(), fibres_at(0.5, 3));
  const auto other = easiest_turn(1, 0.2, turned(Vec2::UnitX(), turned_by), fibres_at(1.2, 3));
  ASSERT_TRUE(one && other);
  EXPECT_NEAR(one->theta, other->theta, 1e-9);
}

TEST(KinkedCrack, OfEqualTurnsTakesOneAndAlwaysTheSame) {
  // Fibres across the crack: both sides are as good.
  const auto turn = easiest_turn(1, 0, Vec2::UnitX(), fibres_at(90 * kOneDegree, 9));
  ASSERT_TRUE(turn);
  EXPECT_LT(turn->theta, 0);
  EXPECT_EQ(turn->theta, easiest_turn(1, 0, Vec2::UnitX(), fibres_at(90 * kOneDegree, 9))->theta);
  EXPECT_FALSE(easiest_turn(-1, 0, Vec2::UnitX(), fibres_at(0, 2)));
  EXPECT_FALSE(easiest_turn(0, 0, Vec2::UnitX(), fibres_at(0, 2)));
}

}  // namespace
}  // namespace sunder::fracture
