// SPDX-License-Identifier: Apache-2.0
// The yardstick's tetrahedron by hand: edges 2, 3 and 4 mm along the axes, so that volume 4 mm^3
// and gradients 1/2, 1/3 and 1/4 of corners 1 to 3; E = 5 and nu = 1/4, so that lambda = mu = 2
// MPa.
#include "cpu_reference/plain/element.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace sunder::plain {
namespace {

Element hand_element() {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}};
  mesh.tets = {{0, 1, 2, 3}};
  return {mesh, 0, {5, 0.25, std::nullopt}};
}

double rounded(Real value) { return static_cast<double>(value); }

TEST(PlainElement, StiffnessByHand) {
  const Element element = hand_element();
  EXPECT_NEAR(rounded(element.volume), 4, 1e-15);
  const Eigen::Matrix<double, 12, 12> k = element.stiffness().cast<double>();
  EXPECT_NEAR(k(3, 3), 4 * 6 * 0.25, 1e-14);     // V (lambda + 2 mu) / 2^2
  EXPECT_NEAR(k(4, 4), 4 * 2 * 0.25, 1e-14);     // V mu / 2^2
  EXPECT_NEAR(k(3, 7), 4 * 2 * 0.5 / 3, 1e-14);  // V lambda / (2 * 3)
  EXPECT_NEAR(k(4, 6), 4 * 2 * 0.5 / 3, 1e-14);  // V mu / (2 * 3)
  EXPECT_NEAR(k(3, 6), 0, 1e-14);                // no coupling
  EXPECT_NEAR(k(11, 11), 4 * 6.0 / 16, 1e-14);   // V (lambda + 2 mu) / 4^2
  EXPECT_NEAR(k(0, 0), 4 * (6.0 / 4 + 2.0 / 9 + 2.0 / 16), 1e-14);
  EXPECT_LE((k - k.transpose()).cwiseAbs().maxCoeff(), 1e-15);
  // Bodies that move or turn as a whole feel nothing; every column's forces cancel.
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Matrix<double, 12, 1> shift = Eigen::Matrix<double, 12, 1>::Zero();
    for (int a = 0; a < 4; ++a) shift[3 * a + axis] = 1;
    EXPECT_LE((k * shift).cwiseAbs().maxCoeff(), 1e-14);
  }
}

/// u = H x at the corners.
Real12 field(const Real3x3& h) {
  Real12 u = Real12::Zero();
  u.segment<3>(3) = 2 * h.col(0);
  u.segment<3>(6) = 3 * h.col(1);
  u.segment<3>(9) = 4 * h.col(2);
  return u;
}

TEST(PlainElement, StressAndGradientOfALinearField) {
  Element element = hand_element();
  Real3x3 h;
  h << 0.01, 0.02, 0.03, -0.04, 0.05, 0.06, 0.07, -0.08, 0.09;
  EXPECT_LE(rounded((element.gradient(field(h)) - h).norm()), 1e-17);
  // lambda tr e = 0.3; twice mu e.
  Voigt expected;
  expected << 0.34, 0.5, 0.66, -0.04, -0.04, 0.2;
  EXPECT_LE((element.stress(field(h)).cast<double>() - expected).norm(), 1e-15);
  element.share = 0.5;
  EXPECT_LE((element.stress(field(h)).cast<double>() - expected / 2).norm(), 1e-15);
  // Nodal forces are those of the stiffness.
  EXPECT_LE(rounded((element.forces(field(h)) - element.stiffness() * field(h)).norm()), 1e-17);
}

TEST(PlainElement, PrincipalValuesAndRotation) {
  Real3x3 tensor;
  tensor << 2, 1, 0, 1, 2, 0, 0, 0, -5;
  const auto p = principal_values(tensor);
  EXPECT_NEAR(rounded(p[0]), -5, 1e-15);
  EXPECT_NEAR(rounded(p[1]), 1, 1e-15);
  EXPECT_NEAR(rounded(p[2]), 3, 1e-15);
  for (const double degrees : {1e-7, 30.0, 120.0, 179.0}) {
    const Mat3 turn =
        Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3(1, 2, -3).normalized())
            .toRotationMatrix();
    Mat3 stretch;
    stretch << 1.2, 0.1, 0, 0.1, 0.9, 0, 0, 0, 1.1;
    const Mat3 h = turn * stretch - Mat3::Identity();
    EXPECT_NEAR(rounded(rotation_deg(h.cast<Real>())), degrees, 1e-13);
  }
  // Pressed inside out along z by a tenth of its height: what is left of it is no rotation.
  Real3x3 inside_out = Real3x3::Zero();
  inside_out(2, 2) = -1.1;
  EXPECT_NEAR(rounded(rotation_deg(inside_out)), 0, 1e-15);
}

}  // namespace
}  // namespace sunder::plain
