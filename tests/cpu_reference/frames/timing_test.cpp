// SPDX-License-Identifier: Apache-2.0
// New bases come from another thread. What frames return depends on the events alone: not on
// whether that thread has long been done or has hardly begun.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "rebasing_routes.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

// The thread rests before each of the events that it follows, of which there are at least so many.
constexpr milliseconds kRest(4);
constexpr int kFewestEvents = 48;

/// Everything that a tear of 240 elements returns.
struct TimedTear {
  std::vector<std::vector<double>> displacements, reactions;
  std::vector<Voigt> stress;
  std::vector<double> errors, residuals;
  milliseconds took{0};
  bool new_base = false;

  /// `rest`: of the thread, before each thing that it does; `pause`: after each frame.
  TimedTear(const RebasingRoute& c, milliseconds rest, milliseconds pause) {
    Scene scene = pulled_board();
    scene.solver.route = c.route;
    if (c.grips) {
      scene.instruments[0].action = Grip{lower_right_corner(), Vec3::Constant(0.25), Axes{7}};
    }
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    const auto backend = cpu_reference::create(problem, all_needs(), {.rest = rest});
    backend->set_load(load_of(*problem,
                              c.grips ? std::vector<double>(problem->dofs().size(), 0.0)
                                      : corner_force(problem->mesh(), Vec3(0, -3, 0)),
                              std::vector<double>(problem->gripped_dofs().size(), 0.25)));
    const auto start = Clock::now();
    for (const Index& e : crack_sequence(*problem, 240, 8)) {
      backend->destroy({&e, 1});
      const SolveReport report = backend->solve();
      errors.push_back(report.error);
      residuals.push_back(report.residual);
      backend->read_displacement(displacements.emplace_back(problem->dofs().size()));
      backend->read_reactions(reactions.emplace_back(problem->gripped_dofs().size()));
      std::this_thread::sleep_for(pause);
    }
    took = std::chrono::duration_cast<milliseconds>(Clock::now() - start);
    backend->stress();
    stress.resize(problem->mesh().tets.size());
    backend->read_stress(stress);
    for (const BufferPlan& b : backend->buffers()) {
      new_base =
          new_base || b.name.starts_with("damaged factor") || b.name.starts_with("stiffness lost");
    }
  }
};

void expect_same(const TimedTear& a, const TimedTear& b) {
  ASSERT_EQ(a.displacements.size(), b.displacements.size());
  for (std::size_t i = 0; i < a.displacements.size(); ++i) {
    ASSERT_EQ(a.displacements[i], b.displacements[i]) << "frame " << i;
    ASSERT_EQ(a.reactions[i], b.reactions[i]) << "frame " << i;
    ASSERT_EQ(a.errors[i], b.errors[i]) << "frame " << i;
    ASSERT_EQ(a.residuals[i], b.residuals[i]) << "frame " << i;
  }
  EXPECT_EQ(a.stress, b.stress);
}

class Timing : public ::testing::TestWithParam<RebasingRoute> {};

TEST_P(Timing, ChangesNoBit) {
  const TimedTear as_it_comes(GetParam(), milliseconds(0), milliseconds(0));
  const TimedTear rushed(GetParam(), milliseconds(0), milliseconds(2));
  const TimedTear delayed(GetParam(), kRest, milliseconds(0));
  EXPECT_TRUE(as_it_comes.new_base && rushed.new_base && delayed.new_base);
  EXPECT_GE(delayed.took, kFewestEvents * kRest) << "a frame waits for the base that it is to have";
  for (double error : as_it_comes.errors) EXPECT_LE(error, kCrackTolerance);
  expect_same(as_it_comes, rushed);
  expect_same(as_it_comes, delayed);
}

INSTANTIATE_TEST_SUITE_P(Tears, Timing, rebasing_routes(), name_of);

}  // namespace
}  // namespace sunder::test
