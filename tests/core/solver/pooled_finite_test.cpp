// SPDX-License-Identifier: Apache-2.0
// Pooled volume in statics at finite deformation: the base that follows what leaves, and rests
// against Newton's method with a new factor each iteration.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "material/neo_hookean.hpp"
#include "support/accuracy.hpp"
#include "support/finite_newton.hpp"
#include "support/finite_torn.hpp"
#include "support/pooled_body.hpp"
#include "support/sequences.hpp"

namespace sunder::solver {
namespace {

Scene pooled_held_board(double nu) {
  Scene scene = test::held_board();
  test::set_poisson(scene, nu);
  for (auto& [name, material] : scene.materials) {
    material.volume = MaterialVolume::pooled;
    material.law = MaterialLaw::neo_hookean;
  }
  return scene;
}

// At an even deformation a patch without an element has the pressure that it had, so that the base
// is the one that is made of what is left.
TEST(PooledFinite, BaseFollowsWhatLeaves) {
  const Problem problem(pooled_held_board(0.49));
  const auto laws = fem::laws_of(problem);
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  const fem::HyperelasticBody body{problem, laws, destroyed};
  const fem::TangentPattern pattern(problem);
  RestingBody resting(body);
  std::vector<double> u;
  Mat3 f = Mat3::Identity();
  f.diagonal() << 1.05, 0.99, 0.97;
  f(0, 1) = 0.05;
  f(2, 0) = -0.03;
  for (const Vec3& x : problem.mesh().nodes) {
    const Vec3 moved = (f - Mat3::Identity()) * x;
    u.insert(u.end(), moved.data(), moved.data() + 3);
  }
  FiniteBase base(body, u, fem::Tangent::projected, pattern);
  Eigen::VectorXd b(problem.dof_count()), x, expected;
  const std::vector<Index> crack = test::crack_sequence(problem, 60, 15);
  for (std::size_t i = 0; i < crack.size(); ++i) {
    destroyed[static_cast<std::size_t>(crack[i])] = 1;
    if (i % 9 != 0) continue;
    resting.look();
    ASSERT_TRUE(base.follow(resting, 3000)) << i;
    FiniteBase fresh(resting.body(), u, fem::Tangent::projected, pattern);
    for (Index d = 0; d < b.size(); ++d) b[d] = resting.frozen()[d] ? 0 : std::sin(1.7 * d);
    base.solve(b, x);
    fresh.solve(b, expected);
    EXPECT_LE((x - expected).norm(), 1e-8 * expected.norm()) << i;
  }
  EXPECT_GT(base.rank(), 100);
}

struct Promise {
  double nu, tolerance, error;
};

// At nu .499 a pressure is the difference of volumes by ten digits of its own: kappa is 500 mu, in
// the frame that is a hundred times as stiff too.
TEST(PooledFinite, RestsAreNewtonsAlongACrack) {
  for (const Promise& promise : {Promise{0.4, 1e-10, test::kCrackTolerance},
                                 Promise{0.499, 1e-7, 100 * test::kCrackTolerance}}) {
    const double nu = promise.nu;
    test::FiniteTorn torn(kNeoHookean, {.tolerance = promise.tolerance, .most_factors = 40},
                          pooled_held_board(nu));
    const auto sequence = test::crack_sequence(torn.problem, 60, 15);
    for (int i = 1; i <= 4; ++i) ASSERT_TRUE(torn.pull(i * 2.75).at_rest);
    std::size_t gone = 0;
    for (std::size_t count : {0u, 1u, 3u, 10u, 30u}) {
      torn.tear(std::span(sequence).subspan(gone, count - gone));
      gone = count;
      const FiniteStaticsReport report = torn.pull(11);
      ASSERT_TRUE(report.at_rest) << nu << " " << count;
      const Load load = test::corner_pull(torn.problem, Vec3(0, -11, 0));
      const auto& u = torn.statics.displacement();
      const auto rest = test::newton(torn.body, load, u);
      const double apart = test::displacement_error(torn.problem.mesh(), torn.destroyed, u, rest.u);
      const double stress = test::stress_error(torn.destroyed, torn.stress(u), torn.stress(rest.u));
      std::printf("nu %.3f, %2zu gone: %d back-solves, %d factors, u %.1e, stress %.1e\n", nu,
                  count, report.back_solves, report.factors, apart, stress);
      EXPECT_LE(rest.residual, 1e-9);
      EXPECT_LE(apart, promise.error);
      EXPECT_LE(stress, promise.error);
    }
  }
}

// A piece that is cut off takes its elements out of the patches that it shared.
TEST(PooledFinite, APieceThatIsCutOffSharesNoPressure) {
  test::FiniteTorn torn(kNeoHookean, {}, pooled_held_board(0.499)),
      other(kNeoHookean, {}, pooled_held_board(0.499));
  ASSERT_TRUE(torn.pull(2).at_rest);
  ASSERT_TRUE(other.pull(2).at_rest);
  torn.tear(test::elements_across(torn.problem.mesh(), 26.5));
  std::vector<Index> all;
  for (Index e = 0; e < torn.problem.tet_count(); ++e) {
    if (torn.statics.out()[static_cast<std::size_t>(e)]) all.push_back(e);
  }
  ASSERT_GT(all.size(), test::elements_across(torn.problem.mesh(), 26.5).size());
  other.tear(all);
  ASSERT_TRUE(torn.pull(2).at_rest);
  ASSERT_TRUE(other.pull(2).at_rest);
  EXPECT_EQ(torn.statics.displacement(), other.statics.displacement());
}

}  // namespace
}  // namespace sunder::solver
