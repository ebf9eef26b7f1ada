// SPDX-License-Identifier: Apache-2.0
// The signed update of pooled volume along fractures, against a fresh factor of the damaged body.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solver/deferred.hpp"
#include "solver/factor_base.hpp"
#include "solver/inverse_base.hpp"
#include "support/accuracy.hpp"
#include "support/pooled_body.hpp"
#include "support/sequences.hpp"

namespace sunder::solver {
namespace {

/// A board pulled at a corner, with the body that keeps its record.
struct PooledBoard {
  explicit PooledBoard(double nu)
      : problem(std::make_shared<const Problem>(test::pooled_board(nu))),
        body(problem),
        factor(fem::factor_stiffness(*problem)) {
    for (Index n : problem->instrument_nodes()[0].nodes) {
      dofs.push_back(problem->dof(n, 1));
      values.push_back(-30);
    }
  }

  [[nodiscard]] std::unique_ptr<Base> base(bool dense) const {
    if (dense) return std::make_unique<InverseBase>(factor);
    return std::make_unique<FactorBase>(factor);
  }

  /// By forces at all nodes [N].
  void load(std::vector<double> forces) {
    dofs.clear();
    values.clear();
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const Index dof = problem->dofs()[i];
      if (forces[i] == 0 || dof == kNone) continue;
      dofs.push_back(dof);
      values.push_back(forces[i]);
    }
    force = std::move(forces);
  }

  [[nodiscard]] std::vector<double> nodal(const Eigen::VectorXd& u) const {
    std::vector<double> all(problem->dofs().size());
    fem::scatter(*problem, {u.data(), static_cast<std::size_t>(u.size())}, all);
    return all;
  }

