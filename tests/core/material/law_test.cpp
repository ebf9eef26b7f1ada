// SPDX-License-Identifier: Apache-2.0
// Every law against differences of its own energy and stress, rotations, and the linear law.
#include "material/law.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <string>

#include "core/material/random_gradients.hpp"
#include "material/finite_stress.hpp"
#include "material/linear.hpp"

namespace sunder::test {
namespace {

const SmallStrain kTissue = small_strain({5, 0.4, 2.0});
const SmallStrain kNearlyIncompressible = small_strain({5, 0.49, 2.0});
const Mat3 kOne = Mat3::Identity();

/// Fourth-order central differences: the error of a step h is h^4 times the fifth derivative, of
/// rounding 1e-16/h.
constexpr double kStep = 1e-3;
template <class Function>
auto difference(const Function& at) {
  using Value = decltype(at(0.0));
  return Value((8 * (at(kStep) - at(-kStep)) - (at(2 * kStep) - at(-2 * kStep))) / (12 * kStep));
}

Mat3 unit(int entry) {
  Mat3 m = Mat3::Zero();
  m.data()[entry] = 1;
  return m;
}

/// What finite.md asks for is 1e-7, relative to the largest entry.
constexpr double kAgreement = 1e-7;

void expect_derivatives(const Law& law, const SmallStrain& of, const Mat3& f) {
  const Mat3 p = law.stress(of, f);
  const Matrix9 tangent = law.tangent(of, f).matrix();
  const double stiff = tangent.cwiseAbs().maxCoeff();
  for (int k = 0; k < 9; ++k) {
    const double w = difference([&](double h) { return law.energy(of, f + h * unit(k)); });
    EXPECT_NEAR(p.data()[k], w, kAgreement * (p.norm() + of.mu)) << law.name << "\n" << f;
    const Mat3 dp = difference([&](double h) { return Mat3(law.stress(of, f + h * unit(k))); });
    EXPECT_LE((Eigen::Map<const Vector9>(dp.data()) - tangent.col(k)).cwiseAbs().maxCoeff(),
              kAgreement * stiff)
        << law.name << "\n"
        << f;
  }
}

class EveryLaw : public testing::TestWithParam<std::string> {
 protected:
  const Law& law() const { return *find_law(GetParam()); }
  bool linear() const { return GetParam() == "linear"; }
  bool takes_inverted() const { return GetParam() != "neo-hookean"; }
};
/// What a test's name may hold.
std::string without_hyphens(const testing::TestParamInfo<std::string>& of) {
  std::string name = of.param;
  std::erase(name, '-');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Laws, EveryLaw,
                         testing::Values("linear", "corotated", "neo-hookean",
                                         "saint-venant-kirchhoff"),
                         without_hyphens);

TEST(Laws, AreFoundByTheirNames) {
  EXPECT_EQ(laws().size(), 4u);  // each has its place in the tests of every law
  for (const Law* law : laws()) EXPECT_EQ(find_law(law->name), law);
  EXPECT_EQ(find_law("mooney"), nullptr);
}

TEST_P(EveryLaw, StressAndTangentAreDerivatives) {
  RandomGradients any(11);
  for (int i = 0; i < 300; ++i) {
    const auto stretch = [&] { return any.number(0.4, 2.5); };
    const double s = stretch();
    for (const SmallStrain& of : {kTissue, kNearlyIncompressible}) {
      expect_derivatives(law(), of, kOne + 0.05 * any.matrix());
      expect_derivatives(law(), of, any.turned({stretch(), stretch(), stretch()}));
      expect_derivatives(law(), of, any.turned({s, s, stretch()}));
      expect_derivatives(law(), of, any.turned({s, s * (1 + 1e-9), s * (1 - 1e-8)}));
    }
  }
}

// Away from s1 + s2 = 0, where the rotation jumps.
TEST_P(EveryLaw, StressAndTangentOfInvertedElementsAreDerivatives) {
  if (!takes_inverted()) {
    EXPECT_TRUE(std::isinf(law().energy(kTissue, Vec3(1, 1, -1e-9).asDiagonal())));
    EXPECT_TRUE(std::isinf(law().energy(kTissue, Mat3::Zero())));
    EXPECT_TRUE(std::isinf(law().energy(kTissue, -kOne)));
    return;
  }
  RandomGradients any(12);
  for (int i = 0; i < 300; ++i) {
    const Vec3 s(any.number(1, 2), any.number(0.8, 1), -any.number(0.05, 0.5));
    expect_derivatives(law(), kTissue, any.turned(s));
    expect_derivatives(law(), kTissue, any.turned({s[0], s[0], s[2]}));
  }
}

TEST_P(EveryLaw, RigidRotationsBearNoStress) {
  if (linear()) {  // what the other laws are for: (cos 90 - 1) (2 mu + 2 lambda) across the axis
    const Mat3 quarter = Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitZ()).toRotationMatrix();
    EXPECT_NEAR(law().stress(kTissue, quarter)(0, 0), -2 * (kTissue.mu + kTissue.lambda), 1e-12);
    return;
  }
  RandomGradients any(13);
  for (double degrees : {30.0, 90.0, 180.0}) {
    for (int i = 0; i < 100; ++i) {
      const Vec3 axis = i < 3 ? Vec3(Vec3::Unit(i)) : any.vector().normalized();
      const Mat3 r = Eigen::AngleAxisd(degrees * EIGEN_PI / 180, axis).toRotationMatrix();
      // R itself is orthogonal to some 1e-16, which the stiffest direction multiplies.
      const double rounding = 1e-14 * kTissue.stiffest();
      EXPECT_LE(law().stress(kTissue, r).norm(), rounding) << degrees;
      EXPECT_LE(std::abs(law().energy(kTissue, r)), rounding) << degrees;
      EXPECT_LE(cauchy_stress(law().stress(kTissue, r), r).norm(), rounding) << degrees;
    }
  }
}

TEST_P(EveryLaw, IsObjectiveAndIsotropic) {
  if (linear()) return;
  RandomGradients any(14);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 q = any.rotation();
    const Mat3 f = any.turned({any.number(0.5, 2), any.number(0.5, 2), any.number(0.5, 2)});
    const Mat3 p = law().stress(kTissue, f);
    const double rounding = 1e-13 * (p.norm() + kTissue.stiffest());
    EXPECT_LE((law().stress(kTissue, q * f) - q * p).norm(), rounding);
    EXPECT_LE((law().stress(kTissue, f * q) - p * q).norm(), rounding);
    EXPECT_NEAR(law().energy(kTissue, q * f), law().energy(kTissue, f), rounding);
    // The true stress turns with the body, the nominal one does not notice; both are symmetric.
    EXPECT_LE((p * f.transpose() - f * p.transpose()).norm(), rounding * f.norm());
    EXPECT_LE((biot_stress(q * p, q * f) - biot_stress(p, f)).norm(), rounding);
  }
}

