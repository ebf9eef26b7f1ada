// SPDX-License-Identifier: Apache-2.0
// A region that grows: without a copy of what there is, and by columns that are there before.
#include "solver/region_growth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "body/stiffness_factor.hpp"
#include "solver/condensed_base.hpp"
#include "solver/condensed_route.hpp"
#include "solver/grown_inverse.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::solver {
namespace {

Eigen::MatrixXd symmetric(Eigen::Index n) {
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> any(-1, 1);
  Eigen::MatrixXd a(n, n);
  for (double& v : a.reshaped()) v = any(generator);
  return a + a.transpose();
}

TEST(GrownInverse, IsTheWholeMatrixWhateverHasComeBeside) {
  const Eigen::Index n = 200, first = 40;
  const Eigen::MatrixXd all = symmetric(n);
  GrownInverse grown(std::make_shared<const Eigen::MatrixXd>(all.topLeftCorner(first, first)));
  EXPECT_EQ(grown.whole().get(), &grown.first()) << "no copy where nothing has come";
  Eigen::Index size = first;
  for (const Eigen::Index k : {1, 3, 9, 51, 60, 36}) {  // past the room at first, and past twice
    const GrownInverse before = grown;
    grown.add(all.block(0, size, size + k, k));
    size += k;
    SCOPED_TRACE(size);
    ASSERT_EQ(grown.size(), size);
    EXPECT_EQ(grown.added(), size - first);
    EXPECT_EQ(*grown.whole(), all.topLeftCorner(size, size));
    for (Eigen::Index j = 0; j < size; ++j) {
      const GrownInverse::Column column = grown.column(j);
      for (Eigen::Index i = 0; i < size; ++i) ASSERT_EQ(column[i], all(i, j));
    }
    EXPECT_EQ(*before.whole(), all.topLeftCorner(size - k, size - k)) << "a copy keeps its size";
    EXPECT_FALSE(before.same_as(grown));
  }
  EXPECT_EQ(size, n);
  // The last ones go, and others come in their place.
  grown.keep_added(71 - first);
  EXPECT_EQ(*grown.whole(), all.topLeftCorner(71, 71));
  Eigen::MatrixXd other = all.bottomRightCorner(90, 90);
  other.topLeftCorner(71, 71) = all.topLeftCorner(71, 71);
  other.bottomLeftCorner(19, 71) = other.topRightCorner(71, 19).transpose();
  grown.add(other.rightCols(19));
  EXPECT_EQ(*grown.whole(), other);
  grown.keep_added(300);
  EXPECT_EQ(grown.size(), 90);
  grown.keep_added(0);
  EXPECT_EQ(grown.whole().get(), &grown.first());
}

/// The board of Table 1; S: the unknowns at its right.
class Growing : public testing::Test {
 protected:
  Growing() {
    for (Index n = 0; n < problem.node_count(); ++n) {
      (problem.mesh().nodes[n].x() > 30 ? inside : outside).push_back(n);
    }
    for (std::vector<Index>* nodes : {&inside, &outside}) *nodes = dofs_of(*nodes);
  }
  [[nodiscard]] std::vector<Index> dofs_of(std::span<const Index> nodes) const {
    std::vector<Index> dofs;
    for (Index n : nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        if (problem.dof(n, axis) != kNone) dofs.push_back(problem.dof(n, axis));
      }
    }
    return dofs;
  }
  /// Those of an element that reaches out of S, outside.
  [[nodiscard]] std::vector<Index> beyond(const std::vector<Index>& s) const {
    for (Index e = 0; e < problem.tet_count(); ++e) {
      const auto corners = dofs_of(problem.mesh().tets[e]);
      std::vector<Index> out;
      for (Index d : corners) {
        if (std::ranges::find(s, d) == s.end()) out.push_back(d);
      }
      if (!out.empty() && out.size() < corners.size()) return out;
    }
    return {};
  }
  static bool same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() &&
           std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) ==
               0;
  }

  Problem problem{test::held_board()};
  std::shared_ptr<const linear_algebra::Factor> factor =
      std::make_shared<const linear_algebra::Factor>(fem::factor_stiffness(problem));
  std::vector<Index> inside, outside;
};

