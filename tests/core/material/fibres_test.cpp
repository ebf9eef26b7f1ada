// SPDX-License-Identifier: Apache-2.0
// Fibres in every law: derivatives by differences, tension alone, their tangent, and the five
// constants of transversely isotropic elasticity by the tests that define them.
#include "material/fibres.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <string>

#include "core/material/random_gradients.hpp"
#include "material/law.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"

namespace sunder::test {
namespace {

const SmallStrain kMatrix = small_strain({0.05, 0.4, 2.0});

/// Of an artery's order (Holzapfel, Gasser, Ogden 2000, media): k1 .0024 MPa, k2 .84.
ElementFibres two_families(double dispersion) {
  ElementFibres of;
  of.count = 2;
  of.family[0] = {Vec3(1, 2, -1).normalized(), 0.0024, 0.84, dispersion};
  of.family[1] = {Vec3(2, -1, 0.5).normalized(), 0.01, 3, dispersion};
  return of;
}

/// As in law_test.cpp: the error of a step h is h^4 times the fifth derivative.
constexpr double kFibreStep = 1e-3;
template <class Function>
auto slope(const Function& at) {
  using Value = decltype(at(0.0));
  return Value(
      (8 * (at(kFibreStep) - at(-kFibreStep)) - (at(2 * kFibreStep) - at(-2 * kFibreStep))) /
      (12 * kFibreStep));
}

Mat3 entry(int k) {
  Mat3 m = Mat3::Zero();
  m.data()[k] = 1;
  return m;
}

double structure_strain(const FibreFamily& of, const Mat3& f) {
  return of.dispersion * ((f.transpose() * f).trace() - 3) +
         (1 - 3 * of.dispersion) * ((f * of.direction).squaredNorm() - 1);
}

void expect_slopes(const Law& law, const SmallStrain& of, const Mat3& f) {
  const Mat3 p = law.stress(of, f);
  const Matrix9 tangent = law.tangent(of, f).matrix();
  for (int k = 0; k < 9; ++k) {
    const double w = slope([&](double h) { return law.energy(of, f + h * entry(k)); });
    EXPECT_NEAR(p.data()[k], w, 1e-7 * (p.norm() + of.mu)) << law.name << "\n" << f;
    const Mat3 dp = slope([&](double h) { return Mat3(law.stress(of, f + h * entry(k))); });
    EXPECT_LE((Eigen::Map<const Vector9>(dp.data()) - tangent.col(k)).cwiseAbs().maxCoeff(),
              1e-7 * tangent.cwiseAbs().maxCoeff())
        << law.name << "\n"
        << f;
  }
}

// P is the slope of W and the tangent that of P, families stretched, slack and one of each.
TEST(Fibres, StressAndTangentAreDerivatives) {
  for (const Law* law : laws()) {
    if (law == &kLinear) continue;
    for (const double dispersion : {0.0, 0.1, 1.0 / 3}) {
      const ElementFibres fibres = two_families(dispersion);
      SmallStrain of = kMatrix;
      of.fibres = &fibres;
      RandomGradients random(7);
      int tried = 0, slack = 0, tight = 0;
      while (tried < 30) {
        const Vec3 stretches(random.number(0.7, 1.4), random.number(0.7, 1.4),
                             random.number(0.7, 1.4));
        const Mat3 f = random.turned(stretches);
        const double e0 = structure_strain(fibres.family[0], f),
                     e1 = structure_strain(fibres.family[1], f);
        if (std::min(std::abs(e0), std::abs(e1)) < 0.05) continue;  // the switch, below
        ++tried;
        (e0 < 0 ? slack : tight) += 1;
        (e1 < 0 ? slack : tight) += 1;
        expect_slopes(*law, of, f);
      }
      EXPECT_GE(slack, 5);
      EXPECT_GE(tight, 5);
    }
  }
}

// Along a path from compression into tension energy and stress begin at 0 and have no jump: near
// rest W is k1/2 E^2 and P 2 k1 E along the fibre, E = l^2 - 1.
TEST(Fibres, BearTensionOnlyWithoutAJump) {
  ElementFibres fibres = two_families(0);
  fibres.count = 1;
  fibres.family[0].direction = Vec3(1, 0, 0);
  const double k1 = fibres.family[0].k1;
  const auto stretched = [](double l) { return Mat3(Vec3(l, 1, 1).asDiagonal()); };
  for (const double l : {0.3, 0.9, 0.999999, 1.0}) {
    EXPECT_EQ(fibre_energy<FibreTheory::finite>(fibres, stretched(l)), 0) << l;
    EXPECT_TRUE(fibre_stress<FibreTheory::finite>(fibres, stretched(l)).isZero(0)) << l;
    EXPECT_TRUE(fibre_tangent<FibreTheory::finite>(fibres, stretched(l)).isZero(0)) << l;
  }
  for (const double above : {1e-12, 1e-9, 1e-6, 1e-4}) {
    const double e = 2 * above + above * above;
    const Mat3 p = fibre_stress<FibreTheory::finite>(fibres, stretched(1 + above));
    EXPECT_NEAR(p(0, 0), 2 * k1 * e, 1e-3 * k1 * e);
    EXPECT_LT((p - p(0, 0) * entry(0)).norm(), 1e-15 * k1);
    EXPECT_NEAR(fibre_energy<FibreTheory::finite>(fibres, stretched(1 + above)), k1 / 2 * e * e,
                1e-3 * k1 * e * e);
  }
}

// A law's split has them whole in its part of shape: volume that patches share is the matrix's.
TEST(Fibres, AreOfShapeWhereVolumeIsShared) {
  RandomGradients random(17);
  const VolumeSplit& split = *kNeoHookean.split;
  const ElementFibres fibres = two_families(0.1);
  SmallStrain of = kMatrix;
  of.fibres = &fibres;
  for (int i = 0; i < 20; ++i) {
    const Mat3 f = random.turned({1.3, random.number(0.8, 1.2), 1.1});
    EXPECT_NEAR(split.shape_energy(of, f) - split.shape_energy(kMatrix, f),
                fibre_energy<FibreTheory::finite>(fibres, f), 1e-15);
    EXPECT_LT((split.shape_stress(of, f) - split.shape_stress(kMatrix, f) -
               fibre_stress<FibreTheory::finite>(fibres, f))
                  .norm(),
              1e-15);
    EXPECT_LT(
        (split.shape_tangent(of, f, 0.3).matrix() - split.shape_tangent(kMatrix, f, 0.3).matrix() -
         fibre_tangent<FibreTheory::finite>(fibres, f))
            .norm(),
        1e-13);
    EXPECT_EQ(split.volume(of, 1.01).energy, split.volume(kMatrix, 1.01).energy);
  }
}

// At rest the tangent of every law is that without fibres: a prepared base stays isotropic.
TEST(Fibres, AddNothingAtRest) {
  const ElementFibres fibres = two_families(0.2);
  SmallStrain of = kMatrix;
  of.fibres = &fibres;
  const Mat3 one = Mat3::Identity();
  for (const Law* law : laws()) {
    if (law == &kLinear) continue;
    EXPECT_EQ(law->energy(of, one), law->energy(kMatrix, one));
    EXPECT_EQ(law->stress(of, one), law->stress(kMatrix, one));
    EXPECT_EQ(law->tangent(of, one).matrix(), law->tangent(kMatrix, one).matrix());
  }
}

// A turn before changes W not at all and turns P; one after W alone where it turns fibres too.
TEST(Fibres, TurnWithTheMaterial) {
  RandomGradients random(3);
  const ElementFibres fibres = two_families(0.1);
  for (int i = 0; i < 20; ++i) {
    const Mat3 f = random.turned({1.3, 0.9, 1.1}), r = random.rotation();
    const double w = fibre_energy<FibreTheory::finite>(fibres, f);
    EXPECT_NEAR(fibre_energy<FibreTheory::finite>(fibres, r * f), w, 1e-14);
    const Mat3 p = fibre_stress<FibreTheory::finite>(fibres, f);
    EXPECT_LT((fibre_stress<FibreTheory::finite>(fibres, r * f) - r * p).norm(), 1e-14);
    ElementFibres turned = fibres;
    for (FibreFamily& family : turned.family) family.direction = r.transpose() * family.direction;
    EXPECT_NEAR(fibre_energy<FibreTheory::finite>(turned, f * r), w, 1e-14);
  }
}

// Positive semidefinite by itself, whatever F: compressed, inverted, far stretched.
TEST(Fibres, TheirTangentIsPositiveSemidefinite) {
  RandomGradients random(11);
  int tight = 0;
  for (int i = 0; i < 300; ++i) {
    const ElementFibres fibres = two_families(i % 4 / 9.0);
    const Mat3 f =
        random.turned({random.number(-0.5, 1.6), random.number(0.2, 1.6), random.number(0.2, 1.6)});
    if (!std::isfinite(fibre_energy<FibreTheory::finite>(fibres, f))) continue;
    const Matrix9 tangent = fibre_tangent<FibreTheory::finite>(fibres, f);
    EXPECT_TRUE(tangent.isApprox(tangent.transpose()));
    const Eigen::SelfAdjointEigenSolver<Matrix9> modes(tangent);
    EXPECT_GE(modes.eigenvalues().minCoeff(), -1e-12 * (1e-6 + tangent.norm()));
    tight += tangent.isZero(0) ? 0 : 1;
  }
  EXPECT_GE(tight, 100);
}

// exp(k2 E^2) past every strength is no state; k2 = 0 is the quadratic law.
TEST(Fibres, HaveAnEndAndALimit) {
  ElementFibres fibres;
  fibres.count = 1;
  fibres.family[0] = {Vec3(0, 0, 1), 2, 100, 0};
  Mat3 f = Mat3::Identity();
  f(2, 2) = std::sqrt(1 + 0.99);  // E = .99: exponent 98
  EXPECT_TRUE(std::isfinite(fibre_energy<FibreTheory::finite>(fibres, f)));
  EXPECT_TRUE(fibre_tangent<FibreTheory::finite>(fibres, f).allFinite());
  f(2, 2) = std::sqrt(1 + 1.01);
  EXPECT_TRUE(std::isinf(fibre_energy<FibreTheory::finite>(fibres, f)));
  fibres.family[0].k2 = 0;
  EXPECT_NEAR(fibre_energy<FibreTheory::finite>(fibres, f), 1.01 * 1.01, 1e-14);
  EXPECT_NEAR(fibre_stress<FibreTheory::finite>(fibres, f)(2, 2), 2 * 2 * 1.01 * f(2, 2), 1e-13);
}

}  // namespace
}  // namespace sunder::test
