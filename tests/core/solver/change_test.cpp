// SPDX-License-Identifier: Apache-2.0
// Elements that leave, come back and come stiffer, against a fresh dense solution after every
// change; and every change taken back bit for bit.
#include "body/change.hpp"

#include <limits>
#include <random>

#include "body/assembly.hpp"
#include "change_support.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

using test::BodyOf;
using test::Changing;
using test::kTolerance;
using test::leaving;

/// All changes so far as one, from the intact body: what the base's rounding allows.
double error_at_once(const BodyOf& of, const Changing& body) {
  Changing once(of);
  fem::Change change;
  const fem::Forms& forms = body.deferred.forms();
  for (Index e = 0; e < body.problem.tet_count(); ++e) {
    if (forms.came().contains(e)) {
      change.come.push_back({e, forms.of(e)});
    } else if (forms.destroyed()[static_cast<std::size_t>(e)]) {
      change.leave.push_back(e);
    }
  }
  EXPECT_TRUE(once.change(change));
  return once.errors().largest();
}

class Bodies : public ::testing::TestWithParam<BodyOf> {};

INSTANTIATE_TEST_SUITE_P(All, Bodies, ::testing::ValuesIn(test::bodies()), test::name_of_body);

TEST_P(Bodies, FollowElementsThatComeBack) {
  Changing body(GetParam());
  const Eigen::VectorXd intact = body.solution();
  ASSERT_TRUE(body.change(leaving({7})));
  ASSERT_TRUE(body.change(leaving({3, 9})));
  ASSERT_TRUE(body.change(leaving({14})));
  ASSERT_TRUE(body.change(body.healed({9})));
  EXPECT_EQ(body.deferred.events(), 4);
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(body.healed({7, 14})));
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(body.healed({3})));
  EXPECT_EQ(body.deferred.events(), 6);
  EXPECT_LE((body.solution() - intact).norm(), 1e-13 * intact.norm());  // but for the grips' forces
  EXPECT_TRUE(body.deferred.converged());
  body.compare(kTolerance);
}

TEST_P(Bodies, FollowElementsThatComeStiffer) {
  Changing body(GetParam());
  ASSERT_TRUE(body.change(body.stiffened({4}, 10)));
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(leaving({4, 5})));
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(body.stiffened({5, 10, 11}, 100)));
  body.compare(GetParam().contrast > 1 ? 1e-8 : kTolerance);  // contrast is 1e6 now
  ASSERT_TRUE(body.change(body.stiffened({10}, 1e-3)));
  body.compare(GetParam().contrast > 1 ? 1e-8 : kTolerance);
}

/// Another law: volume and shape change by different factors.
TEST_P(Bodies, FollowElementsOfAnotherLaw) {
  Changing body(GetParam());
  const auto to = [&](double young, double poisson) {
    return body.again({2, 8}, [=](fem::Form& f) {
      f.law = small_strain({young, poisson, std::nullopt});
    });
  };
  ASSERT_TRUE(body.change(to(5, 0.1)));
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(to(0.5, 0.49)));
  body.compare(kTolerance);
}

/// Three elements at most leave, come back or come stiffer.
fem::Change drawn(const Changing& body, std::mt19937& random) {
  std::vector<Index> live, gone;
  for (Index e = 0; e < body.afresh.element_count(); ++e) {
    (body.afresh.live(e) ? live : gone).push_back(e);
  }
  const auto some_of = [&](std::vector<Index>& list) {
    for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[random() % i]);
    list.resize(std::min<std::size_t>(list.size(), 1 + random() % 3));
    return list;
  };
  const std::uint32_t kind = random() % 5;
  if (kind < 2 && !gone.empty()) return body.healed(some_of(gone));
  return kind == 2 ? body.stiffened(some_of(live), 2) : leaving(some_of(live));
}

/// A change that leaves every part of the body held by live elements: nothing moves 1/alpha as far.
fem::Change drawn_and_held(const Changing& body, std::mt19937& random) {
  const auto moved = [&](const test::ChangedBody& afresh) {
    return afresh.solve(body.forces(), Changing::kGrip).u.cwiseAbs().maxCoeff();
  };
  const auto far = 20 * moved(test::ChangedBody(body.problem));
  for (;;) {
    const fem::Change change = drawn(body, random);
    test::ChangedBody afresh = body.afresh;
    afresh.follow(change);
    if (moved(afresh) < far) return change;
  }
}