TEST_F(Growing, WhatLiesAroundAnEventIsThereToTheLastBit) {
  RegionGrowth growth(problem);
  Eigen::MatrixXd columns;
  std::vector<Index> s = inside, next = beyond(s);
  ASSERT_FALSE(next.empty());
  s.insert(s.end(), next.begin(), next.end());
  EXPECT_FALSE(growth.take(*factor, s, next, columns)) << "nobody has asked";
  growth.follow(factor, s, next);
  growth.wait();
  std::size_t taken = 0;
  for (int step = 0; step < 12; ++step) {  // walks on
    next = beyond(s);
    ASSERT_FALSE(next.empty());
    s.insert(s.end(), next.begin(), next.end());
    ASSERT_TRUE(growth.take(*factor, s, next, columns)) << "step " << step;
    taken += next.size();
    EXPECT_TRUE(same_bits(columns, factor->inverse_block(s, next)));
    growth.follow(factor, s, next);
    growth.wait();
  }
  EXPECT_EQ(growth.taken(), taken);
  EXPECT_GT(growth.bytes(), 0u);
}

TEST_F(Growing, ABaseTakesWhatIsThereAndSolvesForTheRest) {
  RegionGrowth growth(problem);
  CondensedBase helped(factor, inside), alone(factor, inside);
  helped.grow_by(&growth);
  linear_algebra::RowMajor gram(64, 64), expected(64, 64);
  std::vector<Index> s = inside;
  for (int step = 0; step < 6; ++step) {
    const std::vector<Index> next = beyond(s);
    ASSERT_FALSE(next.empty());
    s.insert(s.end(), next.begin(), next.end());
    std::vector<Difference> vectors;
    for (Index d : next) vectors.push_back({d, inside.back()});
    const std::size_t taken = growth.taken();
    helped.push(vectors, gram);
    alone.push(vectors, expected);
    EXPECT_EQ(growth.taken() - taken, step % 2 == 0 ? 0 : next.size());
    const auto rows = helped.count();
    EXPECT_EQ(gram.topLeftCorner(rows, static_cast<Eigen::Index>(next.size())),
              expected.topLeftCorner(rows, static_cast<Eigen::Index>(next.size())));
    if (step % 2 == 0) {
      growth.follow(factor, helped.dofs(), next);
      growth.wait();
    } else {
      growth.forget();
    }
  }
}

TEST_F(Growing, WhatIsNotThereIsRefused) {
  RegionGrowth growth(problem);
  growth.follow(factor, inside, std::span(inside).first(3));
  growth.wait();
  std::vector<Index> s = inside, next = beyond(s);
  s.insert(s.end(), next.begin(), next.end());
  Eigen::MatrixXd columns = Eigen::MatrixXd::Constant(1, 1, 7);
  const linear_algebra::Factor other(fem::factor_stiffness(problem));
  growth.follow(factor, inside, next);
  growth.wait();
  EXPECT_FALSE(growth.take(other, s, next, columns)) << "another factor's";
  std::vector<Index> far{outside.front()};  // the board's other end
  std::vector<Index> with_far = inside;
  with_far.push_back(far[0]);
  EXPECT_FALSE(growth.take(*factor, with_far, far, columns));
  with_far.insert(with_far.end(), next.begin(), next.end());
  EXPECT_FALSE(growth.take(*factor, with_far, next, columns)) << "a row is not there";
  EXPECT_EQ(columns, Eigen::MatrixXd::Constant(1, 1, 7));
  EXPECT_EQ(growth.taken(), 0u);
  EXPECT_TRUE(growth.take(*factor, s, next, columns));
}

