// SPDX-License-Identifier: Apache-2.0
// The inverse on some unknowns after damage: by a dense update, and by the damaged body's factor.
#include "solver/condensed_update.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "body/assembly.hpp"
#include "solver/region.hpp"
#include "support/notch_board.hpp"
#include "support/sequences.hpp"

namespace sunder::solver {
namespace {

struct Torn {
  Problem problem{test::notch_board(FractureModel::a)};
  std::vector<Index> elements = test::crack_sequence(problem, 40, 8);
  std::vector<double> scale = std::vector<double>(problem.mesh().tets.size(), 1.0);
  Torn() {
    for (Index e : elements) scale[e] = problem.scene().fracture.alpha;
  }
};

TEST(LostStiffness, IsTheDifferenceOfTheBodies) {
  const Torn torn;
  const LostStiffness lost(torn.problem, torn.elements);
  const auto intact = fem::assemble_lower(torn.problem, {}),
             damaged = fem::assemble_lower(torn.problem, torn.scale);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(torn.problem.dof_count());
  std::vector<double> own;
  for (Index d : lost.dofs()) {
    u[d] = std::sin(0.7 * d);
    own.push_back(u[d]);
  }
  Eigen::VectorXd expected = intact.selfadjointView<Eigen::Lower>() * u;
  expected -= damaged.selfadjointView<Eigen::Lower>() * u;
  std::vector<double> forces(own.size());
  lost.multiply(own, forces);
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_NEAR(forces[i], expected[lost.dofs()[i]], 1e-12 * expected.cwiseAbs().maxCoeff());
  }
}

CondensedState state_of(const CondensedBase& base) {
  CondensedState state;
  base.copy_state(state);
  return state;
}

DamageMatrices damage_of(const Deferred& deferred) {
  DamageMatrices damage;
  deferred.copy_damage(damage);
  return damage;
}

TEST(LostStiffness, IsExactlyNothingForAMotionOfAll) {
  const Torn torn;
  const LostStiffness lost(torn.problem, std::span(torn.elements).first(1));
  ASSERT_EQ(lost.dofs().size(), 12u);
  std::vector<double> u(12, 1e9 / 3), forces(12, 1.0);
  lost.multiply(u, forces);
  EXPECT_EQ(forces, std::vector<double>(12, 0.0));
}

// Damage that leaves S makes it grow; so does damage after a base that has lost stiffness.
TEST(UpdatedInverse, IsThatOfADamagedBodyWhoseRegionHasGrown) {
  const Torn torn;
  const auto elements = std::span(torn.elements);
  const LostStiffness few(torn.problem, elements.first(8));
  std::vector<Index> dofs(few.dofs().begin(), few.dofs().end());
  const auto intact =
      std::make_shared<const linear_algebra::Factor>(fem::assemble_lower(torn.problem, {}));
  CondensedState state;
  std::vector<double> scale(torn.scale.size(), 1.0);
  auto base = std::make_unique<CondensedBase>(intact, dofs);
  for (std::size_t first = 0; first < elements.size(); first += 20) {
    SCOPED_TRACE(first);
    const CondensedBase& condensed = *base;
    Deferred deferred(torn.problem, std::move(base));
    for (const Index& e : elements.subspan(first, 20)) ASSERT_TRUE(deferred.destroy({&e, 1}));
    for (Index e : elements.first(first + 20)) scale[e] = torn.problem.scene().fracture.alpha;
    ASSERT_GT(condensed.dofs().size(), dofs.size());
    dofs.assign(condensed.dofs().begin(), condensed.dofs().end());
    state = state_of(condensed);
    state.settle();
    const Eigen::MatrixXd x = updated_inverse(state, damage_of(deferred)),
                          expected =
                              linear_algebra::Factor(fem::assemble_lower(torn.problem, scale))
                                  .inverse_block(dofs, dofs);
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
      EXPECT_LE((x.col(j) - expected.col(j)).norm(), 1e-8 * expected.col(j).norm()) << j;
    }
    // The next elements differ from a base that has lost these.
    base = std::make_unique<CondensedBase>(
        state, x, std::make_shared<const LostStiffness>(torn.problem, elements.first(first + 20)));
  }
}

