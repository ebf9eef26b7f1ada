// SPDX-License-Identifier: Apache-2.0
// The base of finite statics against a base that was made where it has followed to.
#include "solver/finite_base.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "material/corotated.hpp"
#include "material/neo_hookean.hpp"
#include "support/sequences.hpp"
#include "support/structured_board.hpp"

namespace sunder::solver {
namespace {

/// A board clamped at y = 10, bent and stretched.
struct Bent {
  Bent() {
    Scene scene;
    scene.mesh = test::structured_board({8, 8, 2, 10, 10, 2});
    scene.materials["board"] = {5, 0.4, 2.0};
    scene.supports.push_back({Box{Vec3(-1, 9.99, -1), Vec3(11, 11, 3)}, Axes{7}});
    Instrument grip;
    grip.action = Grip{Box{Vec3(-1, -1, -1), Vec3(0.01, 0.01, 3)}, Vec3(0, 0, 0), Axes{7}};
    scene.instruments.push_back(grip);
    problem = std::make_unique<Problem>(std::move(scene));
    pattern = std::make_unique<fem::TangentPattern>(*problem);
    for (const Vec3& x : problem->mesh().nodes) {
      const double s = (10 - x.y()) / 10;
      for (double c : {0.4 * s * s, -0.8 * s, 2.0 * s * s * (1 + 0.02 * x.x())}) u.push_back(c);
    }
    for (Index d = 0; d < problem->dof_count(); ++d) force.push_back(std::sin(1.7 * d));
  }
  /// 0 where nothing can answer.
  Eigen::VectorXd load(const RestingBody& body) const {
    Eigen::VectorXd b =
        Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size()));
    for (Index d : problem->gripped_dofs()) b[d] = 0;
    for (Index d = 0; d < b.size(); ++d) {
      if (body.frozen()[d]) b[d] = 0;
    }
    return b;
  }

  std::unique_ptr<Problem> problem;
  std::unique_ptr<fem::TangentPattern> pattern;
  std::vector<double> u, force;
};

// One by one, then a cut that leaves nodes without elements and a piece without support.
TEST(FiniteBase, FollowsWhatLeaves) {
  const Bent bent;
  for (const Law* law : {&kCorotated, &kNeoHookean}) {
    const auto laws = fem::one_law(*bent.problem, *law);
    std::vector<std::uint8_t> destroyed(bent.problem->mesh().tets.size(), 0);
    const fem::HyperelasticBody body{*bent.problem, laws, destroyed};
    RestingBody resting(body);
    FiniteBase base(body, bent.u, fem::Tangent::projected, *bent.pattern);
    std::vector<Index> cut = test::elements_across(bent.problem->mesh(), 4.0);
    for (std::size_t i = 0; i < cut.size() - 12; ++i) {
      destroyed[cut[i]] = 1;
      if (i % 7 != 0) continue;
      resting.look();
      ASSERT_TRUE(base.follow(resting, 1000)) << i;
      FiniteBase fresh(resting.body(), bent.u, fem::Tangent::projected, *bent.pattern);
      Eigen::VectorXd x, expected;
      base.solve(bent.load(resting), x);
      fresh.solve(bent.load(resting), expected);
      EXPECT_LE((x - expected).norm(), 1e-9 * expected.norm()) << law->name << " " << i;
    }
    EXPECT_GT(base.rank(), 100);
    EXPECT_FALSE(base.follow(resting, 10) && base.rank() <= 10);
    destroyed[cut[0]] = 0;  // an element is back
    resting.look();
    EXPECT_FALSE(base.follow(resting, 1000));
  }
}

