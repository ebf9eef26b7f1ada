// SPDX-License-Identifier: Apache-2.0
// The inverse on some unknowns after damage: by a dense update, and by the damaged body's factor.
#include "engine/condensed_update.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/region.hpp"
#include "fem/assembly.hpp"
#include "support/notch_board.hpp"
#include "support/sequences.hpp"

namespace sunder::engine {
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

TEST(LostStiffness, IsExactlyNothingForAMotionOfAll) {
  const Torn torn;
  const LostStiffness lost(torn.problem, std::span(torn.elements).first(1));
  ASSERT_EQ(lost.dofs().size(), 12u);
  std::vector<double> u(12, 1e9 / 3), forces(12, 1.0);
  lost.multiply(u, forces);
  EXPECT_EQ(forces, std::vector<double>(12, 0.0));
}

TEST(UpdatedInverse, IsThatOfTheDamagedBody) {
  const Torn torn;
  std::vector<Index> dofs;  // of the elements and some others
  const LostStiffness lost(torn.problem, torn.elements);
  for (Index d = 0; d < torn.problem.dof_count(); ++d) {
    if (d % 17 == 0 || std::ranges::binary_search(lost.dofs(), d)) dofs.push_back(d);
  }
  auto base = std::make_unique<CondensedBase>(
      std::make_shared<const fem::Factor>(fem::assemble_lower(torn.problem, {})), dofs);
  const CondensedBase& condensed = *base;
  Deferred deferred(torn.problem, std::move(base));
  for (const Index& e : torn.elements) ASSERT_TRUE(deferred.destroy({&e, 1}));
  const Eigen::MatrixXd x = updated_inverse(condensed.state(), deferred.damage());
  const Eigen::MatrixXd expected =
      fem::Factor(fem::assemble_lower(torn.problem, torn.scale)).inverse_block(dofs, dofs);
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    // Loose nodes move by 1/alpha more than others.
    EXPECT_LE((x.col(j) - expected.col(j)).norm(), 1e-8 * expected.col(j).norm()) << j;
  }
}

}  // namespace
}  // namespace sunder::engine
