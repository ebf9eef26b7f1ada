// SPDX-License-Identifier: Apache-2.0
// Statics at finite deformation: against the yardstick's Newton, the elastica, and loads that no
// equilibrium bears.
#include "solver/finite_statics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cpu_reference/plain/finite.hpp"
#include "material/corotated.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "material/saint_venant_kirchhoff.hpp"
#include "support/loads.hpp"
#include "support/structured_board.hpp"

namespace sunder::solver {
namespace {

double largest(std::span<const double> u) {
  double most = 0;
  for (std::size_t i = 0; i < u.size(); i += 3) most = std::max(most, Vec3(&u[i]).norm());
  return most;
}
double apart(std::span<const double> a, std::span<const double> b) {
  std::vector<double> d(a.begin(), a.end());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] -= b[i];
  return largest(d);
}

/// A bar along x of edge lengths 10 x 1 x 1, clamped at x = 0.
Scene bar(Index along, Index high, Index deep, double poisson) {
  Scene scene;
  scene.mesh = test::structured_board({along, high, deep, 10, 1, 1});
  scene.materials["board"] = {5, poisson, 2.0};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
  return scene;
}
const Box kEnd{Vec3(9.999, -1, -1), Vec3(11, 9, 9)};

struct Pair {
  const Law& law;
  const plain::Law& yardstick;
};
const Pair kPairs[] = {{kCorotated, plain::kCorotated},
                       {kNeoHookean, plain::kNeoHookean},
                       {kSaintVenantKirchhoff, plain::kSaintVenantKirchhoff}};

TEST(FiniteStatics, BendsABarAsTheYardstickDoes) {
  const Problem problem(bar(10, 1, 1, 0.4));
  const auto end = test::nodes_in(problem.mesh(), kEnd);
  for (const Pair& pair : kPairs) {
    const auto laws = fem::one_law(problem, pair.law);
    const fem::HyperelasticBody body{problem, laws};
    FiniteStatics statics(body, {.tolerance = 1e-8});
    for (double force : {0.02, 0.04, 0.08, -0.05}) {
      const Load load = test::pull(problem, end, Vec3(0.1 * force, force, 0.3 * force));
      const FiniteStaticsReport report = statics.solve(load);
      ASSERT_TRUE(report.at_rest) << pair.law.name << " " << force;
      EXPECT_LE(report.error, 1e-8);
      const plain::Solution s = plain::FiniteBody(problem, pair.yardstick).solve(load);
      EXPECT_LE(apart(statics.displacement(), s.displacement), 1e-6 * largest(s.displacement))
          << pair.law.name << " " << force;
    }
    EXPECT_GT(largest(statics.displacement()), 2);
  }
}

// The same by a grip, turned upwards by half the bar's length in one step and back.
TEST(FiniteStatics, FollowsAGripAndReturns) {
  for (const Pair& pair : kPairs) {
    Scene scene = bar(10, 1, 1, 0.4);
    Instrument grip;
    grip.action = Grip{kEnd, Vec3(-1, 5, 0), Axes{7}};
    scene.instruments.push_back(grip);
    const Problem problem(std::move(scene));
    const auto laws = fem::one_law(problem, pair.law);
    const fem::HyperelasticBody body{problem, laws};
    FiniteStatics statics(body, {.tolerance = 1e-10});
    std::vector<double> moved, back(problem.gripped_dofs().size(), 0.0);
    for (Index d : problem.gripped_dofs()) {
      const auto i = std::ranges::find(problem.dofs(), d) - problem.dofs().begin();
      moved.push_back(i % 3 == 0 ? -1 : i % 3 == 1 ? 5 : 0);
    }
    ASSERT_TRUE(statics.solve({{}, {}, moved}).at_rest) << pair.law.name;
    const plain::Solution s =
        plain::FiniteBody(problem, pair.yardstick).solve({{}, {}, moved}, statics.displacement());
    EXPECT_LE(apart(statics.displacement(), s.displacement), 1e-6 * largest(s.displacement))
        << pair.law.name;
    ASSERT_TRUE(statics.solve({{}, {}, back}).at_rest) << pair.law.name;
    EXPECT_LE(largest(statics.displacement()), 1e-6) << pair.law.name;
  }
}

// A prototype in another language gave 28.9 mm by linear theory and 19.05 mm corotated at 84 N,
// within 5 % of one another at 7 N. docs/limits.md quotes what is printed.
TEST(FiniteStatics, LinearAndCorotatedTheoryPartOnThePapersBoard) {
  const Problem problem(test::held_board());
  std::vector<double> moved[2];
  for (int k = 0; k < 2; ++k) {
    const Law& law = k == 0 ? kLinear : kCorotated;
    const auto laws = fem::one_law(problem, law);
    const fem::HyperelasticBody body{problem, laws};
    FiniteStatics statics(body, {.tolerance = 1e-7});
    for (double force : {7.0, 36.0, 84.0}) {
      const Load load = test::corner_pull(problem, Vec3(0, -force, 0));
      const FiniteStaticsReport report = statics.solve(load);
      ASSERT_TRUE(report.at_rest) << law.name << " " << force;
      moved[k].push_back(largest(statics.displacement()));
      std::printf("%-9s %2.0f N: %.4f mm; %d back-solves, %d factors\n", law.name.data(), force,
                  moved[k].back(), report.back_solves, report.factors);
      if (&law == &kLinear) continue;
      const plain::Solution s =
          plain::FiniteBody(problem, plain::kCorotated).solve(load, statics.displacement());
      EXPECT_LE(apart(statics.displacement(), s.displacement), 1e-5 * largest(s.displacement));
    }
  }
  EXPECT_GT(moved[0][0] / moved[1][0], 1.03);
  EXPECT_LT(moved[0][0] / moved[1][0], 1.05);
  EXPECT_NEAR(moved[0][2], 28.9, 0.05);
  EXPECT_NEAR(moved[1][2], 19.05, 0.005);
}

// P L^2/(E I) = 1 and 2 bend the elastica by .30172 and .49346 of its length and draw its end in by
// .05643 and .16064 (elliptic integrals). Linear tetrahedra are too stiff by 45, 17.6 and 8.7 % in
// bending at small loads (docs/verification.md, Cantilever); the error falls with h^2, so that the
// last two meshes extrapolate to the limit. The bar's shear adds .6 % to the elastica's deflection.
TEST(FiniteStatics, BendsABarAsTheElasticaWhenElementsShrink) {
  const double expected[2][2] = {{0.30172, 0.05643}, {0.49346, 0.16064}};
  double deflection[2][3], draw_in[2][3];
  for (int mesh = 0; mesh < 3; ++mesh) {
    const Index cells = 2 * (mesh + 1);
    const Problem problem(bar(10 * cells, cells, cells, 0));
    const auto end = test::nodes_in(problem.mesh(), kEnd);
    const auto laws = fem::one_law(problem, kCorotated);
    const fem::HyperelasticBody body{problem, laws};
    FiniteStatics statics(body, {.tolerance = 1e-6});
    for (int k = 0; k < 2; ++k) {
      const double force = (k + 1) * 5.0 / 12 / 100;
      ASSERT_TRUE(statics.solve(test::pull(problem, end, Vec3(0, force, 0))).at_rest);
      Vec3 mean = Vec3::Zero();
      for (Index n : end) {
        mean += Vec3(&statics.displacement()[3 * n]) / static_cast<double>(end.size());
      }
      deflection[k][mesh] = mean.y() / 10;
      draw_in[k][mesh] = -mean.x() / 10;
      std::printf("%d cells, P L^2/(E I) = %d: %.5f, %.5f\n", cells, k + 1, deflection[k][mesh],
                  draw_in[k][mesh]);
    }
  }
  const auto limit = [](const double(&of)[3]) { return (36 * of[2] - 16 * of[1]) / 20; };
  for (int k = 0; k < 2; ++k) {
    EXPECT_LT(deflection[k][0], deflection[k][1]);
    EXPECT_LT(deflection[k][1], deflection[k][2]);
    EXPECT_LT(deflection[k][2], expected[k][0]);
    EXPECT_NEAR(limit(deflection[k]) / expected[k][0], 1, 0.025);
    EXPECT_NEAR(limit(draw_in[k]) / expected[k][1], 1, 0.05);
  }
}

// The end is cut off: it has no equilibrium and stays where it was, and the rest goes on.
TEST(FiniteStatics, FreezesWhatNothingHolds) {
  const Problem problem(bar(6, 1, 1, 0.3));
  const auto end = test::nodes_in(problem.mesh(), kEnd);
  const auto laws = fem::one_law(problem, kCorotated);
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  const fem::HyperelasticBody body{problem, laws, destroyed};
  FiniteStatics statics(body);
  ASSERT_TRUE(statics.solve(test::pull(problem, end, Vec3(0.1, 0, 0))).at_rest);
  const std::vector<double> before = statics.displacement();
  std::vector<Index> gone;
  for (Index e = 12; e < 18; ++e) gone.push_back(e);
  for (Index e : gone) destroyed[e] = 1;
  statics.destroyed(gone);
  const FiniteStaticsReport report = statics.solve(test::pull(problem, end, Vec3(0.2, 0, 0)));
  EXPECT_TRUE(report.at_rest);
  EXPECT_EQ(report.frozen.pieces, 1u);
  EXPECT_EQ(report.frozen.elements, 18u);
  for (Index n = 0; n < problem.node_count(); ++n) {
    const double x = problem.mesh().nodes[n].x();
    for (Index i = 3 * n; i < 3 * n + 3; ++i) {
      if (x > 4.9) {
        EXPECT_EQ(statics.displacement()[i], before[i]);
        EXPECT_EQ(statics.internal_forces()[i], 0);
      } else {
        EXPECT_NEAR(statics.displacement()[i], 0, 1e-6);
      }
    }
  }
  std::ranges::fill(destroyed, std::uint8_t{0});
  statics.body_changed();
  EXPECT_TRUE(statics.solve(test::pull(problem, end, Vec3(0.1, 0, 0))).at_rest);
}

}  // namespace
}  // namespace sunder::solver
