// SPDX-License-Identifier: Apache-2.0
// Grips of the scene that let go at run time, against a scene that never had them.
#include <gtest/gtest.h>

#include <cmath>

#include "core/frame/live_laws.hpp"
#include "core/frame/live_random.hpp"
#include "core/frame/run_state.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

Instrument grip_of(const std::vector<Index>& nodes, const Vec3& way, bool rigid = false) {
  Instrument grip;
  Grip held{nodes, way, Axes{7}};
  held.rigid = rigid;
  if (rigid) held.turn = Vec3(0, 4, 2);
  grip.action = held;
  return grip;
}

/// Pulled at its lower edge (instrument 0), held at the left as a solid (1) and at the right (2).
Scene held_strip(Scene scene) {
  scene.instruments.push_back(grip_of(kLeft, Vec3(-0.2, 0.1, 0.05), true));
  scene.instruments.push_back(grip_of(kRight, Vec3(0.1, 0, 0.1)));
  return scene;
}

/// Of displacement, by the largest one.
double difference(const Simulation& a, const Simulation& b) {
  const auto u = a.displacement(), v = b.displacement();
  double most = 0, largest = 0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    most = std::max(most, (u[n] - v[n]).norm());
    largest = std::max(largest, v[n].norm());
  }
  return most / largest;
}

class Release : public testing::TestWithParam<LiveWay> {};

TEST_P(Release, IsASceneThatNeverHadTheGrip) {
  LiveRun run(held_strip(live_strip(GetParam()))), never(live_strip(GetParam()));
  Simulation& s = run.simulation;
  s.step();
  s.remove(std::vector<Index>{50, 70, 71});
  s.step();
  EXPECT_GT(s.reactions()[1].norm(), 0.01);
  s.release(1);
  EXPECT_EQ(s.backend().gripped_dofs().size(), 3 * kRight.size());
  s.step();
  run.expect_fresh(kCrackTolerance);
  EXPECT_EQ(s.reactions()[1], Vec3::Zero());
  const Vec3 anew = run.fresh().wrench(kRight, Vec3::Zero()).force;
  EXPECT_LE((s.reactions()[2] - anew).norm(), 1e-6 * (1 + anew.norm()));
  s.release(2);
  s.step();
  EXPECT_TRUE(s.backend().gripped_dofs().empty());
  run.expect_fresh(kCrackTolerance);
  never.simulation.step();
  never.simulation.remove(std::vector<Index>{50, 70, 71});
  never.simulation.step();
  EXPECT_LE(difference(s, never.simulation), kCrackTolerance);
  // A host takes hold of the same nodes, and goes on with what is left.
  const int grip = s.grasp(kLeft, true);
  EXPECT_EQ(grip, 3);
  s.pose(grip, {s.centre_of(grip) + Vec3(-0.1, 0, 0), {0, 0, 0.1, 1}});
  s.remove(std::vector<Index>{72});
  s.step();
  run.expect_fresh(kCrackTolerance);
  run.expect_wrench(grip);
}

TEST_P(Release, OfSomeAxesAlone) {
  Scene scene = live_strip(GetParam());
  Instrument grip = grip_of(kLeft, Vec3(-0.2, 0, 0.05));
  std::get<Grip>(grip.action).axes = Axes{5};  // x and z
  scene.instruments.push_back(grip);
  LiveRun run(std::move(scene)), never(live_strip(GetParam()));
  run.simulation.step();
  EXPECT_GT(std::abs(run.simulation.reactions()[1].x()), 0.01);
  run.simulation.release(1);
  run.simulation.step();
  never.simulation.step();
  EXPECT_LE(difference(run.simulation, never.simulation), kIntactTolerance);
}

TEST_P(Release, IsTakenBackToTheSameBits) {
  LiveRun run(held_strip(live_strip(GetParam())));
  Simulation& s = run.simulation;
  run.keep_history();
  std::vector<RunState> states;
  std::vector<Mark> marks;
  const auto keep = [&] {
    s.step();
    states.emplace_back(s);
    marks.push_back(s.save());
  };
  keep();
  s.remove(std::vector<Index>{70, 71});
  keep();
  s.release(1);
  keep();
  const int grip = s.grasp(kLeft);
  s.remove(std::vector<Index>{100});
  keep();
  s.release(2);
  s.drive(0, Vec3(0, -0.7, 0.1));
  keep();
  s.release(grip);
  keep();
  // Before: the grip's release, that of instrument 2, the removal, the grip, that of 1, the
  // removal.
  const int at[] = {4, 3, 2, 2, 1, 0};
  for (int n = 0; n < 6; ++n) {
    s.undo();
    expect_same_bits(RunState(s), states[static_cast<std::size_t>(at[n])]);
  }
  s.drive(1, Vec3(-0.2, 0.1, 0.05));  // it holds again
  s.step();
  run.expect_fresh(kIntactTolerance);
  for (const std::size_t to : std::vector<std::size_t>{2, 5, 0, 3, 1, 4}) {
    s.restore(marks[to]);
    expect_same_bits(RunState(s), states[to]);
    s.step();
    s.restore(marks[to]);
  }
  const auto bytes = s.store();
  LiveRun other(held_strip(live_strip(GetParam())));
  other.keep_history();
  other.simulation.load(bytes);
  expect_same_bits(RunState(other.simulation), RunState(s));
}

