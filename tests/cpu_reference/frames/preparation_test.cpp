// SPDX-License-Identifier: Apache-2.0
// Predicted fractures, prepared in quiet frames: they are met, and no bit depends on them.
#include <gtest/gtest.h>

#include "body/assembly.hpp"
#include "solver/deferred.hpp"
#include "solver/factor_base.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/torn_board.hpp"

namespace sunder::test {
namespace {

TornBoard tear(FractureModel model, Route route, bool prepare) {
  SolverOptions solver;
  solver.route = route;
  solver.prepare = prepare;
  return torn_board(model, solver, 200);
}

struct Simulated {
  const char* name;
  FractureModel model;
  Route route;
};

class Preparation : public ::testing::TestWithParam<Simulated> {};

// The simulation predicts by itself, and not always right.
TEST_P(Preparation, ChangesNoBit) {
  const auto& [name, model, route] = GetParam();
  const TornBoard with = tear(model, route, true);
  const TornBoard without = tear(model, route, false);
  ASSERT_EQ(with.elements.size(), without.elements.size());
  for (std::size_t i = 0; i < with.elements.size(); ++i) {
    ASSERT_EQ(with.elements[i].element, without.elements[i].element) << "fracture " << i;
    ASSERT_EQ(with.elements[i].ratio, without.elements[i].ratio) << "fracture " << i;
  }
  EXPECT_EQ(with.displacement, without.displacement);
  EXPECT_EQ(with.stress, without.stress);
  EXPECT_EQ(without.preparation.destroyed, 0);
  if (route == Route::factor) {
    EXPECT_GT(with.preparation.predicted, 0);
    EXPECT_LT(with.preparation.predicted, with.preparation.destroyed);
    EXPECT_GT(with.preparation.saved_ms, 0);
  } else {
    EXPECT_LE(with.preparation.predicted, with.preparation.destroyed);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, Preparation,
    ::testing::Values(Simulated{"FactorA", FractureModel::a, Route::factor},
                      Simulated{"FactorB", FractureModel::b, Route::factor},
                      Simulated{"InverseA", FractureModel::a, Route::inverse},
                      Simulated{"InverseB", FractureModel::b, Route::inverse},
                      Simulated{"CondensedA", FractureModel::a, Route::condensed},
                      Simulated{"CondensedB", FractureModel::b, Route::condensed}),
    [](const auto& p) { return p.param.name; });

/// Displacements of a cascade of 240 elements, over a new base, two of three predicted right among
/// others that never break or break later.
struct Cascade {
  Cascade(Route route, bool prepare) {
    Scene scene = pulled_board();
    scene.solver.route = route;
    const Body body(std::move(scene));
    body.load(corner_force(body.problem->mesh(), Vec3(0, -3, 0)));
    const auto sequence = crack_sequence(*body.problem, 260, 8);
    for (std::size_t i = 0; i < 240; ++i) {
      if (prepare) {
        body.backend->prepare(
            std::vector<Index>{sequence[i % 3 == 0 ? i + 7 : i], sequence[i + 15],
                               static_cast<Index>(i % 2 == 0 ? sequence[259] : sequence[i / 2])});
      }
      body.backend->destroy({&sequence[i], 1});
      EXPECT_LE(body.backend->solve().error, kCrackTolerance);
      displacements.push_back(body.displacement());
    }
    preparation = body.backend->preparation();
    for (const BufferPlan& b : body.backend->buffers()) {
      new_base =
          new_base || b.name.starts_with("damaged factor") || b.name.starts_with("stiffness lost");
    }
  }
  std::vector<std::vector<double>> displacements;
  PreparationReport preparation;
  bool new_base = false;
};

class PreparedCascade : public ::testing::TestWithParam<Route> {};

TEST_P(PreparedCascade, KeepsItsBitsWherePredictionsArePartlyWrong) {
  const Cascade with(GetParam(), true), without(GetParam(), false);
  EXPECT_TRUE(with.new_base && without.new_base);
  ASSERT_EQ(with.displacements.size(), without.displacements.size());
  for (std::size_t i = 0; i < with.displacements.size(); ++i) {
    ASSERT_EQ(with.displacements[i], without.displacements[i]) << "fracture " << i;
  }
  EXPECT_EQ(without.preparation.destroyed, 0);
  if (GetParam() == Route::factor) {
    EXPECT_EQ(with.preparation.destroyed, 240);
    EXPECT_EQ(with.preparation.predicted, 160);
    EXPECT_GT(with.preparation.saved_ms, 0);
  } else if (GetParam() == Route::inverse) {  // once a factor has taken the inverse's place
    EXPECT_GT(with.preparation.predicted, 0);
    EXPECT_LT(with.preparation.predicted, with.preparation.destroyed);
  } else {
    EXPECT_EQ(with.preparation.destroyed, 0) << "its columns are at hand anyway";
  }
}

INSTANTIATE_TEST_SUITE_P(Routes, PreparedCascade,
                         ::testing::Values(Route::factor, Route::inverse, Route::condensed),
                         [](const auto& p) {
                           return p.param == Route::factor    ? "Factor"
                                  : p.param == Route::inverse ? "Inverse"
                                                              : "Condensed";
                         });

TEST(PreparationOfADenseInverse, IsNotOffered) {
  const Body body(notch_board(FractureModel::b));
  EXPECT_EQ(body.backend->info().route, "inverse");
  EXPECT_FALSE(body.backend->prepares()) << "its columns are at hand anyway";
}

// Some of an event's columns are prepared, some are not, in groups of more than 32.
TEST(PreparedColumns, MixWithOthersInAnEvent) {
  const Problem problem(notch_board(FractureModel::a));
  const linear_algebra::Factor factor(fem::assemble_lower(problem, {}));
  solver::Deferred plain(problem, std::make_unique<solver::FactorBase>(factor));
  solver::Deferred prepared(problem, std::make_unique<solver::FactorBase>(factor));
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
