// SPDX-License-Identifier: Apache-2.0
// Every base with the deferred update, against the yardstick.
#include "solver/deferred.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "body/assembly.hpp"
#include "body/pieces.hpp"
#include "solver/condensed_update.hpp"
#include "solver/factor_base.hpp"
#include "solver/inverse_base.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"
#include "support/yardstick.hpp"

namespace sunder::solver {
namespace {

/// A problem with the force that pulls its board, over nodes and over unknowns.
struct Board {
  explicit Board(Scene scene)
      : problem(std::move(scene)), factor(fem::assemble_lower(problem, {})) {
    nodal.assign(problem.dofs().size(), 0.0);
    for (Index n = 0; n < problem.node_count(); ++n) {
      const Vec3& x = problem.mesh().nodes[n];
      const Index d = problem.dof(n, 1);
      if (x.x() < 49.999 || x.y() > 0.001) continue;
      nodal[3 * static_cast<std::size_t>(n) + 1] = -30;
      if (d != kNone &&
          !std::binary_search(problem.gripped_dofs().begin(), problem.gripped_dofs().end(), d)) {
        dofs.push_back(d);
        values.push_back(-30);
      }
    }
  }

  [[nodiscard]] std::unique_ptr<Base> base(const std::string& name) const {
    if (name == "inverse") return std::make_unique<InverseBase>(factor);
    return std::make_unique<FactorBase>(factor);
  }

  [[nodiscard]] std::vector<double> nodal_displacement(const Eigen::VectorXd& u) const {
    std::vector<double> all(problem.dofs().size());
    fem::scatter(problem, {u.data(), static_cast<std::size_t>(u.size())}, all);
    return all;
  }

