// SPDX-License-Identifier: Apache-2.0
// Forces of the grips between frames, asked for on a thread of their own. The thread sanitizer runs
// these tests too.
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

/// The board, held by a grip at its lower left corner as well: instrument 1.
sunder_simulation gripped_board(std::int32_t steps = 4) {
  const sunder_scene scene = board_scene();
  sunder_instrument grip = corner_pull();
  grip.kind = SUNDER_DISPLACEMENT;
  grip.nodes = box(-0.01, -0.01, 0.01, 0.01);
  grip.axes = SUNDER_AXIS_X | SUNDER_AXIS_Y;
  grip.value[1] = -0.1;
  EXPECT_OK(sunder_scene_add_instrument(scene, &grip, nullptr));
  EXPECT_OK(sunder_scene_set_steps(scene, steps));
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  return simulation;
}

TEST(CGrips, GiveTheReactionsOfTheStep) {
  const sunder_simulation simulation = gripped_board();
  sunder_grips grips = nullptr;
  ASSERT_OK(sunder_grips_create(simulation, &grips));
  const std::vector<double> held{0, 0, 0, 0, -0.1, 0};
  std::vector<double> forces(6, 1), reactions(6);
  EXPECT_EQ(sunder_grips_forces(grips, held.data(), forces.data(), 6), SUNDER_ERROR_ORDER);
  EXPECT_EQ(forces, std::vector<double>(6, 0.0));
  for (int i = 0; i < 4; ++i) {
    ASSERT_OK(sunder_simulation_step(simulation, nullptr));
    ASSERT_OK(sunder_grips_forces(grips, held.data(), forces.data(), 6));
    ASSERT_OK(sunder_simulation_reactions(simulation, reactions.data(), 6));
    for (int a = 0; a < 3; ++a) {
      EXPECT_EQ(forces[static_cast<std::size_t>(a)], 0) << "instrument 0 is no grip";
      EXPECT_NEAR(forces[static_cast<std::size_t>(3 + a)],
                  reactions[static_cast<std::size_t>(3 + a)], 1e-8 * std::abs(reactions[4]));
    }
  }
  std::int32_t torn = 0;
  ASSERT_OK(sunder_simulation_event_count(simulation, &torn));
  EXPECT_GT(torn, 0);
  EXPECT_OK(sunder_simulation_destroy(simulation));
  EXPECT_OK(sunder_grips_destroy(grips));
}

TEST(CGrips, SayThatTheirSimulationIsGone) {
  const std::vector<double> held{0, 0, 0, 0, -0.1, 0};
  for (const int steps : {0, 1}) {
    const sunder_simulation simulation = gripped_board();
    sunder_grips grips = nullptr;
    ASSERT_OK(sunder_grips_create(simulation, &grips));
    for (int i = 0; i < steps; ++i) ASSERT_OK(sunder_simulation_step(simulation, nullptr));
    ASSERT_OK(sunder_simulation_destroy(simulation));
    std::vector<double> forces(6, 1);
    EXPECT_EQ(sunder_grips_forces(grips, held.data(), forces.data(), 6), SUNDER_ERROR_HANDLE);
    EXPECT_STREQ(sunder_last_error(), "the simulation of these grips was destroyed");
    EXPECT_EQ(forces, std::vector<double>(6, 0.0));
    EXPECT_OK(sunder_grips_destroy(grips));
    EXPECT_EQ(sunder_grips_destroy(grips), SUNDER_ERROR_HANDLE);
  }
}

TEST(CGrips, MayFillTheArrayOfTheirDisplacements) {
  const sunder_simulation simulation = gripped_board();
  sunder_grips grips = nullptr;
  ASSERT_OK(sunder_grips_create(simulation, &grips));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  std::vector<double> both{0, 0, 0, 0, -0.1, 0}, forces(6);
  ASSERT_OK(sunder_grips_forces(grips, both.data(), forces.data(), 6));
  ASSERT_OK(sunder_grips_forces(grips, both.data(), both.data(), 6));
  EXPECT_EQ(both, forces);
  EXPECT_OK(sunder_grips_destroy(grips));
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST(CGrips, RefuseWhatDoesNotFit) {
  const sunder_simulation without = board_simulation(), simulation = gripped_board();
  sunder_grips grips = nullptr, second = nullptr;
  EXPECT_EQ(sunder_grips_create(without, &grips), SUNDER_ERROR_ORDER);
  ASSERT_OK(sunder_grips_create(simulation, &grips));
  EXPECT_EQ(sunder_grips_create(simulation, &second), SUNDER_ERROR_ORDER) << "one at a time";
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  std::vector<double> values(6, 0.1), forces(6, 1);
  EXPECT_EQ(sunder_grips_forces(grips, values.data(), forces.data(), 5), SUNDER_ERROR_SIZE);
  EXPECT_EQ(sunder_grips_forces(grips, nullptr, forces.data(), 6), SUNDER_ERROR_NULL);
  EXPECT_EQ(sunder_grips_forces(grips, values.data(), nullptr, 6), SUNDER_ERROR_NULL);
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    values[3] = bad;
    forces.assign(6, 1);
    EXPECT_EQ(sunder_grips_forces(grips, values.data(), forces.data(), 6), SUNDER_ERROR_VALUE);
    EXPECT_EQ(forces, std::vector<double>(6, 0.0));
  }
  values[3] = 0.1;
  for (const std::size_t not_read : {0u, 1u, 2u, 5u}) values[not_read] = HUGE_VAL;
  EXPECT_OK(sunder_grips_forces(grips, values.data(), forces.data(), 6));
  EXPECT_OK(sunder_grips_destroy(grips));
  EXPECT_OK(sunder_grips_create(simulation, &second)) << "the first one is gone";
  EXPECT_OK(sunder_grips_destroy(second));
  EXPECT_OK(sunder_simulation_destroy(simulation));
  EXPECT_OK(sunder_simulation_destroy(without));
}