// Each hand's columns have the rows that S gains by the other's.
TEST_F(Growing, TwoHandsAreServedInTurn) {
  RegionGrowth growth(problem);
  const Index left = outside.front(), right = outside[outside.size() / 2];
  std::vector<Index> s = inside;
  Eigen::MatrixXd columns;
  for (int round = 0; round < 3; ++round) {
    for (const Index at : {left, right}) growth.follow(factor, s, {&at, 1});
    growth.wait();
  }
  for (const Index at : {left, right}) {
    s.push_back(at);
    ASSERT_TRUE(growth.take(*factor, s, {&at, 1}, columns)) << at;
    EXPECT_TRUE(same_bits(columns, factor->inverse_block(s, {&at, 1})));
  }
}

TEST_F(Growing, NothingIsComputedWhereAllAroundIsInside) {
  RegionGrowth growth(problem);
  std::vector<Index> all = inside;
  all.insert(all.end(), outside.begin(), outside.end());
  growth.follow(factor, all, std::span(inside).first(2));
  growth.follow(factor, inside, {});
  growth.wait();
  EXPECT_EQ(growth.bytes(), 0u);
}

TEST_F(Growing, AFactorThatIsForgottenIsLetGo) {
  RegionGrowth growth(problem);
  auto own = std::make_shared<const linear_algebra::Factor>(fem::factor_stiffness(problem));
  const std::vector<Index> next = beyond(inside);
  growth.follow(own, inside, next);
  growth.wait();
  EXPECT_GT(own.use_count(), 1);
  growth.forget();
  growth.follow(factor, inside, next);  // after which the first is freed
  growth.wait();
  EXPECT_EQ(own.use_count(), 1);
  std::vector<Index> s = inside;
  s.insert(s.end(), next.begin(), next.end());
  Eigen::MatrixXd columns;
  EXPECT_FALSE(growth.take(*own, s, next, columns));
  EXPECT_TRUE(growth.take(*factor, s, next, columns));
}

// What a host destroys beyond the region, the route has at hand from the second time on.
TEST_F(Growing, TheRouteTakesWhatIsThere) {
  fem::DamagedBody body(std::make_shared<const Problem>(test::held_board()));
  const auto route = condensed_route(body, factor, inside, true, {});
  const auto& base = dynamic_cast<const CondensedBase&>(route->deferred()->base());
  std::size_t grown = 0;
  for (Index e = 0; e < problem.tet_count() && grown < 8; ++e) {
    const auto corners = dofs_of(problem.mesh().tets[static_cast<std::size_t>(e)]);
    const auto out = std::ranges::count_if(corners, [&](Index d) { return !base.inside({&d, 1}); });
    if (out == 0 || static_cast<std::size_t>(out) == corners.size()) continue;
    const std::size_t taken = base.growth()->taken();
    body.destroy({&e, 1});
    route->follow({.leave = {&e, 1}});
    EXPECT_TRUE(base.inside(corners));
    EXPECT_EQ(base.growth()->taken() - taken, grown == 0 ? 0 : static_cast<std::size_t>(out));
    base.growth()->wait();
    ++grown;
  }
  EXPECT_EQ(grown, 8u);
  EXPECT_TRUE(std::ranges::any_of(route->buffers(), [](const BufferPlan& b) {
    return b.name == "columns that the region may grow by" && b.bytes > 0;
  }));
}

// What a host says that it may destroy beyond the region is at hand the first time.
TEST_F(Growing, TheRouteIsWarned) {
  fem::DamagedBody body(std::make_shared<const Problem>(test::held_board()));
  const auto route = condensed_route(body, factor, inside, true, {});
  EXPECT_FALSE(route->prepares());
  const auto& base = dynamic_cast<const CondensedBase&>(route->deferred()->base());
  std::vector<Index> within, across;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto corners = dofs_of(problem.mesh().tets[static_cast<std::size_t>(e)]);
    const auto in = std::ranges::count_if(corners, [&](Index d) { return base.inside({&d, 1}); });
    if (static_cast<std::size_t>(in) == corners.size()) {
      within.push_back(e);
    } else if (in > 0) {
      across.push_back(e);
    }
  }
  route->prepare(within);
  base.growth()->wait();
  EXPECT_EQ(base.growth()->bytes(), 0u) << "nothing of the kind is missing";
  route->prepare({&across[3], 1});
  base.growth()->wait();
  EXPECT_GT(base.growth()->bytes(), 0u);
  body.destroy({&across[3], 1});
  route->follow({.leave = {&across[3], 1}});
  EXPECT_GT(base.growth()->taken(), 0u);
}