  Problem problem;
  linear_algebra::Factor factor;
  std::vector<double> nodal, values;
  std::vector<Index> dofs;
};

// Whatever the tolerance, a solution that is judged by its energy lacks no more than is reported,
// and ends within rounding of the fully refined one where the tolerance asks for that.
TEST(Deferred, JudgedByEnergyEndsWhereItsReportIsTrue) {
  const Board board{test::held_board()};
  const auto crack = test::crack_sequence(board.problem, 60, 10);
  Deferred deferred(board.problem, board.base("inverse"));
  for (const Index& e : crack) ASSERT_TRUE(deferred.destroy({&e, 1}));
  Eigen::VectorXd exact, u;
  deferred.solve({board.dofs, board.values}, {}, exact);
  deferred.judge_by_energy();
  const auto stiffness = [&] {
    std::vector<double> scale(board.problem.mesh().tets.size(), 1.0);
    for (Index e : crack) scale[e] = board.problem.scene().fracture.alpha;
    return fem::assemble_lower(board.problem, scale);
  }();
  const auto energy_of = [&](const Eigen::VectorXd& v) {
    return v.dot(stiffness.selfadjointView<Eigen::Lower>() * v);
  };
  const double rounding = 1e-18 * energy_of(exact);  // of u itself
  for (double tolerance = 1e-4; tolerance > 1e-30; tolerance *= 1e-2) {
    SCOPED_TRACE(tolerance);
    deferred.solve({board.dofs, board.values}, {}, u, tolerance);
    EXPECT_LE(energy_of(u - exact), deferred.defect_energy() + rounding);
    if (tolerance > 1e3 * rounding) {
      EXPECT_LE(deferred.defect_energy(), 400 * tolerance);
    }
  }
  EXPECT_LE((u - exact).norm(), 1e-11 * exact.norm());
}

struct Engine {
  std::string name;
  std::size_t batch;
  Deferred deferred;
};

std::vector<Engine> engines(const Board& board, std::vector<std::size_t> batches) {
  std::vector<Engine> all;
  for (const char* name : {"inverse", "factor"}) {
    for (std::size_t batch : batches) {
      all.push_back({std::string(name) + " in batches of " + std::to_string(batch), batch,
                     Deferred(board.problem, board.base(name))});
    }
  }
  return all;
}

void destroy_up_to(Engine& engine, std::span<const Index> sequence, std::size_t from,
                   std::size_t to) {
  for (std::size_t i = from - from % engine.batch; i < to; i += engine.batch) {
    const std::size_t end = std::min(i + engine.batch, sequence.size());
    if (end <= from || end > to) continue;
    ASSERT_TRUE(engine.deferred.destroy(sequence.subspan(i, end - i)));
  }
}

/// Compares all engines with the yardstick; `ignored`: elements that do not count.
void compare(const Board& board, std::span<Engine> all, std::span<const Index> destroyed,
             double tolerance) {
  std::vector<std::uint8_t> dead(board.problem.mesh().tets.size(), 0);
  for (Index e : destroyed) dead[e] = 1;
  const std::vector<double> grips(board.problem.gripped_dofs().size(), 0.25);
  const plain::Body plain(board.problem, dead);
  const auto right = test::yardstick(board.problem, dead, board.nodal, grips);
  const LooseParts loose = find_loose_parts(board.problem, dead);
  std::vector<std::uint8_t> ignored = dead;
  for (const auto& piece : loose.pieces) {
    for (Index e : piece) ignored[e] = 1;
  }
  for (Engine& engine : all) {
    if (destroyed.size() % engine.batch != 0) continue;
    SCOPED_TRACE(engine.name + " after " + std::to_string(destroyed.size()));
    Eigen::VectorXd u;
    engine.deferred.solve({board.dofs, board.values}, grips, u);
    ASSERT_TRUE(u.allFinite());
    const std::vector<double> nodal = board.nodal_displacement(u);
    EXPECT_LE(test::displacement_error(board.problem.mesh(), ignored, nodal, right.displacement),
              tolerance);
    EXPECT_LE(test::stress_error(ignored, plain.stress(nodal), right.stress), tolerance);
  }
}

void follow(const Board& board, std::span<const Index> sequence, double tolerance) {
  std::vector<Engine> all = engines(board, {1, 10, 100});
  std::size_t done = 0;
  for (std::size_t k : {std::size_t{0}, std::size_t{1}, std::size_t{10}, std::size_t{50},
                        std::size_t{100}, std::size_t{200}}) {
    for (Engine& engine : all) destroy_up_to(engine, sequence, done, k);
    compare(board, all, sequence.first(k), tolerance);
    done = k;
  }
}

TEST(Deferred, KeepsItsPromiseOverScatteredFractures) {
  const Board board(test::pulled_board());
  follow(board, test::scattered_sequence(board.problem, 200), test::kIntactTolerance);
}

TEST(Deferred, KeepsItsPromiseAlongACrack) {
  const Board board(test::pulled_board());
  follow(board, test::crack_sequence(board.problem, 200, 8), test::kCrackTolerance);
}

TEST(Deferred, KeepsItsPromiseAlongACrackWithGrips) {
  Scene scene = test::pulled_board();
  scene.instruments[0].action = Grip{test::lower_right_corner(), Vec3::Constant(0.25), Axes{7}};
  const Board board(std::move(scene));
  follow(board, test::crack_sequence(board.problem, 200, 8), test::kCrackTolerance);
}

TEST(Deferred, KeepsTheAttachedPartRightAfterACut) {
  Scene scene = test::pulled_board();
  const Board board(std::move(scene));
  const std::vector<Index> cut = test::elements_across(board.problem.mesh(), 26.5);
  std::vector<Engine> all = engines(board, {1, cut.size()});
  for (Engine& engine : all) destroy_up_to(engine, cut, 0, cut.size());
  compare(board, all, cut, test::kCutTolerance);
}

Board gripped_board() {
  Scene scene = test::pulled_board();
  scene.instruments[0].action = Grip{test::lower_right_corner(), Vec3::Constant(0.25), Axes{7}};
  return Board(std::move(scene));
}

/// Unknowns of some elements, of the load and of the grips.
std::vector<Index> unknowns_of(const Board& board, std::span<const Index> elements) {
  std::set<Index> dofs(board.dofs.begin(), board.dofs.end());
  dofs.insert(board.problem.gripped_dofs().begin(), board.problem.gripped_dofs().end());
  for (Index e : elements) {
    for (Index n : board.problem.mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) dofs.insert(board.problem.dof(n, axis));
    }
  }
  dofs.erase(kNone);
  return {dofs.begin(), dofs.end()};
}

/// A base, of the intact body or of one that has lost some elements: what a rebase makes.
struct OnBase {
  OnBase(const Board& board, const std::string& name, std::span<const Index> all,
         std::span<const Index> lost)
      : factor(std::make_shared<linear_algebra::Factor>(fem::assemble_lower(
            board.problem, name == "condensed" ? Scale{} : scale(board, lost)))),
        deferred(board.problem, base(board, name, all, lost)) {}