TEST_P(Release, GivesBackWeight) {
  if (GetParam().route == Route::condensed) return;  // takes no weight
  Scene scene = live_strip(GetParam());
  scene.materials["board"].density = 1e-5;
  scene.gravity = Vec3(0, -9810, 0);
  Scene none = scene;
  LiveRun run(held_strip(std::move(scene))), never(std::move(none));
  run.simulation.step();
  run.simulation.release(1);
  run.simulation.release(2);
  run.simulation.step();
  never.simulation.step();
  EXPECT_LE(difference(run.simulation, never.simulation), kIntactTolerance);
  EXPECT_LE((run.simulation.support_reaction() - never.simulation.support_reaction()).norm(),
            1e-8 * never.simulation.support_reaction().norm());
}

TEST_P(Release, OfWhatHeldAPieceSetsItLoose) {
  Scene scene = live_strip(GetParam());
  scene.instruments[0].action = Pull{band(-1, 0.1), Vec3(0, -0.01, 0)};
  scene.instruments.push_back(grip_of(kLeft, Vec3::Zero()));
  LiveRun run(std::move(scene));
  Simulation& s = run.simulation;
  s.step();
  std::vector<Index> across;
  for (Index e = 6 * 4 * 5; e < 6 * 4 * 6; ++e) across.push_back(e);
  s.remove(across);
  EXPECT_EQ(s.piece_of(0), kNone) << "held";
  s.step();
  run.expect_fresh(kCutTolerance);
  s.release(1);
  EXPECT_NE(s.piece_of(0), kNone);
  EXPECT_TRUE(mentions(s.warnings(), "cut off"));
  s.step();
  const int grip = s.grasp(kLow);
  EXPECT_EQ(s.piece_of(0), kNone);
  s.step();
  run.expect_fresh(kCutTolerance);
  EXPECT_LE(s.wrench(grip).force.norm(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Ways, Release, testing::ValuesIn(kLiveWays),
                         [](const auto& of) { return std::string(of.param.name); });

// New bases come on the way.
TEST(ReleaseAtRandom, LeadsToWhatTheBodyIsAnew) {
  for (const LiveWay& way : kLiveWays) {
    SCOPED_TRACE(way.name);
    Scene scene = live_strip(way);
    scene.instruments.push_back(grip_of(kLeft, Vec3(-0.05, 0, 0), true));
    scene.instruments.push_back(grip_of(kRight, Vec3(0.05, 0, 0)));
    const Played played = play_at_random(scene, 5, 200, 10, 5);
    EXPECT_GE(played.checked, 10);
    EXPECT_GE(played.own, 2);
  }
}

// By other laws and in motion.
class ReleaseLaws : public testing::TestWithParam<LawWay> {
 protected:
  static Scene scene(bool held) {
    Scene scene = law_strip(GetParam());
    return held ? held_strip(std::move(scene)) : scene;
  }
  static void settle(Simulation& s) { test::settle(s, GetParam().moves ? 400 : 1); }
};

TEST_P(ReleaseLaws, AreAsIfTheGripHadNeverBeen) {
  LiveRun run(scene(true)), never(scene(false));
  Simulation& s = run.simulation;
  settle(s);
  s.remove(std::vector<Index>{100, 101});
  settle(s);
  const double accuracy = GetParam().moves ? 2e-2 : 1e-5;
  EXPECT_LE(run.fresh().error(), accuracy);
  EXPECT_GT(s.reactions()[1].norm(), 0.01);
  s.release(1);
  settle(s);
  EXPECT_LE(run.fresh().error(), accuracy);
  EXPECT_EQ(s.reactions()[1], Vec3::Zero());
  s.release(2);
  settle(s);
  EXPECT_LE(run.fresh().error(), accuracy);
  settle(never.simulation);
  never.simulation.remove(std::vector<Index>{100, 101});
  settle(never.simulation);
  EXPECT_LE(difference(s, never.simulation), accuracy);
}

TEST_P(ReleaseLaws, AreRecordedAndTakenBack) {
  LiveRun run(scene(true));
  Simulation& s = run.simulation;
  run.keep_history();
  std::vector<RunState> states;
  const auto keep = [&] {
    s.step();
    states.emplace_back(s);
  };
  keep();
  s.release(1);
  keep();
  s.remove(std::vector<Index>{100});
  keep();
  const int grip = s.grasp(kLeft, true);
  s.pose(grip, {s.centre_of(grip) + Vec3(-0.02, 0, 0), {0, 0, 0.02, 1}});
  s.release(2);
  keep();
  LiveRun other(scene(true));
  other.keep_history();
  other.simulation.load(s.store());
  expect_same_bits(RunState(other.simulation), states.back());
  s.undo(2);
  expect_same_bits(RunState(s), states[2]);
  s.undo();
  expect_same_bits(RunState(s), states[1]);
  s.undo();
  expect_same_bits(RunState(s), states[0]);
  s.redo(4);
  expect_same_bits(RunState(s), states.back());
}

INSTANTIATE_TEST_SUITE_P(Laws, ReleaseLaws, testing::ValuesIn(kLaws),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(ReleaseAbuse, IsRefusedInASentence) {
  LiveRun run(held_strip(live_strip(kLiveWays[0])));
  Simulation& s = run.simulation;
  refused([&] { s.release(0); }, "instrument 0 cannot let go: it holds nothing");
  refused([&] { s.release(3); }, "there is no grip 3");
  refused([&] { s.release(-1); }, "there is no grip -1");
  s.release(1);
  refused([&] { s.release(1); }, "instrument 1 has let go already");
  refused([&] { s.drive(1, Vec3::Zero()); }, "instrument 1 cannot be driven: it has let go");
  refused([&] { s.turn(1, Vec3::Zero()); }, "instrument 1 cannot be turned: it has let go");
  refused([&] { run.keep_history(); }, "before a grip of the scene lets go");
  s.step();
  run.expect_fresh(kIntactTolerance);

  Scene rigid = held_strip(live_strip(kLiveWays[0]));
  rigid.live = false;
  LiveRun fixed(std::move(rigid));
  refused([&] { fixed.simulation.release(1); }, "live");
}

// In statics a body that nothing else holds would have no place; in motion it flies.
TEST(ReleaseAbuse, OfTheLastThatHolds) {
  Scene scene = live_strip(kLiveWays[0]);
  scene.supports.clear();
  scene.instruments.push_back(grip_of(kLeft, Vec3::Zero(), true));
  Scene moving = scene;
  LiveRun run(std::move(scene));
  run.simulation.step();
  const auto before = run.simulation.displacement();
  refused([&] { run.simulation.release(1); }, "is held by grips of the scene alone");
  run.simulation.step();
  EXPECT_EQ(run.simulation.displacement(), before);
  moving.dynamics = Dynamics{.time_step = 2e-4};
  moving.materials["board"].density = 1e-9;
  LiveRun flies(std::move(moving));
  flies.simulation.step();
  flies.simulation.release(1);
  for (int i = 0; i < 20; ++i) flies.simulation.step();
  EXPECT_LT(flies.simulation.displacement()[0].y(), -0.01);
  for (const Vec3& u : flies.simulation.displacement()) EXPECT_TRUE(u.allFinite());
}

// What a hand feels: nothing of what has let go, from that moment on.
TEST(ReleaseForces, GoAtOnce) {
  for (const bool finite : {false, true}) {
    SCOPED_TRACE(finite);
    Scene scene = held_strip(live_strip(kLiveWays[1]));
    // By a law of finite deformation to first order: so little that it is nearly linear.
    const double scale = finite ? 0.01 : 1;
    if (finite) {
      scene.materials["board"].law = MaterialLaw::corotated;
      scene.instruments[0].action = Pull{band(-1, 0.1), Vec3(0, -2 * scale, 0)};
      for (const std::size_t i : {1, 2}) {
        Grip& grip = std::get<Grip>(scene.instruments[i].action);
        grip.displacement *= scale;
        grip.turn *= scale;
      }
    }
    LiveRun run(std::move(scene));
    Simulation& s = run.simulation;
    const auto forces = s.grip_forces();
    ASSERT_NE(forces, nullptr);
    for (int i = 0; i < 3; ++i) s.step();
    const auto gripped = run.problem->gripped_dofs();
    std::vector<double> d(gripped.size()), felt(gripped.size()), later(gripped.size());
    std::vector<std::uint8_t> left(gripped.size());
    for (std::size_t g = 0; g < gripped.size(); ++g) {
      for (Index n : kRight) {
        for (int axis = 0; axis < 3; ++axis) {
          if (run.problem->dof(n, axis) != gripped[g]) continue;
          left[g] = 1;
          d[g] = axis == 1 ? 0 : 0.1 * scale;
        }
      }
    }
    s.release(1);
    ASSERT_TRUE(forces->forces(d, felt));
    double most = 0;
    for (std::size_t g = 0; g < gripped.size(); ++g) {
      if (!left[g]) {
        EXPECT_EQ(felt[g], 0);
      }
      most = std::max(most, std::abs(felt[g]));
    }
    EXPECT_GT(most, 0.01 * scale);
    for (int i = 0; i < 3; ++i) s.step();
    ASSERT_TRUE(forces->forces(d, later));
    for (std::size_t g = 0; g < gripped.size(); ++g) {
      if (!left[g]) {
        EXPECT_EQ(later[g], 0);
      }
      EXPECT_NEAR(later[g], felt[g], finite ? 0.01 * most : 1e-7);
    }
  }
}

}  // namespace
}  // namespace sunder::test
