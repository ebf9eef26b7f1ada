// SPDX-License-Identifier: Apache-2.0
// Forces of the grips between frames, asked for on a thread of their own. The thread sanitizer runs
// these tests too.
#include <algorithm>
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
  const sunder_simulation simulation = gripped_board();
  sunder_simulation without = nullptr;
  const sunder_scene scene = board_scene();
  const auto none = model(SUNDER_FRACTURE_NONE);  // nothing can be grasped either
  EXPECT_OK(sunder_scene_set_fracture(scene, &none));
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &without));
  EXPECT_OK(sunder_scene_destroy(scene));
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

/// The board with nothing that breaks by itself, grasped at the lower left corner.
struct Grasped {
  sunder_simulation simulation = nullptr;
  sunder_grips grips = nullptr;
  std::int32_t grip = -1;

  Grasped() {
    const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 4, -0.4);
    const auto fracture = model(SUNDER_FRACTURE_NONE);
    EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
    EXPECT_OK(sunder_scene_set_live(scene, 1));
    EXPECT_OK(sunder_scene_set_steps(scene, 1000));
    EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
    EXPECT_OK(sunder_scene_destroy(scene));
    const double force[3] = {0, -0.4, 0};  // in every step, or the next one has another load
    EXPECT_OK(sunder_simulation_drive(simulation, 0, force));
    EXPECT_OK(sunder_simulation_keep_history(simulation, 10));
    EXPECT_OK(sunder_grips_create(simulation, &grips));
    const double corner[3] = {0, 0, 0.5};
    EXPECT_OK(sunder_simulation_grasp_near(simulation, corner, 1, 1, &grip));
  }
  ~Grasped() {
    EXPECT_OK(sunder_simulation_destroy(simulation));
    EXPECT_OK(sunder_grips_destroy(grips));
  }
  [[nodiscard]] sunder_hand hand(double x = 0) const {
    sunder_hand hand = SUNDER_HAND_INIT;
    hand.grip = grip;
    EXPECT_OK(sunder_simulation_grip_place(simulation, grip, hand.position));
    hand.position[0] += x;
    return hand;
  }
};

TEST(CHands, FeelWhatTheNextStepFinds) {
  Grasped g;
  ASSERT_OK(sunder_simulation_step(g.simulation, nullptr));
  sunder_hand hand = g.hand(0.2);
  hand.quaternion[2] = 0.1;
  sunder_felt felt = SUNDER_FELT_INIT;
  ASSERT_OK(sunder_grips_feel(g.grips, nullptr, nullptr, 0, &hand, 1, &felt));
  EXPECT_EQ(felt.state, SUNDER_FELT_LIVE);
  EXPECT_EQ(felt.step, 0);
  EXPECT_GE(felt.solution, 1u);
  EXPECT_GE(felt.age_ms, 0);
  EXPECT_EQ(felt.share, 1);
  EXPECT_EQ(hand.held, 1);
  ASSERT_OK(sunder_simulation_pose(g.simulation, g.grip, hand.position, hand.quaternion));
  ASSERT_OK(sunder_simulation_step(g.simulation, nullptr));
  double force[3], torque[3];
  ASSERT_OK(sunder_simulation_wrench(g.simulation, g.grip, force, torque));
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(hand.force[a], force[a], 1e-7 * std::abs(force[0]));
    EXPECT_NEAR(hand.torque[a], torque[a], 1e-6 * std::abs(force[0]));
  }
}