  std::shared_ptr<const linear_algebra::Factor> factor;
  Deferred deferred;

 private:
  using Scale = std::vector<double>;
  static Scale scale(const Board& board, std::span<const Index> lost) {
    Scale scale(board.problem.mesh().tets.size(), 1.0);
    for (Index e : lost) scale[e] = board.problem.scene().fracture.alpha;
    return scale;
  }

  [[nodiscard]] std::unique_ptr<Base> base(const Board& board, const std::string& name,
                                           std::span<const Index> all,
                                           std::span<const Index> lost) const {
    if (name == "inverse") return std::make_unique<InverseBase>(*factor);
    if (name == "factor") return std::make_unique<FactorBase>(*factor);
    const std::vector<Index> dofs = unknowns_of(board, all);
    auto first = std::make_unique<CondensedBase>(factor, dofs);
    if (lost.empty()) return first;
    const CondensedBase& condensed = *first;
    Deferred before(board.problem, std::move(first));
    for (const Index& e : lost) EXPECT_TRUE(before.destroy({&e, 1}));
    CondensedState state;
    condensed.copy_state(state);
    DamageMatrices damage;
    before.copy_damage(damage);
    return std::make_unique<CondensedBase>(state, updated_inverse(state, damage, board.dofs),
                                           std::make_shared<LostStiffness>(board.problem, lost));
  }
};

/// Destroys elements, ten between two solutions, and takes them back again.
void expect_the_way_back(const Board& board, Deferred& deferred, std::span<const Index> elements,
                         std::size_t batch, bool remembered) {
  const std::vector<double> grips(board.problem.gripped_dofs().size(), 0.25);
  const auto solution = [&] {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(board.problem.dof_count());
    deferred.solve({board.dofs, board.values}, grips, u);
    return u;
  };
  std::vector<Eigen::VectorXd> solutions{solution()};
  for (std::size_t k = 0; k < elements.size(); k += batch) {
    ASSERT_TRUE(deferred.destroy(elements.subspan(k, batch)));
    if (remembered) deferred.remember();
    if ((k + batch) % 10 == 0) solutions.push_back(solution());
  }
  EXPECT_NE(solutions.front(), solutions.back());
  for (std::size_t k = solutions.size() - 1; k-- > 0;) {
    for (std::size_t i = 0; i < 10 / batch; ++i) deferred.take_back();
    EXPECT_EQ(solution(), solutions[k]) << "back to element " << 10 * k;
  }
  EXPECT_THROW(deferred.take_back(), UsageError);
}

TEST(Deferred, TakesEventsBackBitByBit) {
  const Board board = gripped_board();
  const std::vector<Index> crack = test::crack_sequence(board.problem, 60, 8);
  for (const char* name : {"inverse", "factor", "condensed"}) {
    for (std::size_t batch : {std::size_t{1}, std::size_t{10}}) {
      for (const bool remembered : {false, true}) {
        SCOPED_TRACE(name + (" in batches of " + std::to_string(batch)));
        OnBase based(board, name, crack, {});
        expect_the_way_back(board, based.deferred, crack, batch, remembered);
      }
    }
  }
}

TEST(Deferred, TakesEventsBackToANewBaseBitByBit) {
  const Board board = gripped_board();
  const std::vector<Index> crack = test::crack_sequence(board.problem, 100, 8);
  for (const char* name : {"inverse", "factor", "condensed"}) {
    SCOPED_TRACE(name);
    OnBase based(board, name, crack, std::span(crack).first(40));
    expect_the_way_back(board, based.deferred, std::span(crack).subspan(40), 1, false);
  }
}

TEST(Deferred, HasNothingToTakeBackAtTheStart) {
  const Board board(test::pulled_board());
  Deferred deferred(board.problem, board.base("factor"));
  EXPECT_THROW(deferred.take_back(), UsageError);
}

}  // namespace
}  // namespace sunder::solver
