// SPDX-License-Identifier: Apache-2.0
// A base at finite deformation that follows what parts, leaves and turns, against a fresh factor of
// the tangent of the split body.
#include <gtest/gtest.h>

#include "body/parted_body.hpp"
#include "material/corotated.hpp"
#include "material/neo_hookean.hpp"
#include "solver/finite_base.hpp"
#include "split_against_fresh.hpp"

namespace sunder::test {
namespace {

struct Way {
  const Law& law;
  bool inverse, inertia;
};

class SplitBase : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, SplitBase, ::testing::Range(0, 8));

TEST_P(SplitBase, SolvesAsAFreshFactorOfTheSplitTangentDoes) {
  const bool pooled = GetParam() >= 4;
  const Way way{!pooled && GetParam() % 2 == 0 ? kCorotated : kNeoHookean, GetParam() % 4 >= 2,
                GetParam() % 3 == 0};
  std::mt19937 random(11);
  const Mesh mesh = shaken_board({10, 8, 2, 10, 8, 2}, random, 0.2);
  Scene scene = scene_of({Route::factor, true, 0.3, false}, mesh);
  scene.materials["board"].law = MaterialLaw::neo_hookean;
  if (pooled) scene.materials["board"].volume = MaterialVolume::pooled;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  fem::DamagedBody damaged(problem);
  const std::vector<const Law*> laws = fem::one_law(*problem, way.law);
  const auto masses = [](const Problem& of) {
    std::vector<double> mass(static_cast<std::size_t>(of.dof_count()), 0.0);
    for (Index e = 0; e < of.tet_count(); ++e) {
      for (Index n : of.mesh().tets[static_cast<std::size_t>(e)]) {
        for (int axis = 0; axis < 3; ++axis) {
          const Index d = of.dof(n, axis);
          if (d != kNone) mass[static_cast<std::size_t>(d)] += of.shape(e).volume / 4;
        }
      }
    }
    return mass;
  };
  std::vector<double> u(problem->dofs().size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (problem->dofs()[i] != kNone) u[i] = 0.04 * std::sin(static_cast<double>(i));
    // A patch keeps its pressure where it is split: the same as afresh where all volumes change
    // alike.
    if (pooled) u[i] = 0.02 * static_cast<double>(i % 3 + 1) * mesh.nodes[i / 3][i % 3];
  }
  const double factor = way.inertia ? 0.5 : 0;
  const fem::HyperelasticBody whole{*problem, laws, damaged.destroyed()};
  const fem::TangentPattern pattern(*problem);
  const std::vector<double> mass_before = way.inertia ? masses(*problem) : std::vector<double>();
  solver::FiniteBase base(whole, u, fem::Tangent::projected, pattern, {factor, mass_before});
  if (way.inverse) base.keep_inverse();
  EdgeSplit crack(*problem);
  std::vector<std::shared_ptr<const Problem>> generations{problem};
  std::vector<std::vector<double>> mass_of;
  mass_of.reserve(20);
  std::uniform_real_distribution<double> kink(-0.3, 0.3), any(-1, 1);
  for (int i = 0; i < 6; ++i) {
    const auto step = i == 0 ? crack.begin(0.1) : crack.advance(kink(random));
    ASSERT_TRUE(step.moved() && !step.through) << i;
    ASSERT_TRUE(damaged.change(step.change));
    if (i % 2 == 1) {  // beside the crack something leaves
      const Index gone = static_cast<Index>(37 * i);
      damaged.destroy(std::vector<Index>{gone});
    }
    generations.push_back(fem::parted_problem(damaged));
    const Problem& now = *generations.back();
    const fem::Parting parting(*generations[generations.size() - 2], now);
    parting.nodal(u);
    mass_of.push_back(way.inertia ? masses(now) : std::vector<double>());
    const fem::HyperelasticBody body{now, laws, damaged.destroyed()};
    const solver::RestingBody resting(body, way.inertia ? solver::RestingBody::Loose::moving
                                                        : solver::RestingBody::Loose::frozen);
    ASSERT_TRUE(base.part(now, parting, mass_of.back()));
    ASSERT_TRUE(base.follow(resting, 1000)) << i;
    EXPECT_FALSE(base.has_inverse());
    const fem::TangentPattern of_now(now);
    solver::FiniteBase fresh(resting.body(), u, fem::Tangent::projected, of_now,
                             {factor, mass_of.back()});
    std::vector<double> turned = u;
    for (double& x : turned) x *= 1.5;
    for (int turn = 0; turn < 2; ++turn) {
      Eigen::VectorXd b(now.dof_count()), x, expected;
      for (Eigen::Index k = 0; k < b.size(); ++k) b[k] = any(random);
      for (Index d : now.gripped_dofs()) b[d] = 0;
      for (Index d = 0; d < now.dof_count(); ++d) {
        if (resting.frozen()[static_cast<std::size_t>(d)]) b[d] = 0;
      }
      base.solve(b, x);
      fresh.solve(b, expected);
      EXPECT_LE((x - expected).norm(), 1e-9 * expected.norm()) << i << turn;
      // Several at once, in another order.
      const auto& place = of_now.supernodes()->place;
      linear_algebra::RowMajor columns(b.size(), 1);
      for (Eigen::Index k = 0; k < b.size(); ++k) {
        columns(place[static_cast<std::size_t>(k)], 0) = b[k];
      }
      base.solve_ordered(*of_now.supernodes(), columns);
      for (Eigen::Index k = 0; k < b.size(); ++k) {
        ASSERT_EQ(columns(place[static_cast<std::size_t>(k)], 0), x[k]);
      }
      base.turn(resting, turned);
      fresh.turn(resting, turned);
    }
    base.turn(resting, u);
  }
}

}  // namespace
}  // namespace sunder::test
