// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/auxiliary_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/field_sif/williams.hpp"

namespace sunder::fracture {
namespace {

constexpr TipMaterial kPlaneStress{5, 0.3, 0}, kPlaneStrain{5, 0.3, 1};

Vec2 polar(double r, double degrees) {
  const double t = degrees * std::numbers::pi / 180;
  return {r * std::cos(t), r * std::sin(t)};
}

TEST(AuxiliaryField, AheadOfTheTipEachModeHasItsStress) {
  const auto states = auxiliary_states({2, 0}, 0, kPlaneStress);
  const double s = 1 / std::sqrt(4 * std::numbers::pi);
  EXPECT_NEAR(states[kModeI].stress(1, 1), s, 1e-15);
  EXPECT_NEAR(states[kModeI].stress(0, 0), s, 1e-15);
  EXPECT_NEAR(states[kModeI].stress(0, 1), 0, 1e-15);
  EXPECT_NEAR(states[kModeII].stress(0, 1), s, 1e-15);
  EXPECT_NEAR(states[kModeII].stress(1, 1), 0, 1e-15);
  EXPECT_NEAR(states[kModeIII].stress(1, 2), s, 1e-15);
}

TEST(AuxiliaryField, FacesAreFree) {
  for (int side : {1, -1})
    for (const auto& state : auxiliary_states({-3, 0}, side, kPlaneStrain))
      EXPECT_LT((state.stress * Vec3::UnitY()).norm(), 1e-15);
}

TEST(AuxiliaryField, SlopesAreThoseOfWilliamsDisplacements) {
  const double step = 1e-6;
  for (const TipMaterial& material : {kPlaneStress, kPlaneStrain}) {
    for (double degrees : {-170.0, -90.0, -20.0, 40.0, 120.0, 179.0}) {
      const Vec2 x = polar(1.7, degrees);
      const auto states = auxiliary_states(x, 0, material);
      for (int mode = 0; mode < kModes; ++mode) {
        const Vec3 slope = (test::williams(x + Vec2(step, 0), mode, material) -
                            test::williams(x - Vec2(step, 0), mode, material)) /
                           (2 * step);
        EXPECT_LT((states[mode].slope - slope).norm(), 1e-8) << degrees << " deg, mode " << mode;
      }
    }
  }
}

TEST(AuxiliaryField, StressesAreThoseOfWilliamsDisplacements) {
  const double step = 1e-6, mu = kPlaneStrain.shear();
  const double lambda = 2 * mu * 0.3 / (1 - 0.6);
  const Vec2 x = polar(1.7, 130);
  const auto states = auxiliary_states(x, 0, kPlaneStrain);
  for (int mode = 0; mode < kModes; ++mode) {
    Mat3 gradient = Mat3::Zero();
    for (int j = 0; j < 2; ++j)
      gradient.col(j) = (test::williams(x + step * Vec2::Unit(j), mode, kPlaneStrain) -
                         test::williams(x - step * Vec2::Unit(j), mode, kPlaneStrain)) /
                        (2 * step);
    const Mat3 stress =
        mu * (gradient + gradient.transpose()) + lambda * gradient.trace() * Mat3::Identity();
    EXPECT_LT((states[mode].stress - stress).norm(), 1e-8) << "mode " << mode;
  }
}

TEST(AuxiliaryField, SideContinuesTheFieldBehindTheTip) {
  // Just below the line, but on the upper side of a bent crack: as just above it, and the
  // opposite of what the lower side has.
  const auto above = auxiliary_states({-2, 1e-9}, 1, kPlaneStress);
  const auto continued = auxiliary_states({-2, -1e-9}, 1, kPlaneStress);
  const auto below = auxiliary_states({-2, -1e-9}, -1, kPlaneStress);
  for (int mode = 0; mode < kModes; ++mode) {
    EXPECT_LT((above[mode].slope - continued[mode].slope).norm(), 1e-8);
    EXPECT_GT((below[mode].slope - continued[mode].slope).norm(), 0.01);
  }
}

TEST(AuxiliaryField, ShiftStatesAreTheIntegralsOfTheOthers) {
  const double step = 1e-6;
  for (double degrees : {-170.0, -20.0, 40.0, 179.0}) {
    const Vec2 x = polar(1.7, degrees), forward(step, 0);
    const auto states = auxiliary_states(x, 0, kPlaneStrain);
    const auto ahead = shift_states(x + forward, 0, kPlaneStrain);
    const auto behind = shift_states(x - forward, 0, kPlaneStrain);
    for (int mode = 0; mode < kModes; ++mode) {
      EXPECT_LT(
          ((ahead[mode].stress - behind[mode].stress) / (2 * step) + states[mode].stress).norm(),
          1e-8);
      EXPECT_LT(((ahead[mode].slope - behind[mode].slope) / (2 * step) + states[mode].slope).norm(),
                1e-8);
    }
  }
  for (int side : {1, -1})
    for (const auto& state : shift_states({-3, 0}, side, kPlaneStrain))
      EXPECT_LT((state.stress * Vec3::UnitY()).norm(), 1e-15);
}

TEST(AuxiliaryField, EffectiveModulus) {
  EXPECT_DOUBLE_EQ(kPlaneStress.effective_young(), 5);
  EXPECT_DOUBLE_EQ(kPlaneStrain.effective_young(), 5 / 0.91);
  EXPECT_NEAR(kPlaneStress.kolosov(), 2.7 / 1.3, 1e-15);
  EXPECT_NEAR(kPlaneStrain.kolosov(), 3 - 4 * 0.3, 1e-15);
}

}  // namespace
}  // namespace sunder::fracture
