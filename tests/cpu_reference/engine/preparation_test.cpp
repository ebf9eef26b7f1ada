// SPDX-License-Identifier: Apache-2.0
// Predicted fractures, prepared in quiet frames: they are met, and no bit depends on them.
#include <gtest/gtest.h>

#include "engine/deferred.hpp"
#include "engine/factor_base.hpp"
#include "fem/assembly.hpp"
#include "support/sequences.hpp"
#include "support/torn_board.hpp"

namespace sunder::test {
namespace {

TornBoard tear(FractureModel model, Route route, bool prepare) {
  SolverOptions solver;
  solver.route = route;
  solver.prepare = prepare;
  return torn_board(model, solver, 60);
}

class Preparation : public ::testing::TestWithParam<FractureModel> {};

TEST_P(Preparation, ChangesNoBit) {
  const TornBoard with = tear(GetParam(), Route::factor, true);
  const TornBoard without = tear(GetParam(), Route::factor, false);
  ASSERT_EQ(with.elements.size(), without.elements.size());
  for (std::size_t i = 0; i < with.elements.size(); ++i) {
    ASSERT_EQ(with.elements[i].element, without.elements[i].element) << "fracture " << i;
    ASSERT_EQ(with.elements[i].ratio, without.elements[i].ratio) << "fracture " << i;
  }
  EXPECT_EQ(with.displacement, without.displacement);
  EXPECT_EQ(with.stress, without.stress);
  EXPECT_EQ(without.preparation.destroyed, 0);
  EXPECT_GT(with.preparation.predicted, 0);
  EXPECT_LE(with.preparation.predicted, with.preparation.destroyed);
  EXPECT_GT(with.preparation.saved_ms, 0);
}

INSTANTIATE_TEST_SUITE_P(Models, Preparation, ::testing::Values(FractureModel::a, FractureModel::b),
                         [](const auto& p) { return p.param == FractureModel::a ? "A" : "B"; });

TEST(PreparationOfADenseInverse, IsNotOffered) {
  const TornBoard torn = tear(FractureModel::b, Route::inverse, true);
  EXPECT_EQ(torn.preparation.destroyed, 0) << "its columns are at hand anyway";
}

// Some of an event's columns are prepared, some are not, in groups of more than 32.
TEST(PreparedColumns, MixWithOthersInAnEvent) {
  const Problem problem(notch_board(FractureModel::a));
  const fem::Factor factor(fem::assemble_lower(problem, {}));
  engine::Deferred plain(problem, std::make_unique<engine::FactorBase>(factor));
  engine::Deferred prepared(problem, std::make_unique<engine::FactorBase>(factor));
  const auto sequence = crack_sequence(problem, 60, 8);
  const std::vector<Index> dofs{problem.dof(problem.instrument_nodes()[0].nodes[0], 1)};
  const std::vector<double> values{-30};
  Eigen::VectorXd u, v;
  for (std::size_t i = 0; i < 60; i += 12) {
    const auto event = std::span(sequence).subspan(i, 12);
    const std::vector<Index> guess{event[1], event[2], event[7], sequence[59]};
    prepared.prepare(guess);
    prepared.prepare(guess);  // what is there stays
    ASSERT_TRUE(plain.destroy(event));
    ASSERT_TRUE(prepared.destroy(event));
    plain.solve({dofs, values}, {}, u);
    prepared.solve({dofs, values}, {}, v);
    EXPECT_EQ(u, v) << i;
    EXPECT_GT(prepared.saved_ms(), 0);
    EXPECT_EQ(plain.saved_ms(), 0);
  }
}

}  // namespace
}  // namespace sunder::test
