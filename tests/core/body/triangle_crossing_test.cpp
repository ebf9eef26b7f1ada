// SPDX-License-Identifier: Apache-2.0
// A triangle through a tetrahedron: places by hand, and against points inside both.
#include "body/triangle_crossing.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

namespace sunder::fem {
namespace {

const std::array<Vec3, 4> kTet{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};

TEST(TriangleCrossing, ByHand) {
  // A large one through the middle, a small one inside, and one whose corner alone enters.
  EXPECT_TRUE(crosses({Vec3(-5, -5, 0.2), Vec3(5, -5, 0.2), Vec3(0, 9, 0.2)}, kTet));
  EXPECT_TRUE(crosses({Vec3(0.1, 0.1, 0.1), Vec3(0.2, 0.1, 0.1), Vec3(0.1, 0.2, 0.15)}, kTet));
  EXPECT_TRUE(crosses({Vec3(0.2, 0.2, 0.2), Vec3(3, 3, 3), Vec3(3, 4, 3)}, kTet));
  // An edge passes through, no corner of either lies in the other.
  EXPECT_TRUE(crosses({Vec3(0.2, 0.2, -1), Vec3(0.2, 0.2, 2), Vec3(-9, -9, 0.5)}, kTet));
  // Beside it, above it, in the plane of a face, and at a corner, along an edge from outside.
  EXPECT_FALSE(crosses({Vec3(-5, -5, 1.2), Vec3(5, -5, 1.2), Vec3(0, 9, 1.2)}, kTet));
  EXPECT_FALSE(crosses({Vec3(2, 0, 0.2), Vec3(3, 0, 0.2), Vec3(2, 1, 0.2)}, kTet));
  EXPECT_FALSE(crosses({Vec3(-5, -5, 0), Vec3(5, -5, 0), Vec3(0, 9, 0)}, kTet));
  EXPECT_FALSE(crosses({Vec3(0, 0, 1), Vec3(1, 0, 2), Vec3(0, 1, 2)}, kTet));
  EXPECT_FALSE(crosses({Vec3(0, 0, 0), Vec3(0, 0, 1), Vec3(-1, -1, 0.5)}, kTet));
  // The slanted face's plane, from outside.
  EXPECT_FALSE(crosses({Vec3(0.4, 0.4, 0.4), Vec3(2, 0.4, 0.4), Vec3(0.4, 2, 0.4)}, kTet));
}

TEST(TriangleCrossing, OfNothingIsNone) {
  EXPECT_FALSE(crosses({Vec3(0, 0, 0.2), Vec3(0, 0, 0.2), Vec3(1, 1, 0.2)}, kTet));
  EXPECT_FALSE(crosses({Vec3(-1, 0.1, 0.1), Vec3(0, 0.1, 0.1), Vec3(1, 0.1, 0.1)}, kTet));
  EXPECT_FALSE(crosses({Vec3(NAN, 0, 0.2), Vec3(1, 0, 0.2), Vec3(1, 1, 0.2)}, kTet));
}

/// The part of a triangle inside a half space after the other, what is left has an area.
bool clipped(const std::array<Vec3, 3>& triangle, const std::array<Vec3, 4>& tet) {
  std::vector<Vec3> polygon(triangle.begin(), triangle.end());
  for (std::size_t f = 0; f < 4; ++f) {
    const Vec3 &p = tet[(f + 1) % 4], &q = tet[(f + 2) % 4], &r = tet[(f + 3) % 4];
    Vec3 inward = (q - p).cross(r - p);
    if (inward.dot(tet[f] - p) < 0) inward = -inward;
    std::vector<Vec3> rest;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double at_a = inward.dot(a - p), at_b = inward.dot(b - p);
      if (at_a >= 0) rest.push_back(a);
      if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) {
        rest.push_back(a + (b - a) * (at_a / (at_a - at_b)));
      }
    }
    polygon = rest;
  }
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    area += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  }
  return area.norm() > 1e-9;
}

TEST(TriangleCrossing, AgreesWithClipping) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> of(-1, 1);
  const auto point = [&] { return Vec3(of(random), of(random), of(random)); };
  int crossed = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 far = i % 2 == 0 ? Vec3(0, 0, 0) : Vec3(1000, -2000, 500);
    const std::array<Vec3, 3> triangle{far + point(), far + point(), far + point()};
    const std::array<Vec3, 4> tet{far + point(), far + point(), far + point(), far + point()};
    const bool right = clipped(triangle, tet);
    EXPECT_EQ(crosses(triangle, tet), right) << i;
    crossed += right ? 1 : 0;
  }
  EXPECT_GT(crossed, 400);
  EXPECT_LT(crossed, 3600);
}

}  // namespace
}  // namespace sunder::fem