TEST_P(Bodies, FollowFiftyChangesAndGoBackBitByBit) {
  Changing body(GetParam());
  std::mt19937 random(5);  // fixed
  std::vector<Eigen::VectorXd> solutions{body.solution()};
  int came = 0;
  double allowed = kTolerance;
  while (solutions.size() <= 50) {
    const fem::Change change = drawn_and_held(body, random);
    const Index events = body.deferred.events();
    ASSERT_TRUE(body.change(change));
    if (body.deferred.events() < events) {  // it reversed the last one
      solutions.pop_back();
      EXPECT_EQ(body.solution(), solutions.back());
      continue;
    }
    came += change.come.empty() ? 0 : 1;
    SCOPED_TRACE("after change " + std::to_string(solutions.size()));
    // A stiff element that has left beside soft ones, or at nu .499, costs digits even at once.
    allowed = std::max(allowed, 10 * error_at_once(GetParam(), body));
    body.compare(allowed);
    if (solutions.size() > 20) body.deferred.remember();
    solutions.push_back(body.solution());
  }
  EXPECT_GT(came, 15);
  EXPECT_LT(came, 40);
  if (GetParam().contrast == 1 && GetParam().poisson == 0.4) {
    EXPECT_EQ(allowed, kTolerance);
  }
  for (std::size_t k = solutions.size() - 1; k-- > 0;) {
    body.take_back();
    EXPECT_EQ(body.solution(), solutions[k]) << "back to change " << k;
  }
  EXPECT_THROW(body.deferred.take_back(), UsageError);
}

TEST(Change, DestroysWithTheBitsOfDestroy) {
  Changing body(BodyOf{.gripped = true}), other(BodyOf{.gripped = true});
  for (const auto& event : {std::vector<Index>{7}, {3, 9, 10}, {14}}) {
    ASSERT_TRUE(body.change(leaving(event)));
    ASSERT_TRUE(other.deferred.destroy(event));
    EXPECT_EQ(body.solution(), other.solution());
  }
}

TEST(Change, ReversedAtOnceRestoresEveryBit) {
  Changing body(BodyOf{.gripped = true});
  ASSERT_TRUE(body.change(leaving({7})));
  ASSERT_TRUE(body.change(leaving({10})));
  const Eigen::VectorXd before = body.solution();
  for (const fem::Change& change : {leaving({3, 9}), body.stiffened({5}, 3), body.healed({7}),
                                    body.split({5}, [](Index e) { return e % 2 == 0; })}) {
    ASSERT_TRUE(body.change(change));
    EXPECT_EQ(body.deferred.events(), 3);
    const Eigen::VectorXd after = body.solution();  // longer where a node was split
    EXPECT_TRUE(after.size() > before.size() || after != before);
    ASSERT_TRUE(body.change(reverse(body.problem, body.deferred.damage(), 2)));
    EXPECT_EQ(body.deferred.events(), 2);
    EXPECT_EQ(body.solution(), before);
  }
  ASSERT_TRUE(body.change(body.healed({10})));
  EXPECT_EQ(body.deferred.events(), 1);
  ASSERT_TRUE(body.change(body.healed({7})));
  EXPECT_EQ(body.deferred.events(), 0);
  EXPECT_EQ(body.solution(), Changing(BodyOf{.gripped = true}).solution());
}

TEST(Change, ReversedLaterIsAnEventOfItsOwn) {
  Changing body(BodyOf{});
  ASSERT_TRUE(body.change(leaving({7, 8})));
  ASSERT_TRUE(body.change(body.stiffened({3, 8}, 5)));
  ASSERT_TRUE(body.change(leaving({12})));
  ASSERT_TRUE(body.change(reverse(body.problem, body.deferred.damage(), 1)));
  EXPECT_EQ(body.deferred.events(), 4);
  EXPECT_FALSE(body.afresh.live(8));
  body.compare(kTolerance);
  Changing same(BodyOf{});
  ASSERT_TRUE(same.change(leaving({7, 8})));
  ASSERT_TRUE(same.change(leaving({12})));
  EXPECT_LE((body.solution() - same.solution()).norm(), kTolerance * same.solution().norm());
}

