// SPDX-License-Identifier: Apache-2.0
// New bases of a body whose elements leave, come back and come stiffer, against a solution that is
// assembled afresh after every change.
#include "solver/renewed_update.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <random>
#include <utility>

#include "body/stiffness_factor.hpp"
#include "change_support.hpp"
#include "solver/condensed_route.hpp"
#include "solver/factor_base.hpp"
#include "solver/lost_stiffness.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

/// A body with its record, its yardstick and a load that nothing orders.
struct Recorded {
  explicit Recorded(const test::BodyOf& of)
      : body(std::make_shared<const Problem>(test::scene_of(of))), afresh(body.problem()) {
    const Problem& problem = body.problem();
    force.assign(problem.dofs().size(), 0.0);
    for (Index d = 0; d < problem.dof_count(); ++d) {
      load.force_dofs.push_back(d);
      load.forces.push_back(0);
    }
    for (std::size_t i = 0; i < force.size(); ++i) {
      if (problem.dofs()[i] == kNone) continue;
      force[i] = std::sin(1.0 + 2.3 * static_cast<double>(i));
      load.forces[static_cast<std::size_t>(problem.dofs()[i])] = force[i];
    }
  }

  void change(const fem::Change& change) {
    ASSERT_TRUE(body.change(change));
    afresh.follow(change);
  }
  [[nodiscard]] fem::Change come(std::vector<Index> elements, double stiffness) const {
    fem::Change change;
    for (Index e : elements) {
      fem::Form form = fem::form_in_mesh(body.problem(), e);
      form.law = small_strain({stiffness * form.law.young, form.law.poisson, std::nullopt});
      change.come.push_back({e, form});
    }
    return change;
  }
  /// Of a displacement over the unknowns, relative.
  [[nodiscard]] double error(const Eigen::VectorXd& u) const {
    const auto fresh = afresh.solve(force, 0);
    double off = 0, size = 0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      const Index d = body.problem().dofs()[i];
      if (d == kNone) continue;
      const auto exact = static_cast<double>(fresh.u[static_cast<Eigen::Index>(i)]);
      off += (u[d] - exact) * (u[d] - exact);
      size += exact * exact;
    }
    return std::sqrt(off / size);
  }

  fem::DamagedBody body;
  test::ChangedBody afresh;
  Load load;
  std::vector<double> force;  // at all nodes
};

Based on_a_factor(const fem::DamagedBody& body, const linear_algebra::FactorWork& work) {
  Based based;
  if (!body.forms().new_nodes().empty()) based.parted = std::make_shared<fem::PartedBody>(body);
  const fem::DamagedBody& of = based.parted ? based.parted->body() : body;
  based.factor = std::make_shared<const linear_algebra::Factor>(fem::factor_stiffness(of, work));
  based.deferred =
      std::make_unique<Deferred>(of.forms(), std::make_unique<FactorBase>(*based.factor));
  return based;
}

/// A new base begins as soon as there is damage over the one in place, and is taken two events on.
constexpr Renewal kAtOnce{.columns = 0, .first_columns = 0, .events = 2};

Eigen::VectorXd solution(RenewedUpdate& update, const Recorded& of) {
  Eigen::VectorXd u;
  update.loaded(of.load);
  update.deferred().solve({of.load.force_dofs, of.load.forces}, {}, u);
  return u;
}

TEST(RenewedUpdate, TakesEveryChangeOverToNewBases) {
  Recorded of({});
  RenewedUpdate update(of.body, on_a_factor(of.body, {}), kAtOnce, on_a_factor);
  const auto follow = [&](const fem::Change& change) {
    SCOPED_TRACE("event " + std::to_string(of.body.events()));
    ASSERT_NO_FATAL_FAILURE(of.change(change));
    update.follow(change);
    EXPECT_LE(of.error(solution(update, of)), 1e-10);
  };
  follow({{7, 8}, {}, {}});
  follow(of.come({4}, 10));
  follow({{14}, {}, {}});
  EXPECT_EQ(update.bases(), 1);
  follow(of.come({8}, 1));  // it left before the base that is taken here
  EXPECT_EQ(update.bases(), 2);
  follow(of.come({4}, 1));
  follow({{4}, {}, {}});
  follow(of.come({7, 14}, 2));
  EXPECT_GE(update.bases(), 3);
  follow(of.come({4, 7, 14}, 1));  // as the mesh has them
  follow({{3}, {}, {}});
  follow(of.come({3}, 1));
  follow({{9}, {}, {}});
  EXPECT_GE(update.bases(), 4);
}