TEST(UpdatedInverse, IsThatOfTheDamagedBody) {
  const Torn torn;
  std::vector<Index> dofs;  // of the elements and some others
  const LostStiffness lost(torn.problem, torn.elements);
  for (Index d = 0; d < torn.problem.dof_count(); ++d) {
    if (d % 17 == 0 || std::ranges::binary_search(lost.dofs(), d)) dofs.push_back(d);
  }
  auto base = std::make_unique<CondensedBase>(
      std::make_shared<const linear_algebra::Factor>(fem::assemble_lower(torn.problem, {})), dofs);
  const CondensedBase& condensed = *base;
  Deferred deferred(torn.problem, std::move(base));
  for (const Index& e : torn.elements) ASSERT_TRUE(deferred.destroy({&e, 1}));
  const Eigen::MatrixXd x = updated_inverse(state_of(condensed), damage_of(deferred));
  EXPECT_EQ(updated_inverse(state_of(condensed), damage_of(deferred), {}, {.threads = 3}), x);
  const Eigen::MatrixXd expected =
      linear_algebra::Factor(fem::assemble_lower(torn.problem, torn.scale))
          .inverse_block(dofs, dofs);
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    // Loose nodes move by 1/alpha more than others.
    EXPECT_LE((x.col(j) - expected.col(j)).norm(), 1e-8 * expected.col(j).norm()) << j;
  }
}

/// An inverse over `dofs` that was updated before, after the first 20 elements, and lacks kLacks.
constexpr double kLacks = 1e-7;
std::unique_ptr<CondensedBase> worn_base(const Torn& torn, const std::vector<Index>& dofs) {
  const auto few = std::span(torn.elements).first(20);
  std::vector<double> scale(torn.scale.size(), 1.0);
  for (Index e : few) scale[e] = torn.problem.scene().fracture.alpha;
  const auto intact =
      std::make_shared<const linear_algebra::Factor>(fem::assemble_lower(torn.problem, {}));
  const auto before = std::make_shared<const LostStiffness>(torn.problem, few);
  const auto x0 = std::make_shared<const Eigen::MatrixXd>(intact->inverse_block(dofs, dofs));
  const Eigen::MatrixXd x =
      linear_algebra::Factor(fem::assemble_lower(torn.problem, scale)).inverse_block(dofs, dofs) *
      (1 + kLacks);
  return std::make_unique<CondensedBase>(
      CondensedState{intact, dofs, {}, GrownInverse(x0), before, {}}, x, before);
}

// An inverse that was updated before has an error. Where damage and loads act it does not last.
TEST(UpdatedInverse, TakesOutWhatTheOneBeforeLacked) {
  const Torn torn;
  const std::span<const Index> elements = torn.elements;
  const LostStiffness all(torn.problem, elements);
  std::vector<Index> dofs;
  for (Index d = 0; d < torn.problem.dof_count(); ++d) {
    if (d % 17 == 0 || std::ranges::binary_search(all.dofs(), d)) dofs.push_back(d);
  }
  auto base = worn_base(torn, dofs);
  const CondensedBase& condensed = *base;
  Deferred deferred(torn.problem, std::move(base));
  for (const Index& e : elements.subspan(20)) ASSERT_TRUE(deferred.destroy({&e, 1}));

  const Index place = 3, loaded = dofs[place], elsewhere = 5;
  CondensedState state = state_of(condensed);
  const Eigen::MatrixXd mended = updated_inverse(state, damage_of(deferred), {&loaded, 1});
  for (const int threads : {2, 3}) {
    EXPECT_EQ(updated_inverse(state, damage_of(deferred), {&loaded, 1}, {.threads = threads}),
              mended)
        << "other bits by several threads";
  }
  const std::atomic<bool> stop{true};
  EXPECT_THROW((void)updated_inverse(state, damage_of(deferred), {}, {.stop = &stop}),
               linear_algebra::Stopped);
  state.lost = nullptr;  // as if it were the factor's own
  const Eigen::MatrixXd plain = updated_inverse(state, damage_of(deferred), {&loaded, 1});
  const Eigen::MatrixXd expected =
      linear_algebra::Factor(fem::assemble_lower(torn.problem, torn.scale))
          .inverse_block(dofs, dofs);
  const auto error = [&](const Eigen::MatrixXd& of, Index column) {
    return (of.col(column) - expected.col(column)).norm() / expected.col(column).norm();
  };
  EXPECT_LE(error(mended, place), 1e-10);
  EXPECT_GE(error(plain, place), kLacks / 10);
  EXPECT_GE(error(mended, elsewhere), kLacks / 10) << "other columns wait for damage or loads";
  EXPECT_EQ(mended, mended.transpose());
}

