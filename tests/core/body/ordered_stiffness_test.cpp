// SPDX-License-Identifier: Apache-2.0
// The stiffness that is kept up with damage, against one assembled anew.
#include "body/ordered_stiffness.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include "body/stiffness_factor.hpp"

#include "body/assembly.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::fem {
namespace {

Scene gripped_board() {
  Scene scene = test::pulled_board();
  scene.instruments[0].action =
      Grip{test::lower_right_corner(), Vec3::Constant(0.25), Axes{7}};  // anchors
  return scene;
}

TEST(OrderedStiffness, FollowsDamageAsIfAssembledAnew) {
  DamagedBody body(std::make_shared<const Problem>(gripped_board()));
  const Problem& problem = body.problem();
  linear_algebra::SparseMatrix intact;
  const linear_algebra::Factor first = factor_stiffness(problem, {}, {.ordered = &intact});
  const auto& nodes = first.cholesky().shared_supernodes();
  OrderedStiffness ordered(problem, nodes, intact);
  const auto sequence = test::crack_sequence(problem, 90, 8);
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    body.destroy({&sequence[i], 1});
    if (i % 30 != 29) continue;
    ordered.follow(body);
    const linear_algebra::SparseMatrix anew = body.stiffness();
    ASSERT_EQ(ordered.matrix().nonZeros(), anew.nonZeros());
    for (Index j = 0; j < anew.cols(); ++j) {
      for (linear_algebra::SparseMatrix::InnerIterator it(anew, j); it; ++it) {
        const auto [column, row] = std::minmax(nodes->place[it.row()], nodes->place[j]);
        // Two orders of a sum of some twenty terms, none larger than the diagonals allow: also
        // where a node hangs on destroyed elements alone.
        const double size = std::sqrt(anew.coeff(j, j) * anew.coeff(it.row(), it.row()));
        ASSERT_NEAR(ordered.matrix().coeff(row, column), it.value(), 1e-14 * size)
            << it.row() << ' ' << j << " after " << i + 1;
      }
    }
  }
  const linear_algebra::Factor kept = ordered.factor(), fresh = factor_stiffness(body);
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(problem.dof_count(), -1, 2);
  EXPECT_EQ(kept.entries(), first.entries());
  const Eigen::VectorXd x = fresh.solve(f);
  EXPECT_LE((kept.solve(f) - x).norm(), 1e-6 * x.norm());  // 1/alpha where nodes hang loose
}

TEST(OrderedStiffness, GoesBackToTheSameBits) {
  DamagedBody body(std::make_shared<const Problem>(gripped_board()));
  const Problem& problem = body.problem();
  linear_algebra::SparseMatrix intact;
  const linear_algebra::Factor first = factor_stiffness(problem, {}, {.ordered = &intact});
  OrderedStiffness there(problem, first.cholesky().shared_supernodes(), intact), back = there;
  const auto sequence = test::crack_sequence(problem, 60, 8);
  for (std::size_t i = 0; i < 20; ++i) body.destroy({&sequence[i], 1});
  there.follow(body);
  for (std::size_t i = 20; i < 60; ++i) body.destroy({&sequence[i], 1});
  back.follow(body);
  body.take_back(20);
  EXPECT_EQ(body.events(), 20U);
  EXPECT_EQ(std::ranges::count(body.destroyed(), 1), 20);
  back.follow(body);
  const auto same = [&] {
    const auto size = there.matrix().nonZeros();
    return std::equal(there.matrix().valuePtr(), there.matrix().valuePtr() + size,
                      back.matrix().valuePtr());
  };
  EXPECT_TRUE(same());
  body.destroy({&sequence[50], 1});  // and goes on otherwise
  there.follow(body);
  back.follow(body);
  EXPECT_TRUE(same());
}

TEST(OrderedStiffness, GivesTheSameBitsInOneStepAndInMany) {
  DamagedBody body(std::make_shared<const Problem>(gripped_board()));
  const Problem& problem = body.problem();
  linear_algebra::SparseMatrix intact;
  const linear_algebra::Factor first = factor_stiffness(problem, {}, {.ordered = &intact});
  OrderedStiffness once(problem, first.cholesky().shared_supernodes(), intact), often(once);
  for (Index e : test::crack_sequence(problem, 40, 8)) {
    body.destroy({&e, 1});
    often.follow(body);
  }
  once.follow(body);
  for (Index i = 0; i < once.matrix().nonZeros(); ++i) {
    ASSERT_EQ(once.matrix().valuePtr()[i], often.matrix().valuePtr()[i]);
  }
}

TEST(OrderedStiffness, IntactGivesTheFirstFactorAgain) {
  const Problem problem(gripped_board());
  linear_algebra::SparseMatrix intact;
  const linear_algebra::Factor first = factor_stiffness(problem, {}, {.ordered = &intact});
  const OrderedStiffness ordered(problem, first.cholesky().shared_supernodes(), intact);
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(problem.dof_count(), -1, 2);
  EXPECT_EQ(ordered.factor().solve(f), first.solve(f));
}

}  // namespace
}  // namespace sunder::fem
