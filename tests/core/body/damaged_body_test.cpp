// SPDX-License-Identifier: Apache-2.0
// The one record of what has left and come, and what is read off it.
#include "body/damaged_body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "body/stiffness_factor.hpp"
#include "core/solver/change_support.hpp"
#include "sunder/error.hpp"

namespace sunder::fem {
namespace {

std::shared_ptr<const Problem> row_of_cells() {
  return std::make_shared<const Problem>(test::scene_of({}));
}

Change with_form(Index element, Form form) { return {{}, {{element, form}}, {}}; }

/// An element as it is, of other stiffness.
Form stiffer(const DamagedBody& body, Index element, double times) {
  Form form = body.forms().of(element);
  form.law = small_strain({times * form.law.young, form.law.poisson, std::nullopt});
  form.share = 1;
  return form;
}

double centre_x(const Problem& problem, Index element) {
  double sum = 0;
  for (Index n : problem.mesh().tets[element]) sum += problem.mesh().nodes[n].x() / 4;
  return sum;
}

TEST(DamagedBody, SaysWhatIsDestroyed) {
  DamagedBody body(row_of_cells());
  const double alpha = body.problem().scene().fracture.alpha;
  body.destroy(std::vector<Index>{7, 3});
  EXPECT_EQ(body.destroyed()[7], 1);
  EXPECT_EQ(body.destroyed()[4], 0);
  EXPECT_EQ(body.scale()[3], alpha);
  EXPECT_EQ(body.scale()[4], 1);
  ASSERT_TRUE(body.change(with_form(7, form_in_mesh(body.problem(), 7))));
  EXPECT_EQ(body.destroyed()[7], 0);
  EXPECT_EQ(body.scale()[7], 1);
  EXPECT_TRUE(body.others().empty());
  ASSERT_TRUE(body.change(with_form(4, stiffer(body, 4, 10))));
  EXPECT_EQ(body.scale()[4], 0) << "it is other matter now";
  EXPECT_EQ(body.others().size(), 1U);
  body.destroy(std::vector<Index>{4});
  EXPECT_EQ(body.destroyed()[4], 1);
  ASSERT_EQ(body.others().size(), 1U);
  EXPECT_EQ(body.others()[0].share, alpha);
}

TEST(DamagedBody, IsTheSameForWhoeverReadsItsRecord) {
  DamagedBody body(row_of_cells());
  DamagedBody copy = body;
  body.destroy(std::vector<Index>{7, 3});
  ASSERT_TRUE(body.change(with_form(4, stiffer(body, 4, 10))));
  body.destroy(std::vector<Index>{9});
  EXPECT_EQ(copy.events(), 0U);
  copy.follow(2);
  EXPECT_EQ(copy.destroyed()[9], 0);
  EXPECT_EQ(copy.scale()[4], 0);
  EXPECT_THROW(copy.destroy(std::vector<Index>{1}), UsageError) << "it has not followed all";
  copy.follow(3);
  EXPECT_TRUE(std::ranges::equal(copy.scale(), body.scale()));
  EXPECT_TRUE(std::ranges::equal(copy.destroyed(), body.destroyed()));
  EXPECT_EQ(body.as_of(1).changed(0, 3), (std::vector<Index>{7, 3, 4, 9}));
  EXPECT_EQ(body.changed(1, 2), std::vector<Index>{4});
  Change event;
  body.read(2, event);
  EXPECT_EQ(event.leave, std::vector<Index>{9});
  EXPECT_TRUE(event.come.empty());
}

TEST(DamagedBody, RecordsNothingThatDoesNotFitOrHangsOnNothing) {
  DamagedBody body(row_of_cells());
  body.destroy(std::vector<Index>{7});
  EXPECT_THROW(static_cast<void>(body.change({{7}, {}, {}})), UsageError);
  Change nothing_left;
  for (Index e = 0; e < body.problem().tet_count(); ++e) {
    Form form = form_in_mesh(body.problem(), e);
    if (centre_x(body.problem(), e) < 4) continue;
    form.share = e % 6 == 0 ? 1 : 0;
    nothing_left.come.push_back({e, form});
  }
  EXPECT_FALSE(body.change(nothing_left));
  EXPECT_EQ(body.events(), 1U);
}

/// Solved by its factor and multiplied back, against an assembly that shares no formula with it.
TEST(DamagedBody, HasTheStiffnessOfWhatItsElementsAre) {
  DamagedBody body(row_of_cells());
  const Problem& problem = body.problem();
  test::ChangedBody afresh(problem);
  const auto follow = [&](const Change& change) {
    ASSERT_TRUE(body.change(change));
    afresh.follow(change);
  };
  follow({{7}, {}, {}});
  follow(with_form(4, stiffer(body, 4, 10)));
  Form half = form_in_mesh(problem, 10);
  half.share = 0.5;
  follow(with_form(10, half));
  std::vector<double> f(3 * problem.mesh().nodes.size());
  Eigen::VectorXd on = Eigen::VectorXd::Zero(problem.dof_count()), back;
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (problem.dofs()[i] == kNone) continue;
    f[i] = std::sin(static_cast<double>(i));
    on[problem.dofs()[i]] = f[i];
  }
  const Eigen::VectorXd u = factor_stiffness(body).solve(on);
  const auto fresh = afresh.solve(f, 0);
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (problem.dofs()[i] == kNone) continue;
    EXPECT_NEAR(u[problem.dofs()[i]], static_cast<double>(fresh.u[static_cast<Index>(i)]),
                1e-11 * u.norm());
  }
  body.apply(u, back);
  EXPECT_LE((back - on).norm(), 1e-11 * on.norm());
  double largest = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!body.destroyed()[e]) {
      largest = std::max(largest, static_cast<double>(afresh.stress(e, fresh.u).norm()));
    }
  }
  EXPECT_NEAR(body.largest_stress(u), largest, 1e-10 * largest);
}

TEST(DamagedBody, RefusesNewUnknownsWhereThereIsNoRoomForThem) {
  DamagedBody body(row_of_cells());
  const Index node = body.problem().mesh().tets[5][0];
  Form form = form_in_mesh(body.problem(), 5);
  form.corners[0] = body.problem().node_count();
  ASSERT_TRUE(body.change({{}, {{5, form}}, {{node, Axes{}}}}));
  EXPECT_THROW(static_cast<void>(body.stiffness()), UsageError);
}

// Eleven displacements, eight at once and three more, are multiplied as each by itself: with
// damage, and where forms that are not the mesh's leave no other way.
TEST(DamagedBody, MultipliesSeveralDisplacementsAtOnce) {
  DamagedBody body(row_of_cells());
  body.destroy(std::vector<Index>{7, 3});
  const auto check = [&] {
    Eigen::MatrixXd x(body.problem().dof_count(), 11), all;
    for (Index c = 0; c < x.cols(); ++c) {
      for (Index d = 0; d < x.rows(); ++d) x(d, c) = std::sin(0.7 * d + c) + (c == 10 ? 1e6 : 0);
    }
    body.apply(x, all);
    Eigen::VectorXd each;
    for (Index c = 0; c < x.cols(); ++c) {
      body.apply(Eigen::VectorXd(x.col(c)), each);
      EXPECT_LE((all.col(c) - each).norm(), 1e-13 * each.norm()) << c;
      EXPECT_GT(each.norm(), 0) << c;
    }
  };
  check();
  ASSERT_TRUE(body.change(with_form(4, stiffer(body, 4, 10))));
  ASSERT_FALSE(body.others().empty());
  check();
}

}  // namespace
}  // namespace sunder::fem
