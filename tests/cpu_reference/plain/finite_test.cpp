// SPDX-License-Identifier: Apache-2.0
// The yardstick's further laws by hand values, without anything that they are to judge.
#include "cpu_reference/plain/finite.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "plane.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

constexpr double kYoung = 5, kPoisson = 0.25, kLambda = 2, kMu = 2;

/// A bar of 4 x 2 x 1 mm that slides on the planes x = 0, y = 0 and z = 0 and is pulled at x = 4.
Scene pulled_bar(double stretch) {
  Scene scene;
  scene.mesh = structured_board({4, 2, 1, 4, 2, 1});
  scene.materials["board"] = {kYoung, kPoisson, 2.0};
  for (int axis = 0; axis < 3; ++axis) {
    scene.supports.push_back({plane(axis, 0), Axes{static_cast<std::uint8_t>(1 << axis)}});
  }
  Instrument grip;
  grip.action = Grip{plane(0, 4), Vec3(4 * (stretch - 1), 0, 0), Axes{1}};
  scene.instruments.push_back(grip);
  return scene;
}

/// Stretch across a bar that is stretched along, and its nominal stress.
struct Uniaxial {
  double across, nominal;
};
// E (s - 1) as for the linear law: S - I takes the strain's place.
Uniaxial corotated(double s) { return {1 - kPoisson * (s - 1), kYoung * (s - 1)}; }
// S_xx = E E_xx and E_yy = -nu E_xx with E_xx = (s^2 - 1)/2; P = s S.
Uniaxial saint_venant_kirchhoff(double s) {
  const double strain = (s * s - 1) / 2;
  return {std::sqrt(1 - 2 * kPoisson * strain), s * kYoung * strain};
}
// mu (a^2 - 1) + lambda ln(s a^2) = 0 across, by bisection; along P = (mu (s^2 - 1) + lambda ln
// J)/s.
Uniaxial neo_hookean(double s) {
  double low = 0.1, high = 2;
  for (int i = 0; i < 200; ++i) {
    const double a = (low + high) / 2;
    (kMu * (a * a - 1) + kLambda * std::log(s * a * a) < 0 ? low : high) = a;
  }
  return {low, (kMu * (s * s - 1) + kLambda * std::log(s * low * low)) / s};
}

TEST(PlainFinite, StretchesABarAsByHand) {
  struct Row {
    const plain::Law& law;
    Uniaxial (*of)(double);
  };
  for (const Row& row : {Row{plain::kCorotated, corotated}, Row{plain::kNeoHookean, neo_hookean},
                         Row{plain::kSaintVenantKirchhoff, saint_venant_kirchhoff}}) {
    for (double stretch : {0.8, 1.001, 1.5}) {
      const Problem problem(pulled_bar(stretch));
      const std::vector<double> moved(problem.gripped_dofs().size(), 4 * (stretch - 1));
      const plain::Solution s = plain::FiniteBody(problem, row.law).solve({{}, {}, moved});
      EXPECT_LE(s.residual, 1e-10);
      const auto [across, nominal] = row.of(stretch);
      for (Index n = 0; n < problem.node_count(); ++n) {
        const Vec3& x = problem.mesh().nodes[n];
        const Vec3 expected(stretch * x.x(), across * x.y(), across * x.z());
        EXPECT_LE((x + Vec3(&s.displacement[3 * n]) - expected).norm(), 1e-9);
      }
      double sum = 0;
      for (double r : s.reactions) sum += r;
      EXPECT_NEAR(sum, 2 * nominal, 1e-9);  // 2 mm^2 of the undeformed body
    }
  }
}

TEST(PlainFinite, ChangesOfStressAreDerivatives) {
  using plain::Real, plain::Real3x3;
  Scene scene = pulled_bar(1);
  const plain::Element element(scene.mesh, 0, scene.materials["board"]);
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> any(-0.3, 0.3);
  const Real h = 1e-5L;  // error h^2 and 1e-19/h
  for (const plain::Law* law :
       {&plain::kCorotated, &plain::kNeoHookean, &plain::kSaintVenantKirchhoff}) {
    for (int i = 0; i < 100; ++i) {
      const auto random = [&] {
        return Real3x3::NullaryExpr([&] { return Real(any(generator)); });
      };
      const Real3x3 f = Real3x3::Identity() + random(), df = random();
      ASSERT_GT(f.determinant(), 0);
      const Real w =
          (law->energy(element.d, f + h * df) - law->energy(element.d, f - h * df)) / (2 * h);
      const Real3x3 p = law->stress(element.d, f);
      EXPECT_NEAR(static_cast<double>(p.cwiseProduct(df).sum() - w), 0, 1e-7);
      const Real3x3 dp =
          (law->stress(element.d, f + h * df) - law->stress(element.d, f - h * df)) / (2 * h);
      EXPECT_LE((law->change(element.d, f, df) - dp).norm(), 1e-7L);
    }
  }
}

// The far half of the bar is gone: what is left bears nothing and stays, and so do its nodes.
TEST(PlainFinite, DestroyedElementsAddNothing) {
  const Problem problem(pulled_bar(1.5));
  std::vector<std::uint8_t> destroyed;
  for (const auto& tet : problem.mesh().tets) {
    double x = 0;
    for (Index n : tet) x += problem.mesh().nodes[n].x() / 4;
    destroyed.push_back(x > 2);
  }
  const std::vector<double> moved(problem.gripped_dofs().size(), 2.0);
  const plain::Solution s =
      plain::FiniteBody(problem, plain::kNeoHookean, destroyed).solve({{}, {}, moved});
  for (double r : s.reactions) EXPECT_EQ(r, 0);
  for (std::size_t i = 0; i < s.displacement.size(); ++i) {
    const Vec3& x = problem.mesh().nodes[i / 3];
    EXPECT_EQ(s.displacement[i], i % 3 == 0 && x.x() > 3.5 ? 2 : 0);
  }
}

}  // namespace
}  // namespace sunder::test