TEST(CGrips, KnowNoForceBeforeTheFirstStepWhateverTheDisplacement) {
  const sunder_simulation simulation = gripped_board();
  sunder_grips grips = nullptr;
  ASSERT_OK(sunder_grips_create(simulation, &grips));
  std::vector<double> values(6, 1e308), forces(6, 1);
  EXPECT_EQ(sunder_grips_forces(grips, values.data(), forces.data(), 6), SUNDER_ERROR_ORDER);
  values[0] = HUGE_VAL;  // not read
  EXPECT_EQ(sunder_grips_forces(grips, values.data(), forces.data(), 6), SUNDER_ERROR_ORDER);
  EXPECT_EQ(forces, std::vector<double>(6, 0.0));
  EXPECT_OK(sunder_grips_destroy(grips));
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST(CGrips, GiveNoForceThatOverflows) {
  const sunder_simulation simulation = gripped_board(1000);
  sunder_grips grips = nullptr;
  ASSERT_OK(sunder_grips_create(simulation, &grips));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  constexpr double kLargest = std::numeric_limits<double>::max();
  const std::vector<double> values{0, 0, 0, kLargest, -kLargest, 0};
  std::vector<double> forces(6, 1);
  EXPECT_EQ(sunder_grips_forces(grips, values.data(), forces.data(), 6), SUNDER_ERROR_VALUE);
  EXPECT_NE(std::string(sunder_last_error()).find("overflow"), std::string::npos);
  EXPECT_EQ(forces, std::vector<double>(6, 0.0));
  EXPECT_OK(sunder_grips_destroy(grips));
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

// A haptic thread learns of the end from its own calls, whenever it comes.
TEST(CGrips, AnswerAnotherThreadUntilTheSimulationIsGone) {
  const sunder_simulation simulation = gripped_board();
  sunder_grips grips = nullptr;
  ASSERT_OK(sunder_grips_create(simulation, &grips));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  std::atomic<bool> destroyed{false}, answered{false};
  bool late = false;
  sunder_status last = SUNDER_OK;
  std::thread haptics([&] {
    const std::vector<double> held{0, 0, 0, 0, -0.1, 0};
    std::vector<double> forces(6);
    while (last == SUNDER_OK) {
      const bool after = destroyed.load();
      last = sunder_grips_forces(grips, held.data(), forces.data(), 6);
      if (after && last == SUNDER_OK) late = true;
      answered = true;
      std::this_thread::yield();
    }
  });
  while (!answered.load()) std::this_thread::yield();
  EXPECT_OK(sunder_simulation_destroy(simulation));
  destroyed = true;
  haptics.join();
  EXPECT_EQ(last, SUNDER_ERROR_HANDLE);
  EXPECT_FALSE(late) << "an answer that began after the simulation was gone";
  EXPECT_OK(sunder_grips_destroy(grips));
}

TEST(CGrips, AnswerAnotherThreadWhileAStepRuns) {
  const sunder_simulation simulation = gripped_board(24);
  sunder_grips grips = nullptr;
  ASSERT_OK(sunder_grips_create(simulation, &grips));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  std::atomic<bool> done{false};
  std::atomic<long> answers{0};
  long failures = 0;
  std::thread haptics([&] {
    const std::vector<double> held{0, 0, 0, 0, -0.1, 0};
    std::vector<double> forces(6);
    while (!done.load()) {
      const sunder_status status = sunder_grips_forces(grips, held.data(), forces.data(), 6);
      bool finite = true;
      for (double f : forces) finite = finite && std::isfinite(f);
      if (status != SUNDER_OK || !finite) ++failures;
      ++answers;
      std::this_thread::yield();
    }
  });
  for (int i = 1; i < 24; ++i) EXPECT_OK(sunder_simulation_step(simulation, nullptr));
  while (answers.load() < 100) std::this_thread::yield();
  done = true;
  haptics.join();
  EXPECT_EQ(failures, 0) << "a step made the other thread's handle busy, or a force was not finite";
  EXPECT_OK(sunder_grips_destroy(grips));
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

}  // namespace
}  // namespace sunder::test