TEST(Change, FollowsABodyThatGripsAloneHold) {
  Changing body(BodyOf{.gripped = true, .supported = false});
  ASSERT_GT(body.problem.anchor_stiffness(), 0);
  ASSERT_TRUE(body.change(leaving({7, 8})));
  ASSERT_TRUE(body.change(body.stiffened({3}, 10)));
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(body.healed({7})));
  body.compare(kTolerance);
}

TEST(Change, BringsAnElementBetweenOldNodes) {
  Changing body(BodyOf{});
  const Index id = body.problem.tet_count();
  // A bar from one end of the body to the other.
  fem::Form form{{0, 3, 4, 15}, {}, small_strain({50, 0.3, std::nullopt}), 1};
  const auto& x = body.problem.mesh().nodes;
  form.shape = fem::tet_shape(x[0], x[3], x[4], x[15]);
  if (form.shape.volume < 0) {
    std::swap(form.corners[0], form.corners[1]);
    form.shape = fem::tet_shape(x[3], x[0], x[4], x[15]);
  }
  ASSERT_TRUE(body.change({{5}, {{id, form}}, {}}));
  EXPECT_EQ(body.deferred.forms().element_count(), id + 1);
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(leaving({id, 6})));
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(body.healed({id})));
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(reverse(body.problem, body.deferred.damage(), 0)));
  EXPECT_EQ(body.deferred.forms().share(id), 0);
  body.compare(kTolerance);
}

TEST(Change, FollowsABodyOfTwoElements) {
  const Problem problem(test::two_elements());
  const linear_algebra::Factor factor(fem::assemble_lower(problem, {}));
  Deferred deferred(problem, std::make_unique<FactorBase>(factor));
  test::ChangedBody afresh(problem);
  std::vector<double> f(15, 0.0);
  f[9] = f[10] = 1;
  const std::vector<Index> dofs{problem.dof(3, 0), problem.dof(3, 1)};
  const std::vector<double> values{1, 1};
  const auto follow = [&](const fem::Change& change) {
    ASSERT_TRUE(deferred.change(change));
    afresh.follow(change);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(problem.dof_count());
    deferred.solve({dofs, values}, {}, u);
    const auto fresh = afresh.solve(f, 0);
    for (Index n = 3; n < (afresh.live(1) ? 5 : 4); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto expected = static_cast<double>(fresh.u[3 * n + axis]);
        EXPECT_NEAR(u[problem.dof(n, axis)], expected, 1e-10 * static_cast<double>(fresh.u.norm()));
      }
    }
  };
  fem::Form form = fem::form_in_mesh(problem, 1);
  form.law = small_strain({20, 0.2, std::nullopt});
  follow({{}, {{1, form}}, {}});
  follow(leaving({1}));
  fem::Form other = fem::form_in_mesh(problem, 0);
  other.law = small_strain({1, 0.1, std::nullopt});
  follow({{}, {{0, other}}, {}});
  follow({{}, {{0, fem::form_in_mesh(problem, 0)}, {1, form}}, {}});
}

TEST(Change, IsRefusedWhereItDoesNotFit) {
  Changing body(BodyOf{});
  Deferred& deferred = body.deferred;
  ASSERT_TRUE(deferred.change(leaving({7})));
  const Eigen::VectorXd before = body.solution();
  const fem::Form form = fem::form_in_mesh(body.problem, 3);
  const auto with = [&](auto alter) {
    fem::Coming coming{3, form};
    alter(coming);
    return fem::Change{{}, {coming}, {}};
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const fem::Change& wrong :
       {leaving({7}), leaving({-1}), leaving({18}), leaving({2, 2}),
        with([](fem::Coming& c) { c.element = 19; }), with([](fem::Coming& c) { c.element = -1; }),
        with([](fem::Coming& c) { c.form.corners[2] = 16; }),
        with([](fem::Coming& c) { c.form.corners[0] = -1; }),
        with([&](fem::Coming& c) { c.form.share = nan; }),
        with([](fem::Coming& c) { c.form.share = -1; }),
        with([](fem::Coming& c) { c.form.shape.volume = -1; }),
        fem::Change{{}, {{3, form}, {3, form}}, {}}, fem::Change{{}, {}, {{16, Axes{}}}},
        fem::Change{{}, {}, {{-1, Axes{}}}}}) {
    EXPECT_THROW(static_cast<void>(deferred.change(wrong)), UsageError);
    EXPECT_EQ(deferred.events(), 1);
    EXPECT_EQ(body.solution(), before);
  }
}

}  // namespace
}  // namespace sunder::solver