  std::shared_ptr<const Problem> problem;
  fem::DamagedBody body;
  linear_algebra::Factor factor;
  std::vector<Index> dofs;
  std::vector<double> values, force;
};

Eigen::VectorXd solution(const PooledBoard& board, Deferred& deferred) {
  Eigen::VectorXd u;
  deferred.solve({board.dofs, board.values}, {}, u);
  return u;
}

/// Events of one element up to the tenth, then of five.
void follow_fresh_factors(double nu, bool crack, double tolerance) {
  PooledBoard board(nu);
  const std::vector<Index> sequence = crack ? test::crack_sequence(*board.problem, 50, 12)
                                            : test::scattered_sequence(*board.problem, 50);
  SCOPED_TRACE("nu " + std::to_string(nu));
  Deferred dense(*board.problem, board.base(true)), sparse(*board.problem, board.base(false));
  std::size_t done = 0;
  for (std::size_t k : {std::size_t{1}, std::size_t{10}, std::size_t{50}}) {
    while (done < k) {
      const std::size_t size = done < 10 ? 1 : 5;
      const auto event = std::span(sequence).subspan(done, size);
      ASSERT_TRUE(dense.destroy(event)) << done;
      ASSERT_TRUE(sparse.destroy(event)) << done;
      board.body.destroy(event);
      done += size;
    }
    const test::FreshSolution right(board.body, test::pull_at_corner(*board.problem));
    const std::vector<std::uint8_t> ignored = test::not_attached(board.body);
    for (Deferred* deferred : {&dense, &sparse}) {
      SCOPED_TRACE((deferred == &dense ? "inverse after " : "factor after ") + std::to_string(k));
      const std::vector<double> u = board.nodal(solution(board, *deferred));
      const double of_u =
          test::displacement_error(board.problem->mesh(), ignored, u, right.displacement);
      const double of_stress =
          test::stress_error(ignored, test::pooled_stress(board.body, u), right.stress);
      EXPECT_LE(of_u, tolerance);
      EXPECT_LE(of_stress, tolerance);
    }
  }
}

// Fifty fractures by one update: of more, or where rounding asks for it, a route makes a new base
// (tests/cpu_reference/frames/pooled_test.cpp follows those). Nothing is refined here, and at nu
// .499 the base itself is that far off before anything breaks.
TEST(PooledUpdate, AlongACrackAgreesWithAFreshFactor) {
  follow_fresh_factors(0.4, true, test::kIntactTolerance);
}

TEST(PooledUpdate, ScatteredAgreesWithAFreshFactor) {
  follow_fresh_factors(0.4, false, test::kIntactTolerance);
  follow_fresh_factors(0.499, false, test::kCrackTolerance);
}

TEST(PooledUpdate, TakenBackIsAsBeforeBitByBit) {
  PooledBoard board(0.499);
  const std::vector<Index> sequence = test::crack_sequence(*board.problem, 30, 12);
  Deferred deferred(*board.problem, board.base(false));
  std::vector<Eigen::VectorXd> after{solution(board, deferred)};
  for (std::size_t k = 0; k < 30; k += 3) {
    ASSERT_TRUE(deferred.destroy(std::span(sequence).subspan(k, 3)));
    after.push_back(solution(board, deferred));
    deferred.remember();
  }
  while (after.size() > 1) {
    after.pop_back();
    deferred.take_back();
    EXPECT_EQ(solution(board, deferred), after.back()) << after.size() - 1 << " events";
  }
}

/// Elements that come back give their patch the pressure back that it had.
TEST(PooledUpdate, ElementsThatComeBackRestoreTheirPatch) {
  PooledBoard board(0.499);
  const std::vector<Index> sequence = test::crack_sequence(*board.problem, 20, 12);
  Deferred deferred(*board.problem, board.base(false));
  const Eigen::VectorXd intact = solution(board, deferred);
  ASSERT_TRUE(deferred.destroy(std::span(sequence).first(10)));
  ASSERT_TRUE(deferred.destroy(std::span(sequence).subspan(10)));
  for (std::size_t event : {std::size_t{0}, std::size_t{1}}) {  // the first one first
    const fem::Change back = fem::reverse(*board.problem, deferred.damage(), event);
    ASSERT_TRUE(deferred.change(back));
    if (event == 1) break;
    board.body.destroy(std::span(sequence).subspan(10));
    const test::FreshSolution right(board.body, test::pull_at_corner(*board.problem));
    const std::vector<double> u = board.nodal(solution(board, deferred));
    std::vector<std::uint8_t> none(board.problem->mesh().tets.size(), 0);
    EXPECT_LE(test::displacement_error(board.problem->mesh(), none, u, right.displacement), 1e-8);
  }
  const Eigen::VectorXd again = solution(board, deferred);
  EXPECT_LE((again - intact).norm(), 1e-9 * intact.norm());
}

/// Where nothing of a loose piece is left either.
std::vector<double> without_the_piece(PooledBoard& board) {
  const std::vector<std::uint8_t> loose = test::not_attached(board.body);
  std::vector<Index> piece;
  for (Index e = 0; e < board.problem->tet_count(); ++e) {
    const auto at = static_cast<std::size_t>(e);
    if (loose[at] && !board.body.destroyed()[at]) piece.push_back(e);
  }
  EXPECT_FALSE(piece.empty());
  board.body.destroy(piece);
  return test::FreshSolution(board.body, board.force).displacement;
}

// A piece that comes off takes its elements out of the patches that it shared, those that the
// event before had cut through included: what is left is as if the piece had never been.
TEST(PooledUpdate, APieceThatComesOffSharesNoPressure) {
  PooledBoard board(0.4);
  const test::CutAcross cut(*board.problem, 33);
  fem::DamagedBody torn(board.problem);
  torn.destroy(cut.elements);
  board.load(test::inflate_beside(cut, torn));
  Deferred dense(*board.problem, board.base(true)), sparse(*board.problem, board.base(false));
  const std::size_t half = cut.elements.size() / 2;
  std::vector<std::vector<Eigen::VectorXd>> before(2);
  for (const auto event :
       {std::span(cut.elements).first(half), std::span(cut.elements).subspan(half)}) {
    EXPECT_EQ(board.body.forms().pools(), board.problem->pools());
    before[0].push_back(solution(board, dense));
    before[1].push_back(solution(board, sparse));
    ASSERT_TRUE(dense.destroy(event));
    ASSERT_TRUE(sparse.destroy(event));
    board.body.destroy(event);
  }
  EXPECT_GE(board.body.forms().pools()->count(), board.problem->pools()->count() + cut.shared);
  const std::vector<std::uint8_t> ignored = test::not_attached(board.body);
  const test::FreshSolution right(board.body, board.force);
  const std::vector<double> alone = without_the_piece(board);
  const auto apart = [&](std::span<const double> u, std::span<const double> from) {
    return test::displacement_error(board.problem->mesh(), ignored, u, from);
  };
  for (Deferred* deferred : {&dense, &sparse}) {
    const std::vector<double> u = board.nodal(solution(board, *deferred));
    EXPECT_LE(apart(u, right.displacement), test::kCrackTolerance);
    EXPECT_LE(apart(u, alone), 100 * board.problem->scene().fracture.alpha);
  }
  for (std::size_t event : {std::size_t{1}, std::size_t{0}}) {
    dense.take_back();
    sparse.take_back();
    EXPECT_EQ(solution(board, dense), before[0][event]);
    EXPECT_EQ(solution(board, sparse), before[1][event]);
  }
}

}  // namespace
}  // namespace sunder::solver
