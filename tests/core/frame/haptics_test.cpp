// SPDX-License-Identifier: Apache-2.0
// What a haptic thread feels of grips that came at run time: against the next step's own forces.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/frame/live_world.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using std::chrono::milliseconds;

class Haptics : public testing::TestWithParam<LiveWay> {};

Hand hand_at(const Simulation& of, int grip, const Vec3& way = Vec3::Zero()) {
  Hand hand;
  hand.grip = grip;
  hand.position = of.centre_of(grip) + way;
  return hand;
}

// The law is linear: where a hand goes, the grip feels what a step would find there.
TEST_P(Haptics, FeelOfAGripIsTheNextStepsWrench) {
  LiveRun run(live_strip(GetParam()));
  Simulation& s = run.simulation;
  const auto forces = s.grip_forces();
  ASSERT_TRUE(forces);
  s.step();
  const int left = s.grasp(kLeft, true), right = s.grasp(kRight);
  s.remove(std::vector<Index>{60, 61, 100});
  s.step();
  Hand hands[] = {hand_at(s, right, {0.2, -0.1, 0.05}), hand_at(s, left, {-0.1, 0.05, 0})};
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.2, Vec3(1, 2, -1).normalized()));
  hands[1].quaternion = {2 * turn.x(), 2 * turn.y(), 2 * turn.z(), 2 * turn.w()};
  const Felt felt = forces->feel({}, {}, hands);
  ASSERT_EQ(felt.state, FeltState::live);
  EXPECT_EQ(felt.step, 1);
  for (const Hand& hand : hands) {
    s.pose(hand.grip, {hand.position, hand.grip == left ? hand.quaternion : Hand().quaternion});
  }
  s.step();
  for (const Hand& hand : hands) {
    EXPECT_TRUE(hand.held);
    const Wrench next = s.wrench(hand.grip);
    EXPECT_LE((hand.force - next.force).norm(), 1e-7 * next.force.norm());
    EXPECT_LE((hand.torque - next.torque).norm(), 1e-7 * (next.torque.norm() + 1));
    EXPECT_GT(next.force.norm(), 1e-3);
  }
}

TEST_P(Haptics, AGripWithoutASolutionHasNoForce) {
  LiveRun run(live_strip(GetParam()));
  const auto forces = run.simulation.grip_forces();
  EXPECT_EQ(forces->feel({}, {}, {}).state, FeltState::waiting);
  run.simulation.warm_up();
  EXPECT_EQ(forces->feel({}, {}, {}).state, FeltState::waiting);
  run.simulation.step();
  const int grip = run.simulation.grasp(kLeft);
  Hand hands[] = {hand_at(run.simulation, grip, {0.1, 0, 0})};
  hands[0].force.setOnes();
  EXPECT_EQ(forces->feel({}, {}, hands).state, FeltState::live);
  EXPECT_FALSE(hands[0].held);
  EXPECT_EQ(hands[0].force, Vec3::Zero());
  run.simulation.step();
  static_cast<void>(forces->feel({}, {}, hands));
  EXPECT_TRUE(hands[0].held);
  EXPECT_GT(hands[0].force.norm(), 1e-3);
}

// It lets go at once, also while forces blend; the others feel the body as the next step has it.
TEST_P(Haptics, AGripThatIsLetGoHasNoForceAtOnce) {
  LiveRun run(live_strip(GetParam()));
  Simulation& s = run.simulation;
  const auto forces = s.grip_forces();
  s.step();
  const int left = s.grasp(kLeft, true), right = s.grasp(kRight);
  s.pose(left, {s.centre_of(left) + Vec3(-0.2, 0.1, 0)});
  s.step();
  Hand hands[] = {hand_at(s, left), hand_at(s, right, {0.1, 0, 0})};
  const auto start = InstrumentForces::Clock::now();
  ASSERT_EQ(forces->feel({}, {}, hands, start).state, FeltState::live);
  EXPECT_GT(hands[0].force.norm(), 1e-3);
  const Vec3 before = hands[1].force;
  forces->blend(20);
  s.release(left);
  Felt felt = forces->feel({}, {}, hands, start + milliseconds(5));
  EXPECT_FALSE(hands[0].held);
  EXPECT_EQ(hands[0].force, Vec3::Zero());
  EXPECT_EQ(felt.share, 0);
  EXPECT_LE((hands[1].force - before).norm(), 1e-9 * before.norm());
  felt = forces->feel({}, {}, hands, start + milliseconds(25));
  EXPECT_EQ(felt.share, 1);
  s.pose(right, {hands[1].position});
  s.step();
  EXPECT_LE((hands[1].force - s.wrench(right).force).norm(), 1e-7 * before.norm());
}