// As the one above, but the solution is mended and not the inverse: under a load on S and under one
// that is not, with a grip.
TEST(CondensedBase, AWornInverseIsMadeUpForByTheFactor) {
  const Torn torn;
  const std::span<const Index> elements = torn.elements;
  const LostStiffness all(torn.problem, elements);
  std::vector<Index> dofs(all.dofs().begin(), all.dofs().end());
  const linear_algebra::Factor torn_factor(fem::assemble_lower(torn.problem, torn.scale));
  auto owned = worn_base(torn, dofs);
  CondensedBase& base = *owned;
  EXPECT_TRUE(base.drifts());
  Deferred deferred(torn.problem, std::move(owned));
  for (const Index& e : elements.subspan(20)) ASSERT_TRUE(deferred.destroy({&e, 1}));
  const Index grip = dofs[7];
  ASSERT_TRUE(deferred.follow({.grasp = {&grip, 1}}));

  Index outside = 0;
  while (std::ranges::binary_search(all.dofs(), outside)) ++outside;
  for (const Index loaded : {dofs[3], outside}) {
    SCOPED_TRACE(loaded == outside ? "outside" : "on S");
    const double force = 2, held[] = {0.25};
    Eigen::VectorXd f = Eigen::VectorXd::Zero(torn.problem.dof_count()), unit = f, u;
    f[loaded] = force;
    unit[grip] = 1;
    const Eigen::VectorXd of_grip = torn_factor.solve(unit), of_force = torn_factor.solve(f);
    const Eigen::VectorXd exact = of_force + of_grip * ((held[0] - of_force[grip]) / of_grip[grip]);
    const auto error = [&] {
      double square = 0, all_square = 0;
      for (Index d : dofs) {
        square += (u[d] - exact[d]) * (u[d] - exact[d]);
        all_square += exact[d] * exact[d];
      }
      return std::sqrt(square / all_square);
    };
    deferred.solve({{&loaded, 1}, {&force, 1}}, held, u);
    EXPECT_GE(error(), kLacks / 100);
    for (int pass = 0; pass < 2; ++pass) {
      base.expand_mended(deferred.refine_at(base.project_mended(), held), u);
      deferred.hold(held, u);
      EXPECT_LE(error(), pass == 0 ? 1e-10 : 1e-11);
    }
    EXPECT_EQ(u[grip], held[0]);
  }
}

// The frame after a full check, whose residual is a load on all unknowns, has its load again: no
// solve of the whole body, and the same bits. Where S grows both are solved for anew.
TEST(CondensedBase, AResidualLeavesTheLoadWhatItWas) {
  const Torn torn;
  const LostStiffness few(torn.problem, std::span(torn.elements).first(8));
  const auto intact =
      std::make_shared<const linear_algebra::Factor>(fem::assemble_lower(torn.problem, {}));
  const auto solved = [&] { return intact->cholesky().supernodes().solved.get(); };
  auto owned = std::make_unique<CondensedBase>(intact, few.dofs());
  CondensedBase& base = *owned;
  Deferred deferred(torn.problem, std::move(owned));
  ASSERT_TRUE(deferred.destroy({&torn.elements[0], 1}));

  Index outside = 0;
  while (std::ranges::binary_search(few.dofs(), outside)) ++outside;
  const double force = 2;
  const Forces load{{&outside, 1}, {&force, 1}};
  std::vector<Index> all(static_cast<std::size_t>(torn.problem.dof_count()));
  std::iota(all.begin(), all.end(), 0);
  const std::vector<double> residual(all.size(), 1e-9);
  Eigen::VectorXd first, of_residual, again;
  std::size_t before = solved();
  deferred.solve(load, {}, first);
  EXPECT_EQ(solved(), before + 1);
  deferred.solve({all, residual}, {}, of_residual);
  before = solved();
  deferred.solve(load, {}, again);
  EXPECT_EQ(solved(), before);
  EXPECT_EQ(again, first);

  const std::size_t unknowns = base.dofs().size();
  ASSERT_TRUE(deferred.destroy({&torn.elements[39], 1}));
  ASSERT_GT(base.dofs().size(), unknowns);
  before = solved();
  deferred.solve(load, {}, again);
  EXPECT_EQ(solved(), before + 1);
  deferred.solve({all, residual}, {}, of_residual);
  EXPECT_EQ(solved(), before + 2);
}

}  // namespace
}  // namespace sunder::solver
