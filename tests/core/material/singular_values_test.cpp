// SPDX-License-Identifier: Apache-2.0
// Singular values with signs and the polar decomposition, by what defines them.
#include "material/singular_values.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "core/material/random_gradients.hpp"

namespace sunder::test {
namespace {

constexpr double kRounding = 1e-14;  // forty roundings

void expect_rotation(const Mat3& r, const Mat3& f) {
  EXPECT_LE((r.transpose() * r - Mat3::Identity()).norm(), kRounding) << f;
  EXPECT_NEAR(r.determinant(), 1, kRounding) << f;
}

void expect_decomposed(const Mat3& f) {
  const SingularValues of = singular_values(f);
  expect_rotation(of.u, f);
  expect_rotation(of.v, f);
  EXPECT_LE((of.u * of.s.asDiagonal() * of.v.transpose() - f).norm(), kRounding * f.norm()) << f;
  EXPECT_GE(of.s[0], of.s[1]) << f;
  EXPECT_GE(of.s[1], std::abs(of.s[2]) * (1 - kRounding)) << f;
}

TEST(SingularValues, AreThoseOfGradientsOfAllKinds) {
  RandomGradients any(1);
  for (int i = 0; i < 100000; ++i) {
    expect_decomposed(any.matrix());
    const double s = any.number(0.1, 3);
    expect_decomposed(any.turned({s, s, s}));                                        // a ball
    expect_decomposed(any.turned({s, s, any.number(-3, 3)}));                        // two alike
    expect_decomposed(any.turned({s, s * (1 + 1e-9 * any.number(-1, 1)), 0.5}));     // nearly
    expect_decomposed(any.turned({s, 1e-9 * any.number(-1, 1), any.number(0, 1)}));  // flat
  }
}

TEST(SingularValues, AreThoseOfGradientsWithoutFullRank) {
  RandomGradients any(2);
  expect_decomposed(Mat3::Zero());
  EXPECT_EQ(polar(Mat3::Zero()).rotation, Mat3::Identity());
  for (int i = 0; i < 1000; ++i) {
    expect_decomposed(any.vector() * any.vector().transpose());
    const Vec3 a = any.vector(), b = any.vector();
    expect_decomposed(a * any.vector().transpose() + b * any.vector().transpose());
  }
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) expect_decomposed(Vec3::Unit(k) * Vec3::Unit(j).transpose());
  }
}

// F^T F would lose them: a squared one is below the others' rounding.
TEST(SingularValues, KeepTheDigitsOfSmallOnes) {
  RandomGradients any(3);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 f = any.rotation() * Vec3(1, 1e-6, 1e-12).asDiagonal();
    const Vec3 s = singular_values(f).s;
    EXPECT_NEAR(s[1] / 1e-6, 1, 1e-9);
    EXPECT_NEAR(s[2] / 1e-12, 1, 1e-3);
  }
}

// Turned ones of all stretches, flat, inverted and without rank too.
TEST(NearestRotation, IsThatOfThePolarDecomposition) {
  RandomGradients any(5);
  const auto expect_same = [](const Mat3& f) {
    const Mat3 r = nearest_rotation(f);
    expect_rotation(r, f);
    const SingularValues of = singular_values(f);
    if (of.s[1] + of.s[2] > 1e-3 * of.s[0]) {  // else many are about as near
      EXPECT_LE((r - polar(f).rotation).norm(), 1e-11) << f;
    }
  };
  for (int i = 0; i < 100000; ++i) {
    expect_same(any.matrix());
    expect_same(any.turned({any.number(0.1, 3), any.number(0.1, 3), any.number(-3, 3)}));
    expect_same(1e-6 * any.rotation());
    expect_same(1e6 * any.turned({1, 1, any.number(0, 0.01)}));
  }
  EXPECT_EQ(nearest_rotation(Mat3::Zero()), Mat3::Identity());
}

TEST(Polar, OfAProductOfARotationAndAStretch) {
  RandomGradients any(4);
  for (int i = 0; i < 10000; ++i) {
    const Mat3 r = any.rotation(), v = any.rotation();
    const Vec3 s(any.number(0.1, 3), any.number(0.1, 3), any.number(0.1, 3));
    const Mat3 stretch = v * s.asDiagonal() * v.transpose();
    const Polar of = polar(r * stretch);
    EXPECT_LE((of.rotation - r).norm(), 1e-13);
    EXPECT_LE((of.stretch - stretch).norm(), 1e-13);
  }
}

TEST(Polar, OfAnInvertedGradientIsTheNearestRotation) {
  RandomGradients any(5);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 f = any.turned({2, 1.5, -any.number(0.1, 1.4)});
    const Polar of = polar(f);
    expect_rotation(of.rotation, f);
    EXPECT_LE((of.rotation * of.stretch - f).norm(), kRounding * f.norm());
    for (int k = 0; k < 20; ++k) {
      EXPECT_LE((f - of.rotation).norm(), (f - any.rotation()).norm() * (1 + kRounding));
    }
    // And among small turns of it.
    for (int k = 0; k < 20; ++k) {
      const Vec3 turn = 1e-3 * any.vector();
      const Mat3 beside =
          Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * of.rotation;
      EXPECT_LE((f - of.rotation).norm(), (f - beside).norm() * (1 + kRounding));
    }
  }
}

}  // namespace
}  // namespace sunder::test