TEST(CHands, SayWhyThereIsNoForce) {
  Grasped g;
  sunder_hand hand = g.hand();
  sunder_felt felt = SUNDER_FELT_INIT;
  const auto feel = [&] {
    std::fill_n(hand.force, 3, 1.0);
    return sunder_grips_feel(g.grips, nullptr, nullptr, 0, &hand, 1, &felt);
  };
  const auto expect_none = [&](std::int32_t state) {
    EXPECT_EQ(felt.state, state);
    EXPECT_EQ(hand.held, 0);
    for (double f : hand.force) EXPECT_EQ(f, 0);
  };
  EXPECT_EQ(feel(), SUNDER_ERROR_ORDER);
  expect_none(SUNDER_FELT_WAITING);
  std::int32_t mark = 0;
  ASSERT_OK(sunder_simulation_save(g.simulation, &mark));
  ASSERT_OK(sunder_simulation_step(g.simulation, nullptr));
  EXPECT_OK(feel());
  EXPECT_EQ(hand.held, 1);
  ASSERT_OK(sunder_simulation_restore(g.simulation, mark, nullptr));
  EXPECT_EQ(feel(), SUNDER_ERROR_ORDER) << "gone back to before the first step";
  expect_none(SUNDER_FELT_WAITING);
  ASSERT_OK(sunder_simulation_step(g.simulation, nullptr));
  for (double bad : {std::nan(""), HUGE_VAL, std::numeric_limits<double>::max()}) {
    hand.position[1] = bad;
    EXPECT_EQ(feel(), SUNDER_ERROR_VALUE);
    expect_none(SUNDER_FELT_OVERFLOW);
  }
  hand = g.hand();
  std::fill_n(hand.quaternion, 4, 0.0);
  EXPECT_EQ(feel(), SUNDER_ERROR_VALUE);
  hand.quaternion[1] = std::nan("");
  EXPECT_EQ(feel(), SUNDER_ERROR_VALUE);
  hand = g.hand();
  ASSERT_OK(sunder_simulation_release(g.simulation, g.grip));
  EXPECT_OK(feel());
  expect_none(SUNDER_FELT_LIVE);
  hand.grip = -7;
  EXPECT_OK(feel());
  expect_none(SUNDER_FELT_LIVE);
  EXPECT_EQ(sunder_grips_feel(g.grips, nullptr, nullptr, 0, nullptr, 1, &felt), SUNDER_ERROR_NULL);
  double six[6] = {};
  EXPECT_EQ(sunder_grips_feel(g.grips, six, six, 6, nullptr, 0, nullptr), SUNDER_ERROR_SIZE);
  EXPECT_EQ(sunder_grips_feel(g.grips, six, nullptr, 3, nullptr, 0, nullptr), SUNDER_ERROR_NULL);
  EXPECT_OK(sunder_grips_feel(g.grips, six, six, 3, nullptr, 0, nullptr));
  felt.struct_size = 0;
  EXPECT_EQ(feel(), SUNDER_ERROR_STRUCT_SIZE);
  for (double bad : {-1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_EQ(sunder_grips_blend(g.grips, bad), SUNDER_ERROR_VALUE);
  }
  EXPECT_EQ(sunder_grips_blend(nullptr, 1), SUNDER_ERROR_HANDLE);
  EXPECT_EQ(sunder_grips_feel(nullptr, nullptr, nullptr, 0, nullptr, 0, nullptr),
            SUNDER_ERROR_HANDLE);
}

// A haptic thread blends while another grasps, steps, cuts, lets go and goes back.
TEST(CHands, AreFeltWhileTheBodyIsHandled) {
  Grasped g;
  ASSERT_OK(sunder_grips_blend(g.grips, 5));
  ASSERT_OK(sunder_simulation_step(g.simulation, nullptr));
  std::atomic<bool> done{false};
  std::atomic<long> answers{0};
  long failures = 0;
  std::thread haptics([&] {
    while (!done.load()) {
      sunder_hand hands[2] = {SUNDER_HAND_INIT, SUNDER_HAND_INIT};
      hands[0].grip = g.grip;
      hands[1].grip = g.grip + 1;
      sunder_felt felt = SUNDER_FELT_INIT;
      const sunder_status status = sunder_grips_feel(g.grips, nullptr, nullptr, 0, hands, 2, &felt);
      bool finite = status == SUNDER_OK || status == SUNDER_ERROR_ORDER;
      for (double f : hands[0].force) finite = finite && std::isfinite(f);
      if (!finite) ++failures;
      ++answers;
      std::this_thread::yield();
    }
  });
  for (int i = 0; i < 20; ++i) {
    const double corner[3] = {10, 5, 0.5};
    std::int32_t other = 0, mark = 0;
    EXPECT_OK(sunder_simulation_save(g.simulation, &mark));
    EXPECT_OK(sunder_simulation_grasp_near(g.simulation, corner, 2, i % 2, &other));
    EXPECT_OK(sunder_simulation_step(g.simulation, nullptr));
    const std::int32_t element = 30 + i;
    EXPECT_OK(sunder_simulation_remove(g.simulation, &element, 1));
    EXPECT_OK(sunder_simulation_release(g.simulation, other));
    EXPECT_OK(sunder_simulation_step(g.simulation, nullptr));
    if (i % 3 == 0) {
      EXPECT_OK(sunder_simulation_restore(g.simulation, mark, nullptr));
    }
  }
  while (answers.load() < 100) std::this_thread::yield();
  done = true;
  haptics.join();
  EXPECT_EQ(failures, 0);
}

}  // namespace
}  // namespace sunder::test
