// SPDX-License-Identifier: Apache-2.0
// Pooled volume in statics at finite deformation: the base that follows what leaves, and rests
// against Newton's method with a new factor each iteration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "body/hyperelastic_pass.hpp"
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
    for (int i = 1; i <= 4; ++i) {
      const FiniteStaticsReport report = torn.pull(i * 2.75);
      ASSERT_TRUE(report.at_rest);
      std::printf("nu %.3f, pulled by %5.2f N: %d back-solves, %d factors\n", nu, i * 2.75,
                  report.back_solves, report.factors);
      if (nu > 0.49) {
        EXPECT_LE(report.back_solves, 35);  // by energies alone 47 to 103
      }
    }
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

/// The board with a gap of elements through it, of which some patch keeps elements on both sides.
struct ParedBoard {
  ParedBoard()
      : problem(pooled_held_board(0.499)),
        laws(fem::laws_of(problem)),
        destroyed(problem.mesh().tets.size(), 0) {
    const test::CutAcross gap = test::cut_through_a_patch(problem);
    for (Index e : gap.elements) destroyed[static_cast<std::size_t>(e)] = 1;
    cut = gap.height;
  }
  [[nodiscard]] fem::HyperelasticBody body() const { return {problem, laws, destroyed}; }
  /// Of the nodes below the gap, or above it.
  [[nodiscard]] std::vector<double> moved(bool below, bool above) const {
    std::vector<double> u;
    for (const Vec3& x : problem.mesh().nodes) {
      const bool moves = x.y() < cut ? below : above;
      const Vec3 by(0.01 * x.x(), 0.02 * x.y() + 0.001 * x.x() * x.y(), 0.015 * x.z());
      for (int axis = 0; axis < 3; ++axis) u.push_back(moves ? by[axis] : 0);
    }
    return u;
  }
  Problem problem;
  std::vector<const Law*> laws;
  std::vector<std::uint8_t> destroyed;
  double cut = 0;
};

// In motion a piece moves on, and what it does is nothing to the rest.
TEST(PooledFinite, APieceThatFliesHasPatchesOfItsOwn) {
  const ParedBoard board;
  const RestingBody moving(board.body(), RestingBody::Loose::moving);
  ASSERT_TRUE(moving.body().split);
  ASSERT_GT(moving.body().pools()->count(), board.problem.pools()->count());
  fem::HyperelasticPass pass(board.body());
  pass.split_pools(moving.body().split);
  const auto below = board.moved(true, false), above = board.moved(false, true),
             both = board.moved(true, true);
  std::vector<double> f(both.size()), of_both(both.size());
  const double apart = fem::energy(moving.body(), below) + fem::energy(moving.body(), above);
  EXPECT_NEAR(fem::internal_forces(moving.body(), both, of_both), apart, 1e-12 * apart);
  EXPECT_NEAR(pass.internal_forces(both, f), apart, 1e-12 * apart);
  // Their patches as the whole body had them make another energy.
  EXPECT_GT(std::abs(fem::energy(board.body(), both) - apart), 1e-9 * apart);
  double most = 0;
  for (double x : of_both) most = std::max(most, std::abs(x));
  fem::internal_forces(moving.body(), below, f);
  for (std::size_t i = 0; i < f.size(); ++i) {
    const double y = board.problem.mesh().nodes[i / 3].y();
    if (y < board.cut) {
      EXPECT_NEAR(f[i], of_both[i], 1e-12 * most);
    }
  }
  // And the tangent is that energy's, in all entries of split patches.
  const fem::TangentPattern pattern(board.problem);
  const Eigen::MatrixXd k =
      Eigen::MatrixXd(pattern.tangent(moving.body(), both, fem::Tangent::exact))
          .selfadjointView<Eigen::Lower>();
  const auto& place = pattern.supernodes()->place;
  const fem::Pools& pools = *moving.body().pools();
  std::vector<double> plus(both.size());
  for (Index p = board.problem.pools()->count(); p < pools.count(); ++p) {
    for (Index n : pools.nodes(board.problem, p)) {
      const Index d = board.problem.dof(n, 1);
      if (d == kNone) continue;
      const Index c = place[static_cast<std::size_t>(d)];
      if (k.col(c).cwiseAbs().sum() <= 1) continue;  // nothing live there, or gripped
      constexpr double kStep = 1e-5;
      std::vector<double> there = both;
      const auto at = static_cast<std::size_t>(3 * n + 1);
      there[at] += kStep;
      fem::internal_forces(moving.body(), there, plus);
      there[at] -= 2 * kStep;
      fem::internal_forces(moving.body(), there, f);
      const double size = k.col(c).cwiseAbs().maxCoeff();
      for (std::size_t i = 0; i < f.size(); ++i) {
        const Index row = board.problem.dofs()[i];
        if (row == kNone || std::ranges::binary_search(board.problem.gripped_dofs(), row)) continue;
        EXPECT_NEAR((plus[i] - f[i]) / (2 * kStep), k(place[static_cast<std::size_t>(row)], c),
                    1e-6 * size);
      }
    }
  }
}

}  // namespace
}  // namespace sunder::solver
