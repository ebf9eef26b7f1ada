// SPDX-License-Identifier: Apache-2.0
// Grips of a host by the laws of finite deformation and in motion.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/frame/live_laws.hpp"
#include "core/frame/run_state.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

class GraspLaws : public testing::TestWithParam<LawWay> {};

// A grip of the scene that a host turns goes through the same states as one that it grasped before
// the first step.
TEST_P(GraspLaws, AreThoseOfTheScenesOwn) {
  Scene own = law_strip(GetParam());
  Instrument forceps;
  forceps.name = "left";
  Grip held{std::vector<Index>(kLeft), Vec3::Zero(), Axes{7}};
  held.rigid = true;
  forceps.action = held;
  own.instruments.push_back(forceps);
  LiveRun scene(own), host(law_strip(GetParam()));
  const int grip = host.simulation.grasp(kLeft, true);
  const Vec3 centre = host.simulation.centre_of(grip);
  double most = 0, largest_of_all = 0;
  for (int i = 1; i <= 6; ++i) {
    const Vec3 way = 0.05 * i * Vec3(-1, 0.5, 0.3), turn = 3.0 * i * Vec3(0, 0, 1);
    const Eigen::Quaterniond q(Eigen::AngleAxisd(turn.norm() * EIGEN_PI / 180, turn.normalized()));
    scene.simulation.drive(1, way);
    scene.simulation.turn(1, turn);
    host.simulation.pose(grip, {centre + way, {q.x(), q.y(), q.z(), q.w()}});
    scene.simulation.step();
    host.simulation.step();
    const auto a = scene.simulation.displacement(), b = host.simulation.displacement();
    for (std::size_t n = 0; n < a.size(); ++n) {
      most = std::max(most, (a[n] - b[n]).norm());
      largest_of_all = std::max(largest_of_all, a[n].norm());
    }
    EXPECT_LE((scene.simulation.reactions()[1] - host.simulation.wrench(grip).force).norm(),
              1e-4 * (1 + scene.simulation.reactions()[1].norm()));
  }
  EXPECT_LE(most, 1e-5 * largest_of_all);
}

TEST_P(GraspLaws, HoldAndLetGoWhileElementsLeave) {
  LiveRun run(law_strip(GetParam()));
  Simulation& s = run.simulation;
  const auto rests = [&] {
    settle(s, GetParam().moves ? 400 : 1);
    const FreshBody fresh = run.fresh();
    EXPECT_LE(fresh.error(), GetParam().moves ? 2e-2 : 1e-5);
  };
  settle(s, GetParam().moves ? 400 : 1);
  const int left = s.grasp(kLeft, true);
  s.step();
  s.pose(left, {s.centre_of(left) + Vec3(-0.1, 0, 0.05), {0, 0, 0.05, 1}});
  rests();
  s.remove(std::vector<Index>{100, 101, 102});
  const int right = s.grasp(kRight);
  rests();
  s.pose(right, {s.centre_of(right) + Vec3(0.1, 0.05, 0)});
  rests();
  s.release(left);
  rests();
  s.pose(right, {s.centre_of(right) + Vec3(0, 0.05, 0)});
  s.step();
  s.release(right);
  rests();
}

TEST_P(GraspLaws, AreRecordedAndTakenBack) {
  LiveRun run(law_strip(GetParam()));
  Simulation& s = run.simulation;
  run.keep_history();
  std::vector<RunState> states;
  const auto keep = [&] {
    s.step();
    states.emplace_back(s);
  };
  keep();
  const int grip = s.grasp(kLeft, true);
  s.pose(grip, {s.centre_of(grip) + Vec3(-0.05, 0, 0), {0, 0, 0.02, 1}});
  keep();
  s.remove(std::vector<Index>{100});
  keep();
  s.release(grip);
  keep();
  LiveRun other(law_strip(GetParam()));
  other.keep_history();
  other.simulation.load(s.store());
  expect_same_bits(RunState(other.simulation), states.back());
  for (int i = 2; i >= 0; --i) {
    EXPECT_TRUE(s.undo().replayed);
    expect_same_bits(RunState(s), states[static_cast<std::size_t>(i)]);
  }
  s.redo(3);
  expect_same_bits(RunState(s), states.back());
}

