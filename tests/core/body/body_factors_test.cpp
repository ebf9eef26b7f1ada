// SPDX-License-Identifier: Apache-2.0
// Factors of a body that changes, against factors made from nothing.
#include "body/body_factors.hpp"

#include <gtest/gtest.h>

#include "body/stiffness_factor.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::fem {
namespace {

struct Torn {
  std::shared_ptr<const Problem> problem;
  DamagedBody body{problem};
  linear_algebra::SparseMatrix intact;
  linear_algebra::Factor first = factor_stiffness(*problem, {}, {.ordered = &intact});
  std::vector<Index> elements = test::crack_sequence(*problem, 30, 8);
  Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(problem->dof_count(), -1, 2);

  explicit Torn(const Scene& scene) : problem(std::make_shared<const Problem>(scene)) {}
  [[nodiscard]] Eigen::VectorXd by(BodyFactors& factors) const {
    return factors.of(body, {})->solve(f);
  }
  void expect_that_of_the_body(BodyFactors& factors) const {
    const Eigen::VectorXd x = factor_stiffness(body).solve(f);
    EXPECT_LE((by(factors) - x).norm(), 1e-6 * x.norm());  // 1/alpha where nodes hang loose
  }
};

TEST(BodyFactors, FollowTheBodyThereAndBack) {
  Torn torn(test::pulled_board());
  const auto& nodes = torn.first.cholesky().shared_supernodes();
  BodyFactors assembled(*torn.problem, nodes), given(*torn.problem, nodes, torn.intact);
  EXPECT_EQ(assembled.bytes(), 0U) << "nothing has been asked of it";
  EXPECT_EQ(torn.by(assembled), torn.first.solve(torn.f)) << "the intact one's bits";
  EXPECT_EQ(assembled.bytes(), given.bytes());
  const Eigen::VectorXd intact = torn.by(assembled);
  for (const Index& e : torn.elements) torn.body.destroy({&e, 1});
  torn.expect_that_of_the_body(assembled);
  EXPECT_EQ(torn.by(assembled), torn.by(given));
  EXPECT_GT((torn.by(assembled) - intact).norm(), 1e-3 * intact.norm());
  EXPECT_EQ(factor_stiffness(torn.body).entries(), assembled.of(torn.body, {})->entries());
  torn.body.take_back(0);
  EXPECT_EQ(torn.by(assembled), intact);
}

// An element that comes as other matter has a stiffness that the intact body does not give.
TEST(BodyFactors, TakeOtherMatterAndWhatTheMeshHasAfterIt) {
  Torn torn(test::pulled_board());
  BodyFactors factors(*torn.problem, torn.first.cholesky().shared_supernodes());
  const Eigen::VectorXd intact = torn.by(factors);
  const Index e = torn.elements.front();
  torn.body.destroy({&e, 1});
  Form form = torn.body.forms().of(e);
  form.share = 1;
  form.law.mu *= 3;
  Change comes;
  comes.come.push_back({e, form});
  ASSERT_TRUE(torn.body.change(comes));
  ASSERT_FALSE(torn.body.others().empty());
  torn.expect_that_of_the_body(factors);
  EXPECT_GT((torn.by(factors) - intact).norm(), 1e-6 * intact.norm());
  torn.body.take_back(1);
  torn.expect_that_of_the_body(factors);
  torn.body.take_back(0);
  EXPECT_EQ(torn.by(factors), intact);
}

TEST(BodyFactors, HavePooledVolume) {
  Scene scene = test::held_board();
  for (auto& [name, material] : scene.materials) material.volume = MaterialVolume::pooled;
  Torn torn(scene);
  BodyFactors factors(*torn.problem, torn.first.cholesky().shared_supernodes());
  torn.expect_that_of_the_body(factors);
  for (const Index& e : torn.elements) torn.body.destroy({&e, 1});
  torn.expect_that_of_the_body(factors);
}

TEST(BodyFactors, AreGivenUp) {
  Torn torn(test::pulled_board());
  BodyFactors factors(*torn.problem, torn.first.cholesky().shared_supernodes());
  const std::atomic<bool> stop{true};
  EXPECT_THROW((void)factors.of(torn.body, {.stop = &stop}), linear_algebra::Stopped);
  EXPECT_EQ(torn.by(factors), torn.first.solve(torn.f)) << "and serve the next one";
}

}  // namespace
}  // namespace sunder::fem
