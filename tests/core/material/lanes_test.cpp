// SPDX-License-Identifier: Apache-2.0
// What lanes.hpp computes in its own way: the logarithm, the largest principal value, the angle.
// The laws in it are tested by tests/core/body/hyperelastic_pass_test.cpp.
#include "material/lanes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/material/random_gradients.hpp"

namespace sunder::test {
namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon();

void expect_logarithm(double x) {
  const double expected = std::log(x);
  EXPECT_NEAR(lanes::log(x), expected, 2 * kUnit * std::abs(expected)) << x;
}

TEST(Lanes, Logarithm) {
  RandomGradients any(1);
  for (int i = 0; i < 100000; ++i) {
    expect_logarithm(any.number(0, 3));
    expect_logarithm(1 + 1e-6 * any.number(-1, 1));
    expect_logarithm(std::exp(any.number(-740, 700)));
  }
  for (double x : {1.0, 0.5, 2.0, 1 + kUnit, 1 - kUnit / 2, std::sqrt(0.5), std::sqrt(2.0),
                   std::numeric_limits<double>::min(), std::numeric_limits<double>::max(),
                   std::numeric_limits<double>::denorm_min()}) {
    expect_logarithm(x);
  }
  EXPECT_EQ(lanes::log(1), 0);
  EXPECT_FALSE(std::isfinite(lanes::log(std::numeric_limits<double>::infinity())));
  EXPECT_FALSE(std::isfinite(lanes::log(std::numeric_limits<double>::quiet_NaN())));
}

TEST(Lanes, LargestPrincipalValue) {
  RandomGradients any(2);
  const auto expect = [&](const Vec3& values) {
    const Mat3 r = any.rotation(), s = r * values.asDiagonal() * r.transpose();
    const double expected = values.cwiseAbs().maxCoeff();
    EXPECT_NEAR(lanes::largest_principal({s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)}),
                expected, 1e-7 * expected)
        << values;
  };
  for (int i = 0; i < 10000; ++i) {
    const double size = std::pow(10, any.number(-12, 2));
    expect(size * any.vector());
    expect(size * Vec3(1, 1, any.number(-1, 1)));
    expect(size * Vec3(any.number(-1, 1), -1, -1 + 1e-9 * any.number(0, 1)));
    expect(size * Vec3(1, 0, 0));
    expect(size * Vec3(1, -1, 0));
    expect(size * Vec3(1, 1, 1));
  }
  expect(Vec3::Zero());
}

TEST(Lanes, OneLessTheCosineOfARotation) {
  RandomGradients any(3);
  for (double angle : {0.0, 1e-9, 1e-3, 1.0, std::numbers::pi / 2, 3.0, std::numbers::pi}) {
    const Mat3 r(Eigen::AngleAxisd(angle, any.vector().normalized()));
    lanes::Matrix m;
    for (int i = 0; i < 9; ++i) m.at[i / 3][i % 3] = r(i / 3, i % 3);
    const double expected = 2 * std::sin(angle / 2) * std::sin(angle / 2);
    EXPECT_NEAR(lanes::one_less_cosine(m), expected, 1e-15 + 1e-6 * expected * expected);
  }
}

}  // namespace
}  // namespace sunder::test