// What a host grasps and lets go, without a new factor; elements leave in between.
TEST(FiniteBase, HoldsWhatIsGraspedSince) {
  const Bent bent;
  const auto laws = fem::one_law(*bent.problem, kNeoHookean);
  std::vector<std::uint8_t> destroyed(bent.problem->mesh().tets.size(), 0);
  FiniteBase base({*bent.problem, laws, destroyed}, bent.u, fem::Tangent::projected, *bent.pattern);
  std::vector<std::unique_ptr<Problem>> seen;  // what the base refers to
  const auto expect_as_fresh = [&](std::vector<Index> gripped) {
    seen.push_back(std::make_unique<Problem>(*bent.problem, gripped));
    const fem::HyperelasticBody body{*seen.back(), laws, destroyed};
    const RestingBody resting(body);
    ASSERT_TRUE(base.grip(*seen.back()));
    ASSERT_TRUE(base.follow(resting, 1000));
    FiniteBase fresh(resting.body(), bent.u, fem::Tangent::projected,
                     fem::TangentPattern(*seen.back()));
    Eigen::VectorXd b = bent.load(resting), x, expected;
    for (Index d : gripped) b[d] = 0;
    base.solve(b, x);
    fresh.solve(b, expected);
    EXPECT_LE((x - expected).norm(), 1e-9 * expected.norm());
    for (Index d : gripped) EXPECT_LE(std::abs(x[d]), 1e-9 * expected.norm());
  };
  const auto own = bent.problem->gripped_dofs();
  std::vector<Index> one(own.begin(), own.end()), two = one;
  const auto add = [&](std::vector<Index>& to, Index node) {
    for (int axis = 0; axis < 3; ++axis) to.push_back(bent.problem->dof(node, axis));
  };
  for (const Index n : {8, 17, 89}) add(one, n);
  for (const Index n : {17, 40}) add(two, n);
  expect_as_fresh(one);
  for (const Index e : {60, 61, 100}) destroyed[static_cast<std::size_t>(e)] = 1;
  expect_as_fresh(one);
  expect_as_fresh(two);
  expect_as_fresh({own.begin(), own.end()});
  destroyed[200] = 1;
  expect_as_fresh(two);
  // What the base holds by itself it cannot let go.
  const Problem none(*bent.problem, std::vector<Index>{});
  EXPECT_FALSE(base.grip(none));
}

// Everything free of supports and grips turned: the base turned with it is that of the new state.
TEST(FiniteBase, TurnsWithTheBody) {
  Scene scene;
  scene.mesh = test::structured_board({6, 3, 2, 6, 3, 2});
  scene.materials["board"] = {5, 0.4, 2.0};
  Instrument grip;
  grip.action = Grip{Box{Vec3(-1, -1, -1), Vec3(0.01, 9, 9)}, Vec3(0, 0, 0), Axes{7}};
  scene.instruments.push_back(grip);
  const Problem problem(std::move(scene));
  const auto laws = fem::one_law(problem, kNeoHookean);
  const fem::HyperelasticBody body{problem, laws};
  const RestingBody resting(body);
  const Mat3 turn = Eigen::AngleAxisd(2.5, Vec3(1, 2, -2) / 3).toRotationMatrix();
  std::vector<double> from, to;
  for (const Vec3& x : problem.mesh().nodes) {
    const Vec3 there = x + Vec3(0.02 * x.x() * x.x(), 0.1 * x.x(), 0.03 * x.y() * x.x());
    const Vec3 turned = turn * there;
    for (int axis = 0; axis < 3; ++axis) {
      from.push_back(there[axis] - x[axis]);
      to.push_back(turned[axis] - x[axis]);
    }
  }
  const fem::TangentPattern pattern(problem);
  FiniteBase base(body, from, fem::Tangent::projected, pattern);
  FiniteBase expected(body, to, fem::Tangent::projected, pattern);
  Eigen::VectorXd b(problem.dof_count()), x, y;
  for (Index d = 0; d < b.size(); ++d) b[d] = std::cos(2.3 * d);
  for (Index d : problem.gripped_dofs()) b[d] = 0;
  base.turn(resting, to);
  EXPECT_NEAR(base.largest_turn(), 2.5, 1e-9);
  base.solve(b, x);
  expected.solve(b, y);
  EXPECT_LE((x - y).norm(), 1e-10 * y.norm());
}

}  // namespace
}  // namespace sunder::solver