TEST_P(Haptics, AnUndoToBeforeTheFirstStepTakesTheForcesBack) {
  LiveRun run(live_strip(GetParam()));
  Simulation& s = run.simulation;
  run.keep_history();
  const auto forces = s.grip_forces();
  const int grip = s.grasp(kLeft);
  const Mark start = s.save();
  s.pose(grip, {s.centre_of(grip) + Vec3(0.1, 0, 0)});
  s.step();
  Hand hands[] = {hand_at(s, grip)};
  ASSERT_EQ(forces->feel({}, {}, hands).state, FeltState::live);
  const Vec3 there = hands[0].force;
  const Mark stepped = s.save();
  s.restore(start);
  EXPECT_EQ(forces->feel({}, {}, hands).state, FeltState::waiting);
  EXPECT_EQ(hands[0].force, Vec3::Zero());
  s.restore(stepped);
  EXPECT_EQ(forces->feel({}, {}, hands).state, FeltState::live);
  EXPECT_EQ(hands[0].force, there) << "by the very solution";
  s.undo();  // the grasp
  EXPECT_EQ(forces->feel({}, {}, hands).state, FeltState::waiting);
  EXPECT_FALSE(hands[0].held);
}

TEST_P(Haptics, GoBackWithTheBody) {
  LiveRun run(live_strip(GetParam()));
  Simulation& s = run.simulation;
  run.keep_history();
  const auto forces = s.grip_forces();
  const int left = s.grasp(kLeft, true);
  s.step();
  const int right = s.grasp(kRight);
  s.pose(right, {s.centre_of(right) + Vec3(0.1, 0, 0)});
  s.step();
  const Mark mark = s.save();
  Hand hands[] = {hand_at(s, left, {0, 0.1, 0}), hand_at(s, right)};
  static_cast<void>(forces->feel({}, {}, hands));
  const Vec3 first = hands[0].force, second = hands[1].force;
  s.remove(std::vector<Index>{60, 61, 100});
  s.release(left);
  s.step();
  static_cast<void>(forces->feel({}, {}, hands));
  EXPECT_FALSE(hands[0].held);
  EXPECT_NE(hands[1].force, second);
  s.restore(mark);
  static_cast<void>(forces->feel({}, {}, hands));
  EXPECT_LE((hands[0].force - first).norm(), 1e-9 * first.norm());
  EXPECT_LE((hands[1].force - second).norm(), 1e-9 * second.norm());
}

TEST_P(Haptics, SayWhenTheSimulationIsGone) {
  std::shared_ptr<InstrumentForces> forces;
  int grip = 0;
  {
    LiveRun run(live_strip(GetParam()));
    forces = run.simulation.grip_forces();
    grip = run.simulation.grasp(kLeft);
    run.simulation.step();
  }
  Hand hands[1];
  hands[0].grip = grip;
  hands[0].force.setOnes();
  EXPECT_EQ(forces->feel({}, {}, hands).state, FeltState::gone);
  EXPECT_EQ(hands[0].force, Vec3::Zero());
}

INSTANTIATE_TEST_SUITE_P(Ways, Haptics, testing::ValuesIn(kLiveWays.begin(), kLiveWays.begin() + 4),
                         [](const auto& way) { return std::string(way.param.name); });

/// Two unknowns of a scene's grip on a spring of this stiffness each.
void publish(InstrumentForces& forces, double stiffness, double rest = 0) {
  forces.publish(Eigen::Matrix2d::Identity() / std::sqrt(stiffness),
                 Eigen::Vector2d::Constant(rest));
}