TEST(RenewedUpdate, MakesABaseOfWhatHasComeAtOnceToo) {
  Recorded of({});
  RenewedUpdate update(of.body, on_a_factor(of.body, {}), Renewal{}, on_a_factor);
  for (const fem::Change& change :
       {fem::Change{{7}, {}, {}}, of.come({4, 5}, 10), of.come({7}, 1)}) {
    ASSERT_NO_FATAL_FAILURE(of.change(change));
    update.follow(change);
    ASSERT_TRUE(update.rebase());
    EXPECT_EQ(update.deferred().events(), 0);
    EXPECT_LE(of.error(solution(update, of)), 1e-10);
  }
  ASSERT_NO_FATAL_FAILURE(of.change({{4, 7}, {}, {}}));
  update.follow({.leave = std::vector<Index>{4, 7}});
  EXPECT_LE(of.error(solution(update, of)), 1e-10);
}

/// Holds up who comes first until it is opened.
class Gate {
 public:
  void pass() {
    std::unique_lock lock(mutex_);
    if (std::exchange(first_, false)) opened_.wait(lock, [this] { return open_; });
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    opened_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  bool open_ = false, first_ = true;
};

/// Going back waits for no base: the one that is being made then comes to an end later, and
/// whatever the body has become meanwhile, it leaves no trace.
TEST(RenewedUpdate, GoesBackWhileABaseIsMade) {
  Recorded of({}), straight({});
  Gate gate;
  RenewedUpdate update(of.body, on_a_factor(of.body, {}), kAtOnce,
                       [&](const fem::DamagedBody& body, const linear_algebra::FactorWork& work) {
                         gate.pass();
                         return on_a_factor(body, work);
                       });
  RenewedUpdate never_back(straight.body, on_a_factor(straight.body, {}), kAtOnce, on_a_factor);
  const auto leave = [&](Index e) {
    of.body.destroy({&e, 1});
    update.follow({.leave = {&e, 1}});
  };
  solution(update, of);
  const auto intact = update.state();
  leave(7);  // a base begins
  const auto after_one = update.state();
  leave(8);
  for (const auto& [state, events] : {std::pair{&after_one, 1}, {&intact, 0}}) {
    update.stop(static_cast<std::size_t>(events));
    of.body.take_back(static_cast<std::size_t>(events));
    update.go_back(*state);
  }
  std::vector<Eigen::VectorXd> found;
  for (const Index e : {4, 14, 3, 9}) {
    leave(e);
    ASSERT_NO_FATAL_FAILURE(straight.change({{e}, {}, {}}));
    never_back.follow({.leave = std::vector<Index>{e}});
    gate.open();
    const Eigen::VectorXd there = solution(never_back, straight);
    EXPECT_EQ(solution(update, of), there) << e;
    EXPECT_LE(straight.error(there), 1e-10);
  }
  EXPECT_GE(update.bases(), 2);
  EXPECT_EQ(update.bases(), never_back.bases());
}

/// Gives the elements of even id at a node another one.
fem::Change split_at(const fem::DamagedBody& body, Index node, Index keeper, double tie = 0) {
  const Index added = body.forms().node_count();
  fem::Change split{{}, {}, {{keeper, Axes{}}}};
  if (tie > 0) split.ties.push_back({added, tie});
  for (Index e = 0; e < body.problem().tet_count(); ++e) {
    fem::Form form = body.forms().of(e);
    const auto at = std::find(form.corners.begin(), form.corners.end(), node);
    if (at == form.corners.end() || e % 2 == 1 || !(form.share > 0.5)) continue;
    *at = added;
    split.come.push_back({e, form});
  }
  return split;
}

/// Displacement of the unknowns and the offsets of new nodes.
Eigen::VectorXd with_offsets(RenewedUpdate& update, const Recorded& of) {
  const Eigen::VectorXd own = solution(update, of);
  Eigen::VectorXd u(own.size() + update.deferred().offsets().size());
  u << own, update.deferred().offsets();
  if (update.parted()) update.parted()->give_displacement(u);
  return u;
}

Index node_of_most_elements(const Problem& problem, Index but = kNone) {
  std::vector<int> count(problem.mesh().nodes.size(), 0);
  for (const auto& tet : problem.mesh().tets) {
    for (Index n : tet) {
      bool free = n != but;
      for (int axis = 0; axis < 3; ++axis) free = free && problem.dof(n, axis) != kNone;
      count[static_cast<std::size_t>(n)] += free;
    }
  }
  return static_cast<Index>(std::max_element(count.begin(), count.end()) - count.begin());
}

TEST(RenewedUpdate, BasesTakeNewUnknownsOver) {
  Recorded of({});
  RenewedUpdate update(of.body, on_a_factor(of.body, {}), kAtOnce, on_a_factor);
  RenewedUpdate kept(of.body, on_a_factor(of.body, {}), Renewal{}, on_a_factor);
  const Index node = node_of_most_elements(of.body.problem());
  const auto follow = [&](const fem::Change& change) {
    SCOPED_TRACE("event " + std::to_string(of.body.events()));
    ASSERT_TRUE(of.body.change(change));
    update.follow(change);
    kept.follow(change);
    const Eigen::VectorXd expected = with_offsets(kept, of);
    ASSERT_EQ(with_offsets(update, of).size(), expected.size());
    EXPECT_LE((with_offsets(update, of) - expected).norm(), 1e-10 * expected.norm());
  };
  follow(split_at(of.body, node, node));
  const Index other = node_of_most_elements(of.body.problem(), node);
  follow({{7}, {}, {}});
  follow(split_at(of.body, other, other));
  follow({{14}, {}, {}});
  follow({{3}, {}, {}});
  EXPECT_GT(update.bases(), 1);
  EXPECT_TRUE(update.parted());
  EXPECT_EQ(kept.bases(), 1);
  // A node that came is parted again, over a base that knows it and over one that does not.
  const Index added = of.body.problem().node_count();
  fem::Change again{{}, {}, {{node, Axes{}}}};
  for (Index e = 0; e < of.body.problem().tet_count(); ++e) {
    fem::Form form = of.body.forms().of(e);
    const auto at = std::find(form.corners.begin(), form.corners.end(), added);
    if (at == form.corners.end() || !(form.share > 0.5)) continue;
    *at = of.body.forms().node_count();
    again.come.push_back({e, form});
  }
  ASSERT_GE(again.come.size(), 1U);
  again.come.resize(1);
  follow(again);
  ASSERT_TRUE(update.rebase());
  const Eigen::VectorXd expected = with_offsets(kept, of);
  EXPECT_LE((with_offsets(update, of) - expected).norm(), 1e-10 * expected.norm());
}

TEST(RenewedUpdate, KeepsItsBaseWhereNewNodesAreTied) {
  Recorded of({});
  RenewedUpdate update(of.body, on_a_factor(of.body, {}), kAtOnce, on_a_factor);
  const Index node = of.body.problem().mesh().tets[5][0];
  const fem::Change split = split_at(of.body, node, node, 1e-3);
  ASSERT_TRUE(of.body.change(split));
  update.follow(split);
  for (Index e : {7, 14, 3}) {
    ASSERT_TRUE(of.body.change({{e}, {}, {}}));
    update.follow({.leave = {&e, 1}});
  }
  EXPECT_EQ(update.bases(), 1);
  EXPECT_FALSE(update.rebase());
  EXPECT_EQ(update.deferred().offsets().size(), 3);
}

/// K u before less K u now.
TEST(LostStiffness, IsSignedByWhatLeavesAndComes) {
  Recorded of({});
  of.body.destroy(std::vector<Index>{3});
  const fem::DamagedBody before = of.body;
  ASSERT_TRUE(of.body.change({{7, 8}, {}, {}}));
  ASSERT_TRUE(of.body.change(of.come({4, 3}, 10)));
  ASSERT_TRUE(of.body.change(of.come({7}, 1)));
  const LostStiffness lost(of.body, before.events());
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(of.body.problem().dof_count(), -1, 2);
  Eigen::VectorXd first, last;
  before.apply(u, first);
  of.body.apply(u, last);
  Eigen::VectorXd rest = first - last;
  std::vector<double> at, forces(lost.dofs().size());
  for (Index d : lost.dofs()) at.push_back(u[d]);
  lost.multiply(at, forces);
  for (std::size_t i = 0; i < forces.size(); ++i) rest[lost.dofs()[i]] -= forces[i];
  EXPECT_LE(rest.norm(), 1e-13 * first.norm());
}

/// Bases updated from the one before, over many changes; a new factor nowhere needed.
TEST(CondensedRoute, TakesEveryChangeOverToNewBases) {
  Recorded of({.nx = 6, .ny = 2, .nz = 2});
  const Problem& problem = of.body.problem();
  std::vector<Index> dofs(static_cast<std::size_t>(problem.dof_count()));
  std::iota(dofs.begin(), dofs.end(), 0);
  const auto route = condensed_route(
      of.body, std::make_shared<const linear_algebra::Factor>(fem::factor_stiffness(of.body)), dofs,
      true, {});
  std::mt19937 random(5);  // fixed
  Eigen::VectorXd u = Eigen::VectorXd::Zero(problem.dof_count()), f;
  std::vector<Index> away;
  for (int event = 0; event < 260; ++event) {
    const auto e = static_cast<Index>(random() % static_cast<std::uint32_t>(problem.tet_count()));
    fem::Change change{{e}, {}, {}};
    if (of.body.destroyed()[e] || away.size() > 8) {
      const Index back = of.body.destroyed()[e] ? e : away.front();
      change = of.come({back}, random() % 2 == 0 ? 1.0 : 3.0);
      std::erase(away, back);
    } else {
      away.push_back(e);
    }
    ASSERT_NO_FATAL_FAILURE(of.change(change));
    route->follow(change);
    if (event % 20 != 19) continue;
    route->solve(of.load, f, u);
    EXPECT_LE(of.error(u), 1e-8) << "after event " << event;
  }
  EXPECT_GE(route->bases(), 3);
}

}  // namespace
}  // namespace sunder::solver
