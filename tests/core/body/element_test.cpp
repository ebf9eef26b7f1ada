// SPDX-License-Identifier: Apache-2.0
// One tetrahedron against values worked out by hand: corners at the origin and at (2,0,0),
// (0,3,0), (0,0,4), so V = 4 and the gradients are the reciprocal edge lengths.
#include "body/element.hpp"
#include "sunder/stress_measures.hpp"

#include <gtest/gtest.h>

#include "cpu_reference/plain/element.hpp"

namespace sunder::fem {
namespace {

TetShape hand_tet() { return tet_shape({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}); }

TEST(Element, VolumeAndGradientsByHand) {
  const TetShape shape = hand_tet();
  EXPECT_DOUBLE_EQ(shape.volume, 4.0);
  Eigen::Matrix<double, 3, 4> expected;
  expected << -1.0 / 2, 1.0 / 2, 0, 0,  //
      -1.0 / 3, 0, 1.0 / 3, 0,          //
      -1.0 / 4, 0, 0, 1.0 / 4;
  EXPECT_LE((shape.gradient - expected).cwiseAbs().maxCoeff(), 1e-16);
}

TEST(Element, VolumeIsSigned) {
  EXPECT_DOUBLE_EQ(tet_shape({0, 0, 0}, {0, 3, 0}, {2, 0, 0}, {0, 0, 4}).volume, -4.0);
}

// E = 5, nu = 1/4: lambda = mu = 2.
TEST(Element, ElasticityByHand) {
  Matrix6 expected = Matrix6::Zero();
  expected.topLeftCorner<3, 3>().setConstant(2);
  expected.diagonal() << 6, 6, 6, 2, 2, 2;
  EXPECT_LE((elasticity(small_strain({5, 0.25, std::nullopt})) - expected).cwiseAbs().maxCoeff(),
            1e-15);
}

// Rows xx, yy, zz, xy, yz, zx; node 1 moves gradients (1/2, 0, 0), node 2 (0, 1/3, 0).
TEST(Element, StrainDisplacementByHand) {
  const StrainDisplacement b = strain_displacement(hand_tet());
  using Column = Eigen::Matrix<double, 6, 1>;
  const auto column = [](double xx, double yy, double zz, double xy, double yz, double zx) {
    Column c;
    c << xx, yy, zz, xy, yz, zx;
    return c;
  };
  const double x = 0.5, y = 1.0 / 3, z = 0.25;
  const std::vector<Column> expected = {
      column(-x, 0, 0, -y, 0, -z), column(0, -y, 0, -x, -z, 0), column(0, 0, -z, 0, -y, -x),
      column(x, 0, 0, 0, 0, 0),    column(0, 0, 0, x, 0, 0),    column(0, 0, 0, 0, 0, x),
      column(0, 0, 0, y, 0, 0),    column(0, y, 0, 0, 0, 0),    column(0, 0, 0, 0, y, 0),
      column(0, 0, 0, 0, 0, z),    column(0, 0, 0, 0, z, 0),    column(0, 0, z, 0, 0, 0)};
  for (int i = 0; i < 12; ++i) {
    EXPECT_LE((b.col(i) - expected[i]).cwiseAbs().maxCoeff(), 1e-16) << "column " << i;
  }
}

// K_e = V B^T D B with lambda = mu = 2, V = 4: entries of the product by hand.
TEST(Element, StiffnessByHand) {
  const ElementMatrix k =
      element_stiffness(hand_tet(), elasticity(small_strain({5, 0.25, std::nullopt})));
  EXPECT_NEAR(k(3, 3), 4 * 6 * 0.25, 1e-14);     // V (lambda + 2 mu) / 2^2
  EXPECT_NEAR(k(4, 4), 4 * 2 * 0.25, 1e-14);     // V mu / 2^2
  EXPECT_NEAR(k(3, 7), 4 * 2 * 0.5 / 3, 1e-14);  // V lambda / (2 * 3)
  EXPECT_NEAR(k(4, 6), 4 * 2 * 0.5 / 3, 1e-14);  // V mu / (2 * 3)
  EXPECT_NEAR(k(3, 6), 0, 1e-14);                // x of nodes 1 and 2 do not couple
  EXPECT_NEAR(k(11, 11), 4 * 6.0 / 16, 1e-14);   // V (lambda + 2 mu) / 4^2
  EXPECT_NEAR(k(0, 0), 4 * (6.0 / 4 + 2.0 / 9 + 2.0 / 16), 1e-14);
  EXPECT_NEAR(k(0, 1), 4 * (2 + 2) / 6.0, 1e-14);  // V (lambda + mu) / (2 * 3)
  EXPECT_LE((k - k.transpose()).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Element, StiffnessAgreesWithIndependentDerivation) {
  Mesh mesh;
  mesh.nodes = {{0.1, 0.2, -0.3}, {1.4, 0.3, 0.2}, {0.2, 1.9, 0.1}, {0.4, 0.3, 2.2}};
  mesh.tets = {{0, 1, 2, 3}};
  const Material m{7.5, 0.41, std::nullopt};
  const ElementMatrix expected = plain::Element(mesh, 0, m).stiffness().cast<double>();
  const TetShape shape = tet_shape(mesh.nodes[0], mesh.nodes[1], mesh.nodes[2], mesh.nodes[3]);
  const ElementMatrix k = element_stiffness(shape, elasticity(small_strain(m)));
  EXPECT_LE((k - expected).norm(), 1e-14 * expected.norm());
}

TEST(Element, UpdateFactorSquaresToTheDestroyedShare) {
  const Matrix6 d = elasticity(small_strain({8, 0.4, std::nullopt}));
  const double alpha = 1e-6;
  const UpdateFactor u = update_factor(hand_tet(), small_strain({8, 0.4, std::nullopt}), alpha);
  const ElementMatrix expected = (1 - alpha) * element_stiffness(hand_tet(), d);
  EXPECT_LE((u * u.transpose() - expected).norm(), 1e-14 * expected.norm());
}

Eigen::Matrix<double, 3, 4> linear_field(const Mat3& gradient, const Vec3& offset) {
  Eigen::Matrix<double, 3, 4> corners;
  corners << 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4;
  return (gradient * corners).colwise() + offset;
}

// u = (0.1 x + 0.2 y, 0.3 y, 0.4 z + 0.5 x): strain (.1, .3, .4, .2, 0, .5), trace .8, lambda = mu
// = 2.
TEST(Element, StressByHand) {
  Mat3 h;
  h << 0.1, 0.2, 0, 0, 0.3, 0, 0.5, 0, 0.4;
  const Voigt s =
      stress(hand_tet(), small_strain({5, 0.25, std::nullopt}), linear_field(h, Vec3::Zero()));
  Voigt expected;
  expected << 1.6 + 0.4, 1.6 + 1.2, 1.6 + 1.6, 0.4, 0.0, 1.0;
  EXPECT_LE((s - expected).cwiseAbs().maxCoeff(), 1e-15 * 8);
}

TEST(Element, RigidTranslationLeavesStressExact) {
  Mat3 h = Mat3::Zero();
  h(0, 0) = 1;
  const Material m{5, 0.25, std::nullopt};
  const Voigt at_rest = stress(hand_tet(), small_strain(m), linear_field(h, Vec3::Zero()));
  // 2^20 is exact in double: the differences, and so the stress, must not change at all.
  const Voigt moved = stress(hand_tet(), small_strain(m), linear_field(h, Vec3::Constant(1048576)));
  EXPECT_EQ(at_rest, moved);
}

TEST(Element, RigidRotationGivesNoForce) {
  Mat3 h;
  h << 0, -0.3, 0.2, 0.3, 0, -0.1, -0.2, 0.1, 0;  // infinitesimal rotation
  const Voigt s =
      stress(hand_tet(), small_strain({5, 0.25, std::nullopt}), linear_field(h, Vec3(1, 2, 3)));
  EXPECT_LE(s.cwiseAbs().maxCoeff(), 6 * 4 * 2.3e-16);  // (lambda + 2 mu) times rounding of u
}

// Pure shear 3 in xy with mean stress 2: principal values 5, 2, -1; maximum shear 3, Tresca 6.
TEST(Element, PrincipalStressesByHand) {
  Voigt s;
  s << 2, 2, 2, 3, 0, 0;
  EXPECT_LE((principal_stresses(s) - Vec3(5, 2, -1)).cwiseAbs().maxCoeff(), 4e-15);
  EXPECT_NEAR(max_shear(s), 3, 4e-15);
  EXPECT_NEAR(yield_measure(s, YieldMeasure::max_shear), 3, 4e-15);
  EXPECT_NEAR(yield_measure(s, YieldMeasure::tresca), 6, 8e-15);
}

// Each shear component sits where Voigt order puts it: the tensor's eigenvectors tell them apart.
TEST(Element, TensorPlacesEveryComponent) {
  Voigt s;
  s << 1, 2, 3, 4, 5, 6;
  Mat3 expected;
  expected << 1, 4, 6, 4, 2, 5, 6, 5, 3;
  EXPECT_EQ(tensor(s), expected);
}

}  // namespace
}  // namespace sunder::fem