TEST_P(EveryLaw, IsTheLinearOneAtSmallStrain) {
  RandomGradients any(15);
  for (int i = 0; i < 100; ++i) {
    const Mat3 h = any.matrix();
    double off[2];
    for (int k = 0; k < 2; ++k) {
      const double size = k == 0 ? 1e-3 : 1e-4;
      const Mat3 f = kOne + size * h;
      const Voigt expected = stress(kTissue, size * h);
      off[k] = (cauchy_stress(law().stress(kTissue, f), f) - expected).norm() / expected.norm();
      EXPECT_LE(off[k], 20 * size);
    }
    // Of the order of the strain: a tenth of it has a tenth of the difference.
    EXPECT_NEAR(off[1] / off[0], 0.1, 0.02);
  }
  const Matrix9 at_rest = law().tangent(kTissue, kOne).matrix();
  for (int k = 0; k < 9; ++k) {
    const Mat3 p = Eigen::Map<const Mat3>(at_rest.col(k).data());
    Voigt entries;
    entries << p(0, 0), p(1, 1), p(2, 2), p(0, 1), p(1, 2), p(2, 0);
    EXPECT_LE((entries - stress(kTissue, unit(k))).norm(), 1e-13);
    EXPECT_LE((p - p.transpose()).norm(), 1e-13);
  }
}

