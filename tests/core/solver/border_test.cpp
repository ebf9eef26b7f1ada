// SPDX-License-Identifier: Apache-2.0
// Split nodes: new unknowns as offsets of old ones, against a fresh dense solution in which every
// node has unknowns of its own; destroyed, split again, taken back bit for bit, refused.
#include "solver/border.hpp"

#include "body/assembly.hpp"
#include "change_support.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"

namespace sunder::solver {
namespace {

using test::BodyOf;
using test::Changing;
using test::kTolerance;
using test::leaving;

/// Three cells wide and three high, a cell thick: 54 elements.
BodyOf high(BodyOf body = {}) {
  body.ny = 3;
  return body;
}

/// The nodes (i, j) of the grid, through the thickness.
std::vector<Index> nodes_at(const Changing& body, Index i, Index j) {
  const Index layer = (body.of.nx + 1) * (body.of.ny + 1), first = i + (body.of.nx + 1) * j;
  return {first, first + layer};
}

/// Whether an element of the mesh lies to the right of the nodes (i, j).
std::function<bool(Index)> right_of(const Changing& body, Index i) {
  return [nx = body.of.nx, count = body.problem.tet_count(), i](Index e) {
    return e < count && e / 6 % nx >= i;
  };
}

/// One side of the nodes (i, j): where stiffness differs the soft one, which is to take new nodes.
std::function<bool(Index)> side_of(const Changing& body, Index i) {
  const auto right = right_of(body, i);
  if (body.of.contrast == 1 || i % 2 == 0) return right;
  return [right, count = body.problem.tet_count()](Index e) { return e < count && !right(e); };
}

/// Splits the nodes (i, j).
fem::Change opened(const Changing& body, Index i, Index j, Axes axes = {}) {
  return body.split(nodes_at(body, i, j), side_of(body, i), axes);
}

/// Opens (i, j) for all of some j at once.
fem::Change opened(const Changing& body, Index i, std::vector<Index> rows) {
  std::vector<Index> nodes;
  for (Index j : rows) {
    for (Index n : nodes_at(body, i, j)) nodes.push_back(n);
  }
  return body.split(nodes, side_of(body, i));
}

/// A live element at the new nodes.
Index hung(const Changing& body) {
  for (Index e = 0; e < body.problem.tet_count(); ++e) {
    const auto& corners = body.afresh.corners(e);
    if (body.afresh.live(e) &&
        *std::max_element(corners.begin(), corners.end()) >= body.problem.node_count()) {
      return e;
    }
  }
  return kNone;
}

/// Nu .499 and contrast cost a digit after many changes.
double loose_tolerance(const BodyOf& body) {
  return body.contrast > 1 || body.poisson > 0.4 ? 1e-9 : kTolerance;
}

class Borders : public ::testing::TestWithParam<BodyOf> {};

INSTANTIATE_TEST_SUITE_P(All, Borders, ::testing::ValuesIn(test::bodies()), test::name_of_body);

TEST_P(Borders, SplitOneNodeThenTwoThenACrack) {
  Changing body(high(GetParam()));
  ASSERT_TRUE(body.change(body.split({nodes_at(body, 1, 3)[0]}, side_of(body, 1))));
  EXPECT_EQ(body.deferred.offsets().size(), 3);
  EXPECT_EQ(body.deferred.unknown(body.problem.node_count(), 2), body.problem.dof_count() + 2);
  body.compare(kTolerance);
  body.take_back();
  EXPECT_EQ(body.deferred.offsets().size(), 0);
  ASSERT_TRUE(body.change(opened(body, 1, 3)));
  EXPECT_EQ(body.deferred.offsets().size(), 6);
  body.compare(kTolerance);
  EXPECT_GT(body.solution().tail(6).norm(), 1e-4);
  ASSERT_TRUE(body.change(opened(body, 1, 2)));
  EXPECT_EQ(body.deferred.offsets().size(), 12);
  body.compare(kTolerance);
  EXPECT_TRUE(body.deferred.converged());
  ASSERT_TRUE(body.change(opened(body, 2, {3, 2})));
  EXPECT_EQ(body.deferred.offsets().size(), 24);
  // At nu .499 stress is off by some 1e-10: what the base's own columns owe, as products in
  // extended precision left it there.
  body.compare(GetParam().poisson > 0.4 ? 1e-9 : kTolerance);
}

/// Splits, elements that leave at new nodes and beside, come back and come stiffer.
TEST_P(Borders, FollowEverythingAfterASplitAndGoBackBitByBit) {
  Changing body(high(GetParam()));
  std::vector<Eigen::VectorXd> solutions{body.solution()};
  const auto follow = [&](const fem::Change& change) {
    SCOPED_TRACE("change " + std::to_string(solutions.size()));
    ASSERT_TRUE(body.change(change));
    body.compare(loose_tolerance(GetParam()));
    solutions.push_back(body.solution());
  };
  follow(opened(body, 1, 3));
  const Index first = hung(body);
  follow(leaving({first}));
  follow(opened(body, 1, 2));
  follow(leaving({11, 20}));
  follow(body.stiffened({hung(body), 30}, 4));
  follow(opened(body, 2, 3));
  follow(body.healed({first, 20}));
  fem::Change both = opened(body, 2, 2);
  both.leave = {1};
  follow(both);
  follow(reverse(body.problem, body.deferred.damage(), 3));
  ASSERT_EQ(solutions.size(), 10u);
  for (std::size_t k = solutions.size() - 1; k-- > 0;) {
    body.take_back();
    EXPECT_EQ(body.solution(), solutions[k]) << "back to change " << k;
  }
  EXPECT_THROW(body.deferred.take_back(), UsageError);
}

TEST_P(Borders, AreRefusedWhereAPieceHangsOnNothing) {
  Changing body(high(GetParam()));
  ASSERT_TRUE(body.change(opened(body, 1, 3)));
  ASSERT_TRUE(body.change(leaving({40})));
  const Eigen::VectorXd before = body.solution();
  const fem::Change cut_off = opened(body, 1, {2, 1, 0});
  const fem::Change hinged = opened(body, 1, {2, 1});  // on the line through two nodes
  const fem::Change at_one_node =
      body.split({nodes_at(body, 1, 2)[0], nodes_at(body, 1, 2)[1], nodes_at(body, 1, 1)[0],
                  nodes_at(body, 1, 1)[1], nodes_at(body, 1, 0)[0]},
                 side_of(body, 1));
  for (const fem::Change& wrong : {cut_off, hinged, at_one_node}) {
    EXPECT_FALSE(body.deferred.change(wrong));
    EXPECT_EQ(body.deferred.events(), 2);
    EXPECT_EQ(body.deferred.offsets().size(), 6);
    EXPECT_EQ(body.deferred.forms().node_count(), body.problem.node_count() + 2);
    EXPECT_EQ(body.solution(), before);
  }
  ASSERT_TRUE(body.change(opened(body, 1, 2)));
  body.compare(loose_tolerance(GetParam()));
}

/// Destroyed elements hold it by alpha: the attached part stays right, as after any cut.
TEST_P(Borders, LeaveAPieceToDestroyedElements) {
  Changing body(high(GetParam()));
  if (GetParam().gripped) return;  // the grip would hold the piece, and hardly anything else
  std::vector<Index> cells;        // two rows of them, right of what the crack leaves
  for (Index e = 0; e < 6; ++e) cells.insert(cells.end(), {6 + e, 24 + e});
  ASSERT_TRUE(body.change(leaving(cells)));
  ASSERT_TRUE(body.change(body.split(nodes_at(body, 1, 3), right_of(body, 1))));
  const auto attached = [&](Index n) { return n < body.problem.node_count() && n % 4 <= 1; };
  body.unloaded = body.ignored = [=](Index n) { return !attached(n); };
  body.compare(GetParam().contrast > 1 ? 1e-6
                                       : kTolerance);  // stiff ones have left beside soft ones
  ASSERT_TRUE(body.change(body.split(nodes_at(body, 1, 2), right_of(body, 1))));
  body.compare(test::kCutTolerance);
}

TEST(Border, SplitsANodeAgain) {
  Changing body(high());
  const Index node = nodes_at(body, 1, 2)[0];
  std::vector<Index> around;
  for (Index e = 0; e < body.problem.tet_count(); ++e) {
    const auto& c = body.afresh.corners(e);
    if (std::find(c.begin(), c.end(), node) != c.end()) around.push_back(e);
  }
  ASSERT_GE(around.size(), 6u);
  ASSERT_TRUE(body.change(body.split({node}, [&](Index e) { return e >= around[4]; })));
  body.compare(kTolerance);
  // Those that are left of the old node's, and then the new node's own.
  ASSERT_TRUE(body.change(body.split({node}, [&](Index e) { return e >= around[2]; })));
  body.compare(kTolerance);
  fem::Change again;
  again.nodes = {{node, Axes{}}};
  again.come = {{around.back(), body.deferred.forms().of(around.back())}};
  for (Index& c : again.come[0].form.corners) {
    if (c == body.problem.node_count()) c = body.problem.node_count() + 2;
  }
  ASSERT_TRUE(body.change(again));
  EXPECT_EQ(body.deferred.offsets().size(), 9);
  body.compare(kTolerance);
}

TEST(Border, LetsGoOfASupportOnTheAxesThatPart) {
  for (bool gripped : {false, true}) {
    Changing body(high({.gripped = gripped}));
    const Eigen::VectorXd held = body.solution();
    ASSERT_TRUE(body.change(opened(body, 0, 3, Axes{0})));
    EXPECT_EQ(body.deferred.offsets().size(), 0);
    EXPECT_EQ(body.deferred.unknown(body.problem.node_count(), 1), kNone);
    body.compare(kTolerance);
    body.take_back();
    EXPECT_EQ(body.solution(), held);
    ASSERT_TRUE(body.change(opened(body, 0, 3, Axes{5})));
    EXPECT_EQ(body.deferred.offsets().size(), 4);
    body.compare(kTolerance);
    ASSERT_TRUE(body.change(opened(body, 0, 2)));
    EXPECT_EQ(body.deferred.offsets().size(), 10);
    body.compare(kTolerance);
    ASSERT_TRUE(body.change(leaving({hung(body)})));
    body.compare(kTolerance);
  }
}

TEST(Border, LetsGoOfAGripOnTheAxesThatPart) {
  Changing body(high({.gripped = true}));
  const auto nodes = nodes_at(body, 3, 2);
  const auto split = [&](Index from, Axes axes) {
    return body.split(
        nodes, [from](Index e) { return e >= from; }, axes);
  };
  ASSERT_TRUE(body.change(split(36, Axes{0})));  // all keep to the grip
  body.compare(kTolerance);
  body.take_back();
  ASSERT_TRUE(body.change(split(36, Axes{2})));
  body.compare(kTolerance);
  body.take_back();
  ASSERT_TRUE(body.change(split(36, Axes{})));  // the cell above lets go
  EXPECT_EQ(body.deferred.offsets().size(), 6);
  body.compare(kTolerance);
  EXPECT_FALSE(body.change(split(0, Axes{})));  // nothing of the body would be at the old nodes
  body.compare(kTolerance);
}

TEST(Border, ClosesWhenAnEarlierSplitIsReversed) {
  Changing body(high()), other(high());
  ASSERT_TRUE(body.change(opened(body, 1, 3)));
  ASSERT_TRUE(body.change(opened(body, 2, 3)));
  ASSERT_TRUE(body.change(reverse(body.problem, body.deferred.damage(), 0)));
  EXPECT_EQ(body.deferred.events(), 3);
  EXPECT_EQ(body.deferred.offsets().size(), 12);  // ids never change
  body.compare(kTolerance);
  EXPECT_EQ(body.solution().segment(body.problem.dof_count(), 6), Eigen::VectorXd::Zero(6));
  ASSERT_TRUE(other.change(opened(other, 2, 3)));
  const auto on_old = [](Changing& b) {
    b.unloaded = [&b](Index n) { return n >= b.problem.node_count(); };
    return Eigen::VectorXd(b.solution().head(b.problem.dof_count()));
  };
  const Eigen::VectorXd expected = on_old(other);
  EXPECT_LE((on_old(body) - expected).norm(), kTolerance * expected.norm());
}

/// The parent's side is stiff as the base has it; what opens beside it is the difference of two
/// stiffnesses where the stiff side takes the new nodes.
TEST(Border, KeepsDigitsWhereTheSoftSideTakesTheNewNodes) {
  Changing soft(high({.contrast = 1e4})), stiff(high({.contrast = 1e4}));
  ASSERT_TRUE(soft.change(opened(soft, 1, {3, 2})));
  soft.compare(kTolerance);
  const auto top = nodes_at(stiff, 1, 3), below = nodes_at(stiff, 1, 2);
  ASSERT_TRUE(stiff.change(stiff.split({top[0], top[1], below[0], below[1]}, right_of(stiff, 1))));
  stiff.compare(1e-6);
}

TEST(Border, SplitsABodyThatGripsAloneHold) {
  Changing body(high({.gripped = true, .supported = false}));
  ASSERT_GT(body.problem.anchor_stiffness(), 0);
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(opened(body, 1, {3, 2})));
  body.compare(kTolerance);
  ASSERT_TRUE(body.change(leaving({hung(body), 11})));
  body.compare(kTolerance);
}

TEST(Border, CorrectsByTheSameInverse) {
  for (bool gripped : {false, true}) {
    Changing body(high({.gripped = gripped}));
    ASSERT_TRUE(body.change(opened(body, 1, {3, 2})));
    ASSERT_TRUE(body.change(leaving({hung(body)})));
    const Index n = body.problem.dof_count();
    const std::vector<Index> dofs{0, n, n + 7};
    const std::vector<double> values{1, -2, 3};
    Eigen::VectorXd u = Eigen::VectorXd::Zero(n), du = u;
    body.deferred.solve({dofs, values}, {}, u);
    const Eigen::VectorXd d = body.deferred.offsets();
    body.deferred.correct({dofs, values}, du);
    EXPECT_LE((du - u).norm(), 1e-8 * u.norm());
    EXPECT_LE((body.deferred.offsets() - d).norm(), 1e-8 * d.norm());
    EXPECT_GT(d.norm(), 0);
  }
}

TEST(Border, RefusesTwoElementsOnAHinge) {
  const Problem problem(test::two_elements());
  const linear_algebra::Factor factor(fem::assemble_lower(problem, {}));
  Deferred deferred(problem, std::make_unique<FactorBase>(factor));
  fem::Form form = fem::form_in_mesh(problem, 1);
  for (Index& c : form.corners) {
    if (c == 3) c = 5;
  }
  const fem::Change on_an_edge{{}, {{1, form}}, {{3, Axes{}}}};  // 1-2
  const fem::Change along_y{{}, {{1, form}}, {{3, Axes{5}}}};    // node 5 follows 3
  EXPECT_FALSE(deferred.change(on_an_edge));
  EXPECT_TRUE(deferred.change(along_y));
  EXPECT_EQ(deferred.offsets().size(), 2);
}

TEST(Border, RefusesWhatItDoesNotKnow) {
  Changing body(high());
  ASSERT_TRUE(body.change(opened(body, 1, 3)));
  const std::vector<Index> beyond{body.problem.dof_count() + 6};
  const std::vector<double> force{1};
  Eigen::VectorXd u;
  EXPECT_THROW(body.deferred.solve({beyond, force}, {}, u), UsageError);
  EXPECT_THROW(static_cast<void>(body.deferred.unknown(body.problem.node_count() + 2, 0)),
               UsageError);
  DamageMatrices damage;
  EXPECT_THROW(body.deferred.copy_damage(damage), UsageError);
}

TEST(Border, FollowsACrackThroughABoard) {
  Changing body({.nx = 12, .ny = 7, .gripped = true});
  ASSERT_GE(body.problem.tet_count(), 500);
  std::vector<Eigen::VectorXd> solutions{body.solution()};
  for (Index j = 7; j >= 3; --j) {
    ASSERT_TRUE(body.change(opened(body, 6, j)));
    solutions.push_back(body.solution());
  }
  body.compare(kTolerance);
  const Index first = hung(body);
  ASSERT_TRUE(body.change(leaving({first, first + 1, 6 * 28})));
  solutions.push_back(body.solution());
  ASSERT_TRUE(body.change(body.healed({first + 1})));
  body.compare(kTolerance);
  for (std::size_t k = solutions.size(); k-- > 0;) {
    body.take_back();
    EXPECT_EQ(body.solution(), solutions[k]) << "back to change " << k;
  }
}

}  // namespace
}  // namespace sunder::solver