// By the times that are handed in: no clock decides.
TEST(HapticBlend, GoesFromTheOldMapToTheNewOne) {
  InstrumentForces forces(std::vector<double>{0, 0});
  const auto at = [start = InstrumentForces::Clock::now()](int ms) {
    return start + milliseconds(ms);
  };
  std::vector<double> f(2);
  const auto feel = [&](double d, int ms) {
    const Felt felt = forces.feel(std::vector<double>{d, -d}, f, {}, at(ms));
    EXPECT_EQ(f[1], -f[0]);
    return felt;
  };
  forces.blend(10);
  publish(forces, 8);
  EXPECT_EQ(feel(1, 0).share, 1) << "nothing came before";
  EXPECT_NEAR(f[0], 8, 1e-12);
  publish(forces, 2);
  EXPECT_EQ(feel(1, 100).share, 0);
  EXPECT_NEAR(f[0], 8, 1e-12) << "no jump";
  EXPECT_NEAR(feel(1, 105).share, 0.5, 1e-9);
  EXPECT_NEAR(f[0], 5, 1e-12);
  static_cast<void>(feel(2, 105));
  EXPECT_NEAR(f[0], 10, 1e-12) << "both at the present displacement";
  // Another rupture in the middle: from where the force is.
  publish(forces, 1);
  const Felt again = feel(2, 105);
  EXPECT_EQ(again.solution, 3u);
  EXPECT_NEAR(f[0], 10, 1e-12);
  static_cast<void>(feel(2, 110));
  EXPECT_NEAR(f[0], 0.5 * 10 + 0.5 * 2, 1e-12);
  EXPECT_EQ(feel(2, 115).share, 1);
  EXPECT_NEAR(f[0], 2, 1e-12);
  forces.blend(0);
  publish(forces, 5);
  EXPECT_EQ(feel(2, 116).share, 1);
  EXPECT_NEAR(f[0], 10, 1e-12);
}

TEST(HapticBlend, EndsWhereThereIsNoSolution) {
  InstrumentForces forces(std::vector<double>{0, 0});
  const auto now = InstrumentForces::Clock::now();
  std::vector<double> f(2), d{1, 1};
  forces.blend(10);
  publish(forces, 8);
  EXPECT_EQ(forces.feel(d, f, {}, now).state, FeltState::live);
  forces.withdraw();
  EXPECT_EQ(forces.feel(d, f, {}, now).state, FeltState::waiting);
  EXPECT_EQ(f, std::vector<double>(2, 0.0));
  publish(forces, 2);
  EXPECT_EQ(forces.feel(d, f, {}, now).share, 1);
  EXPECT_NEAR(f[0], 2, 1e-12);
}

TEST(HapticBlend, CarriesNumberAgeAndStep) {
  InstrumentForces forces(std::vector<double>{0, 0});
  std::vector<double> f(2), d{1, 1};
  forces.label(6);
  publish(forces, 8);
  publish(forces, 8);
  const Felt felt = forces.feel(d, f, {}, InstrumentForces::Clock::now() + milliseconds(500));
  EXPECT_EQ(felt.solution, 2u);
  EXPECT_EQ(felt.step, 6);
  EXPECT_GE(felt.age_ms, 500);
  EXPECT_LE(felt.age_ms, 60000);
  InstrumentForces::Quiet quiet(&forces);
  publish(forces, 1);
  EXPECT_EQ(forces.feel(d, f, {}).solution, 2u) << "on the way to a state";
}

TEST(HapticBlend, RefusesWhatIsNotFinite) {
  InstrumentForces forces({});
  forces.describe({{3, true, 0, Vec3::Zero(), {Vec3::Zero()}, {Vec3::Zero()}}}, {});
  forces.publish(Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  Hand hands[1];
  hands[0].grip = 3;
  EXPECT_EQ(forces.feel({}, {}, hands).state, FeltState::live);
  hands[0].quaternion = {0, 0, 0, 0};
  EXPECT_EQ(forces.feel({}, {}, hands).state, FeltState::overflow);
  hands[0].quaternion = {0, 0, 0, 1e-300};
  EXPECT_EQ(forces.feel({}, {}, hands).state, FeltState::live);
  for (double bad : {std::nan(""), HUGE_VAL, 1e308}) {
    hands[0].position = Vec3::Constant(bad);
    const Felt felt = forces.feel({}, {}, hands);
    EXPECT_EQ(felt.state == FeltState::live, bad == 1e308);
    EXPECT_TRUE(hands[0].force.allFinite());
  }
  EXPECT_THROW(static_cast<void>(forces.feel(std::vector<double>{1}, {}, {})), UsageError);
}

}  // namespace
}  // namespace sunder::test
