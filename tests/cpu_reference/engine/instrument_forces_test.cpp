// SPDX-License-Identifier: Apache-2.0
// Instruments ask for their forces at any time while frames tear the body.
#include "sunder/instrument_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sunder/error.hpp"
#include "support/body.hpp"
#include "support/haptic_reader.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

Scene gripped_board(Route route) {
  Scene scene = pulled_board();
  scene.instruments[0].action = Grip{lower_right_corner(), Vec3::Constant(0.25), Axes{7}};
  scene.solver.route = route;
  return scene;
}

TEST(InstrumentForces, AreTheReactionsOfTheFrame) {
  for (Route route : {Route::inverse, Route::factor}) {
    const Body body(gripped_board(route));
    const auto instruments = body.backend->instrument_forces();
    ASSERT_TRUE(instruments);
    const std::size_t grips = body.problem->gripped_dofs().size();
    std::vector<double> held(grips, 0.25), forces(grips, -1);
    EXPECT_FALSE(instruments->forces(held, forces)) << "before the first frame";
    EXPECT_EQ(forces, std::vector<double>(grips, 0.0));
    const std::vector<double> none(body.problem->dofs().size(), 0.0);
    for (Index e : crack_sequence(*body.problem, 12, 8)) {
      body.backend->destroy({&e, 1});
      body.load(none, held);
      body.backend->solve();
      ASSERT_TRUE(instruments->forces(held, forces));
      const auto reactions = body.reactions();
      double largest = 0;
      for (double r : reactions) largest = std::max(largest, std::abs(r));
      for (std::size_t g = 0; g < grips; ++g) {
        EXPECT_NEAR(forces[g], reactions[g], 1e-8 * largest) << g;
      }
    }
    // Elsewhere: what a frame with that displacement says.
    std::vector<double> moved(grips);
    for (std::size_t g = 0; g < grips; ++g) moved[g] = 0.1 * static_cast<double>(g % 3);
    ASSERT_TRUE(instruments->forces(moved, forces));
    body.load(none, moved);
    body.backend->solve();
    const auto reactions = body.reactions();
    double largest = 0;
    for (double r : reactions) largest = std::max(largest, std::abs(r));
    for (std::size_t g = 0; g < grips; ++g) {
      EXPECT_NEAR(forces[g], reactions[g], 1e-7 * largest) << g;
    }
  }
}

TEST(InstrumentForces, RefuseWhatIsNotFinite) {
  InstrumentForces instruments(std::vector<double>{0, 0});
  const Eigen::MatrixXd l = Eigen::MatrixXd::Identity(2, 2);
  std::vector<double> forces(2);
  instruments.publish(l * std::nan(""), Eigen::VectorXd::Zero(2));
  EXPECT_EQ(instruments.frames(), 0u);
  instruments.publish(l, Eigen::VectorXd::Zero(2));
  EXPECT_FALSE(instruments.forces(std::vector<double>{1, std::nan("")}, forces));
  EXPECT_EQ(forces, (std::vector<double>{0, 0}));
  EXPECT_TRUE(instruments.forces(std::vector<double>{1, 2}, forces));
  EXPECT_EQ(forces, (std::vector<double>{1, 2}));
  EXPECT_THROW(instruments.forces(std::vector<double>{1}, forces), UsageError);
}

// The figures are printed by the benchmark; here: every answer is one frame's, whole and finite.
TEST(InstrumentForces, AnswerAnotherThreadWhileFramesTear) {
  const Body body(gripped_board(Route::inverse));
  const auto instruments = body.backend->instrument_forces();
  const std::vector<double> none(body.problem->dofs().size(), 0.0),
      held(body.problem->gripped_dofs().size(), 0.25);
  HapticReader reader(*instruments, held);
  Pulls frames;
  for (Index e : crack_sequence(*body.problem, 60, 8)) {
    body.backend->destroy({&e, 1});
    body.load(none, held);
    body.backend->solve();
    frames.add(body.reactions());
  }
  const Pulls answers = reader.end();
  EXPECT_EQ(answers.bad, 0);
  EXPECT_GE(answers.least, frames.least * (1 - 1e-7));
  EXPECT_LE(answers.most, frames.most * (1 + 1e-7));
}

}  // namespace
}  // namespace sunder::test
