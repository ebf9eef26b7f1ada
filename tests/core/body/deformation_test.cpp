// SPDX-License-Identifier: Apache-2.0
// Strain and rotation of one element against hand values, and their bounds against them.
#include "body/deformation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <random>

namespace sunder::fem {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Mat3 rotation(double degrees, const Vec3& axis) {
  return Eigen::AngleAxisd(degrees * kDegree, axis.normalized()).toRotationMatrix();
}

class Random {
 public:
  double operator()() { return any_(generator_); }
  Vec3 vector() { return {(*this)(), (*this)(), (*this)()}; }
  Mat3 matrix() {
    Mat3 m;
    m << vector(), vector(), vector();
    return m;
  }

 private:
  std::mt19937 generator_{11};
  std::uniform_real_distribution<double> any_{-1, 1};
};

/// The rotation nearest to F by its singular value decomposition.
double nearest_rotation_deg(const Mat3& f) {
  const Eigen::JacobiSVD<Mat3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return Eigen::AngleAxisd(u * svd.matrixV().transpose()).angle() / kDegree;
}

TEST(Deformation, OfAPureRotationByThirtyDegrees) {
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 2, -3)}) {
    const Mat3 h = rotation(30, axis) - Mat3::Identity();
    EXPECT_NEAR(rotation_deg(h), 30, 1e-12);
    // sym(R - I) = (cos 30 - 1)(I - n n^T).
    EXPECT_NEAR(principal_strain(h), std::sqrt(3) / 2 - 1, 1e-8);
  }
}

TEST(Deformation, OfAStretchTheStrainIsThatOfTheLongestChange) {
  EXPECT_NEAR(principal_strain(Vec3(0.2, -0.08, -0.08).asDiagonal()), 0.2, 1e-9);
  EXPECT_NEAR(principal_strain(Vec3(0.1, -0.3, 0.05).asDiagonal()), -0.3, 1e-9);
  EXPECT_NEAR(principal_strain(Vec3(0.1, 0, -0.1).asDiagonal()), 0.1, 1e-9);
  EXPECT_EQ(principal_strain(Mat3::Zero()), 0);
  EXPECT_EQ(rotation_deg(Vec3(0.2, -0.08, -0.08).asDiagonal()), 0);
  Mat3 shear = Mat3::Zero();
  shear(0, 1) = 0.2;  // engineering shear
  EXPECT_NEAR(principal_strain(shear), 0.1, 1e-9);
  EXPECT_NEAR(rotation_deg(shear), std::atan(0.1) / kDegree, 1e-12);
}

TEST(Deformation, RotationIsThatOfThePolarDecomposition) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 90 * (1 + random());
    const Mat3 q = rotation(180 * random(), random.vector());
    const Vec3 stretches = Vec3::Constant(1.1) + random.vector();
    const Mat3 f = rotation(angle, random.vector()) * q * stretches.asDiagonal() * q.transpose();
    // Near 180 deg the tangent of the half angle takes digits.
    EXPECT_NEAR(rotation_deg(f - Mat3::Identity()), angle, angle < 179 ? 1e-8 : 1e-5) << f;
  }
}

TEST(Deformation, RotationOfAnInvertedElementIsTheNearestOne) {
  Random random;
  int inverted = 0;
  for (int i = 0; i < 2000; ++i) {
    const Mat3 f = Mat3::Identity() + 2 * random.matrix();
    inverted += f.determinant() < 0;
    const double expected = nearest_rotation_deg(f);
    EXPECT_NEAR(rotation_deg(f - Mat3::Identity()), expected, expected < 179 ? 1e-6 : 1e-3) << f;
  }
  EXPECT_GT(inverted, 300);
}

TEST(Deformation, BoundsAreNeverUnderTheExactValues) {
  Random random;
  for (int i = 0; i < 30000; ++i) {
    const double size = std::pow(10, 3.5 * random() - 2.5);  // to ten
    Mat3 h = size * random.matrix();
    if (i % 3 == 0)
      h = rotation(180 * random(), random.vector()) * (Mat3::Identity() + h) - Mat3::Identity();
    const DeformationBounds bounds = deformation_bounds(h);
    EXPECT_GE(bounds.strain * (1 + 1e-8), std::abs(principal_strain(h))) << h;
    EXPECT_GE(bounds.rotation_deg() * (1 + 1e-9) + 1e-9, rotation_deg(h)) << h;
    if (bounds.compression < 1) {
      EXPECT_GT((Mat3::Identity() + h).determinant(), 0) << h;
    }
  }
}

TEST(Deformation, BoundsAreReachedByWhatTheyAreMadeFor) {
  // One stretch with equal narrowing, turned about its own axis.
  const Mat3 f = rotation(25, Vec3(0, 1, 0)) * Vec3(0.98, 1.05, 0.98).asDiagonal().toDenseMatrix();
  const DeformationBounds bounds = deformation_bounds(f - Mat3::Identity());
  EXPECT_NEAR(bounds.rotation_deg(), 25, 1e-9);
  const Mat3 pulled = Vec3(-0.08, 0.2, -0.08).asDiagonal();
  EXPECT_NEAR(deformation_bounds(pulled).strain, 0.2, 1e-12);
  EXPECT_NEAR(deformation_bounds(-5 * pulled).compression, 1, 1e-12);
}

}  // namespace
}  // namespace sunder::fem