// The tangent that the last step ended with tells what the next one finds, to first order in the
// way; the forces carry the number and the step of their solution, and blend.
TEST_P(GraspLaws, AreFeltToFirstOrder) {
  LiveRun run(law_strip(GetParam()));
  Simulation& s = run.simulation;
  const auto forces = s.grip_forces();
  ASSERT_TRUE(forces);
  const int grip = s.grasp(kLeft, true);
  Hand hands[1];
  hands[0].grip = grip;
  hands[0].position = s.centre_of(grip);
  EXPECT_EQ(forces->feel({}, {}, hands).state, FeltState::waiting);
  s.pose(grip, {s.centre_of(grip) + Vec3(-0.1, 0.05, 0)});
  settle(s, GetParam().moves ? 200 : 1);
  const Wrench before = s.wrench(grip);
  const Vec3 way(2e-3, -1e-3, 1e-3);
  hands[0].position = s.centre_of(grip) + way;
  const Felt felt = forces->feel({}, {}, hands);
  ASSERT_EQ(felt.state, FeltState::live);
  EXPECT_TRUE(hands[0].held);
  // In motion a step of a body that has come to rest brings no other solution.
  EXPECT_LE(felt.step, s.steps_done() - 1);
  if (!GetParam().moves) {
    EXPECT_EQ(felt.step, s.steps_done() - 1);
  }
  EXPECT_EQ(felt.share, 1);
  EXPECT_GE(felt.age_ms, 0);
  s.pose(grip, {hands[0].position});
  forces->blend(1000);
  if (GetParam().moves) {
    s.step();
  } else {
    settle(s);
  }
  const Wrench after = s.wrench(grip);
  const double change = (after.force - before.force).norm();
  EXPECT_GT(change, 1e-4 * before.force.norm());
  EXPECT_LE((hands[0].force - after.force).norm(), 0.05 * change);
  const auto now = InstrumentForces::Clock::now();
  const Felt next = forces->feel({}, {}, hands, now);
  EXPECT_GT(next.solution, felt.solution);
  EXPECT_EQ(next.step, s.steps_done() - 1);
  EXPECT_LT(next.share, 1) << "the solution before is blended in";
  EXPECT_EQ(forces->feel({}, {}, hands, now + std::chrono::seconds(3)).share, 1);
  EXPECT_LE((hands[0].force - after.force).norm(), 0.05 * change);
}

INSTANTIATE_TEST_SUITE_P(Laws, GraspLaws, testing::ValuesIn(kLaws),
                         [](const auto& of) { return std::string(of.param.name); });

// In motion what is let go flies on with the velocity that it had.
TEST(GraspMotion, WhatNothingHoldsFliesOn) {
  Scene scene = law_strip(kLaws[4]);
  scene.supports.clear();
  scene.instruments.clear();
  scene.dynamics->mass_damping = 0;
  SceneRun run(std::move(scene));
  Simulation& s = run.simulation;
  const int grip = s.grasp(kLow, true);
  const Vec3 centre = s.centre_of(grip), velocity(0, 5, 0);
  const double dt = 2e-4;
  for (int i = 1; i <= 200; ++i) {
    s.pose(grip, {centre + dt * i * velocity});
    s.step();
  }
  s.release(grip);
  const StepReport first = s.step();
  EXPECT_GT(first.motion->momentum.y(), 0);
  for (int i = 0; i < 20; ++i) s.step();
  const StepReport last = s.step();
  EXPECT_LE((last.motion->momentum - first.motion->momentum).norm(),
            1e-6 * first.motion->momentum.norm());
  for (const Vec3& v : s.displacement()) EXPECT_TRUE(v.allFinite());
}

TEST(GraspMotion, SaysWhereTheIntactBodyCannotBeHeld) {
  Scene scene = notched(FractureModel::b);
  scene.materials["board"].law = MaterialLaw::corotated;
  SceneRun run(std::move(scene));
  try {
    static_cast<void>(run.simulation.grasp(std::vector<Index>{3}));
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("intact body"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sunder::test