TEST_P(EveryLaw, ProjectedTangentIsTheNearestSemidefiniteOne) {
  RandomGradients any(16);
  int definite = 0, indefinite = 0;
  for (int i = 0; i < 1000; ++i) {
    const double least = takes_inverted() ? -0.5 : 0.2;
    const Mat3 f = any.turned({any.number(0.5, 2), any.number(0.5, 2), any.number(least, 1.5)});
    const SpectralTangent spectral = law().tangent(kTissue, f);
    EXPECT_LE((spectral.modes.transpose() * spectral.modes - Matrix9::Identity()).norm(), 1e-13);
    const Matrix9 exact = spectral.matrix(), projected = spectral.projected();
    const Eigen::SelfAdjointEigenSolver<Matrix9> solver(exact);
    const Matrix9 expected = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() *
                             solver.eigenvectors().transpose();
    const double rounding = 1e-13 * exact.norm();
    EXPECT_LE((projected - projected.transpose()).norm(), rounding);
    EXPECT_LE((projected - expected).norm(), 10 * rounding);
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix9>(projected).eigenvalues()[0], -rounding);
    const bool semidefinite = spectral.values.minCoeff() >= 0;
    if (semidefinite) {
      EXPECT_LE((projected - exact).norm(), rounding);
    }
    (semidefinite ? definite : indefinite) += 1;
  }
  EXPECT_GT(definite, linear() ? 999 : 20);
  if (!linear()) {
    EXPECT_GT(indefinite, 100);
  }
}

// No state of an element may bring infinities or NaN into a sum.
TEST_P(EveryLaw, StaysFiniteInCollapsedElements) {
  if (!takes_inverted()) return;
  RandomGradients any(17);
  const Vec3 a = any.vector(), b = any.vector();
  for (const Mat3& f : {Mat3(Mat3::Zero()), Mat3(a * b.transpose()), Mat3(-kOne),
                        any.turned({1, 0.3, -0.3}), any.turned({1, 1e-200, 0})}) {
    EXPECT_TRUE(std::isfinite(law().energy(kTissue, f))) << f;
    EXPECT_TRUE(law().stress(kTissue, f).allFinite()) << f;
    EXPECT_TRUE(law().tangent(kTissue, f).matrix().allFinite()) << f;
  }
}

// Hand values at the stretch diag(2, 1, 1): corotated P = (2 mu + lambda, lambda, lambda); neo-
// Hookean mu (2 - 1/2) + lambda ln 2/2 and lambda ln 2; Saint Venant-Kirchhoff E_xx = 3/2 and so
// 2 (3 mu + 3/2 lambda), 3/2 lambda.
TEST(Laws, AtADoubledLengthByHand) {
  const Mat3 f = Vec3(2, 1, 1).asDiagonal();
  const double mu = kTissue.mu, lambda = kTissue.lambda, ln2 = std::log(2.0);
  const auto expect = [&](const char* name, double w, double along, double across) {
    const Law& law = *find_law(name);
    const Mat3 p = law.stress(kTissue, f);
    EXPECT_NEAR(law.energy(kTissue, f), w, 1e-13) << name;
    EXPECT_LE((p - Mat3(Vec3(along, across, across).asDiagonal())).norm(), 1e-13) << name;
    // Areas across double with the length, J = 2: along P, across half of it.
    Voigt cauchy, biot;
    cauchy << along, across / 2, across / 2, 0, 0, 0;
    biot << along, across, across, 0, 0, 0;
    EXPECT_LE((cauchy_stress(p, f) - cauchy).norm(), 1e-13) << name;
    EXPECT_LE((biot_stress(p, f) - biot).norm(), 1e-13) << name;
  };
  expect("corotated", mu + lambda / 2, 2 * mu + lambda, lambda);
  expect("neo-hookean", 1.5 * mu - mu * ln2 + lambda / 2 * ln2 * ln2, 1.5 * mu + lambda * ln2 / 2,
         lambda * ln2);
  expect("saint-venant-kirchhoff", 2.25 * mu + 1.125 * lambda, 6 * mu + 3 * lambda, 1.5 * lambda);
}

}  // namespace
}  // namespace sunder::test