// S is what it was there, whatever it had grown by since, and the same events have the same bits
// again.
TEST_F(Growing, TheRouteGoesBackToTheSameBits) {
  fem::DamagedBody body(std::make_shared<const Problem>(test::held_board()));
  const auto route = condensed_route(body, factor, inside, true, {});
  const auto& base = dynamic_cast<const CondensedBase&>(route->deferred()->base());
  Load load;
  load.force_dofs = {inside[7]};
  load.forces = {-3};
  std::vector<Index> events;
  const auto solution = [&] {
    Eigen::VectorXd u;
    static_cast<void>(route->solve(load, {}, u));
    return Eigen::VectorXd(u(inside));
  };
  const auto destroy = [&](Index e) {
    body.destroy({&e, 1});
    route->follow({.leave = {&e, 1}});
  };
  for (Index e = 0; e < problem.tet_count() && events.size() < 6; ++e) {
    const auto corners = dofs_of(problem.mesh().tets[static_cast<std::size_t>(e)]);
    const bool out = !base.inside(corners);
    const bool in = std::ranges::any_of(corners, [&](Index d) { return base.inside({&d, 1}); });
    if (!out || !in) continue;
    if (events.size() == 2) break;
    events.push_back(e);
    destroy(e);
  }
  ASSERT_EQ(events.size(), 2u);
  const Eigen::VectorXd before = solution();
  const auto state = route->state();
  const std::vector<Index> dofs(base.dofs().begin(), base.dofs().end());
  std::vector<Eigen::VectorXd> seen;
  for (const bool again : {false, true}) {
    SCOPED_TRACE(again);
    std::size_t event = 0;
    for (Index e = problem.tet_count() - 1; e > 0 && event < 4; --e) {  // elsewhere
      const auto corners = dofs_of(problem.mesh().tets[static_cast<std::size_t>(e)]);
      if (corners.empty() || (!again && base.inside(corners))) continue;
      if (again && e != events[2 + event]) continue;
      if (!again) events.push_back(e);
      destroy(e);
      if (again) {
        EXPECT_EQ(solution(), seen[event]);
      } else {
        seen.push_back(solution());
      }
      ++event;
    }
    ASSERT_EQ(event, 4u);
    ASSERT_TRUE(route->go_back(*state, 2));
    body.take_back(2);
    EXPECT_TRUE(std::ranges::equal(base.dofs(), dofs));
    EXPECT_FALSE(base.inside(dofs_of(problem.mesh().tets[static_cast<std::size_t>(events[2])])));
    EXPECT_EQ(solution(), before);
    base.growth()->wait();
  }
}

// A hand that jumps: what is in work gives way, and what was asked for last is there in the end.
TEST_F(Growing, TheLastRequestIsServed) {
  RegionGrowth growth(problem);
  for (int i = 0; i < 40; ++i) {
    const std::vector<Index> at{outside[(static_cast<std::size_t>(i) * 97) % outside.size()]};
    growth.follow(factor, inside, at);
  }
  const std::vector<Index> last{outside.back()};
  growth.follow(factor, inside, last);
  growth.wait();
  std::vector<Index> s = inside;
  s.push_back(last[0]);
  Eigen::MatrixXd columns;
  EXPECT_TRUE(growth.take(*factor, s, last, columns));
}

}  // namespace
}  // namespace sunder::solver
