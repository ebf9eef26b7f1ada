// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/tangential_stress.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sunder::fracture {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

TEST(TangentialStress, PureModes) {
  EXPECT_EQ(tangential_angle(1, 0), 0);
  EXPECT_EQ(tangential_angle(0, 0), 0);
  EXPECT_NEAR(tangential_angle(0, 1) * kDegrees, -70.528779, 1e-6);  // cos(theta) = 1/3
  EXPECT_NEAR(tangential_angle(0, -1) * kDegrees, 70.528779, 1e-6);
  EXPECT_NEAR(tangential_intensity(2, 0, 0), 2, 1e-15);
  EXPECT_NEAR(tangential_intensity(0, 1, tangential_angle(0, 1)), 2 / std::sqrt(3), 1e-12);
}

TEST(TangentialStress, TheAngleHasTheLargestTangentialStress) {
  for (double k_2 : {-3.0, -0.4, 1e-9, 0.2, 1.0}) {
    const double best = tangential_angle(1, k_2);
    const double there = tangential_intensity(1, k_2, best);
    for (double theta = -3.1; theta < 3.1; theta += 0.01)
      EXPECT_LE(tangential_intensity(1, k_2, theta), there + 1e-12) << k_2 << " " << theta;
  }
}

TEST(TangentialStress, ClosedCrackOnlySlides) {
  EXPECT_EQ(tangential_angle(-5, 1), tangential_angle(0, 1));
  EXPECT_EQ(tangential_intensity(-5, 0, 0), 0);
}

}  // namespace
}  // namespace sunder::fracture
