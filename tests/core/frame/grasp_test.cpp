// SPDX-License-Identifier: Apache-2.0
// What a host takes hold of and lets go while the simulation runs, against a body that the
// yardstick computes anew.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "core/frame/live_world.hpp"
#include "core/frame/run_state.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

class Grasp : public testing::TestWithParam<LiveWay> {};

TEST_P(Grasp, MovesNothing) {
  LiveRun run(live_strip(GetParam()));
  run.simulation.step();
  const auto before = run.simulation.displacement();
  const int grip = run.simulation.grasp(kLeft);
  EXPECT_EQ(grip, 1) << "after the scene's one instrument";
  EXPECT_TRUE(run.simulation.displacement() == before);
  EXPECT_EQ(run.simulation.wrench(grip).force, Vec3::Zero());
  run.simulation.step();
  run.expect_fresh(kIntactTolerance);
  double most = 0;
  for (std::size_t n = 0; n < before.size(); ++n) {
    most = std::max(most, (before[n] - run.simulation.displacement()[n]).norm());
  }
  EXPECT_LE(most, 1e-9);
  EXPECT_LE(run.simulation.wrench(grip).force.norm(), 1e-7);
}

TEST_P(Grasp, PointsGoWithTheirGrip) {
  LiveRun run(live_strip(GetParam()));
  run.simulation.step();
  const auto before = run.simulation.displacement();
  const int grip = run.simulation.grasp(kLeft);
  const Vec3 way(-0.2, 0.05, 0.03);
  run.simulation.pose(grip, {run.simulation.centre_of(grip) + way});
  run.simulation.step();
  const auto after = run.simulation.displacement();
  for (Index n : kLeft) {
    const auto at = static_cast<std::size_t>(n);
    EXPECT_LE((after[at] - before[at] - way).norm(), 1e-15);
  }
  run.expect_fresh(kIntactTolerance);
  run.expect_wrench(grip);
}

TEST_P(Grasp, ASolidTurnsExactly) {
  LiveRun run(live_strip(GetParam()));
  run.simulation.step();
  const auto before = run.simulation.displacement();
  const int grip = run.simulation.grasp(kLeft, true);
  const Vec3 centre = run.simulation.centre_of(grip), way(0.1, -0.1, 0.02);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3, Vec3(1, 2, -1).normalized()));
  // Of any length.
  run.simulation.pose(grip,
                      {centre + way, {3 * turn.x(), 3 * turn.y(), 3 * turn.z(), 3 * turn.w()}});
  run.simulation.step();
  const auto after = run.simulation.displacement();
  for (Index n : kLeft) {
    const auto at = static_cast<std::size_t>(n);
    const Vec3 x = run.problem->mesh().nodes[at];
    const Vec3 there = centre + way + turn.toRotationMatrix() * (x + before[at] - centre);
    EXPECT_LE((x + after[at] - there).norm(), 1e-14);
  }
  EXPECT_LE((run.simulation.centre_of(grip) - centre - way).norm(), 1e-15);
  run.expect_fresh(kIntactTolerance);
  run.expect_wrench(grip);
}

TEST_P(Grasp, HoldsWhileElementsLeave) {
  LiveRun run(live_strip(GetParam()));
  run.simulation.remove(std::vector<Index>{60, 61, 100});
  run.simulation.step();
  const int left = run.simulation.grasp(kLeft, true);
  run.simulation.step();
  const int right = run.simulation.grasp(kRight);
  run.simulation.pose(right, {run.simulation.centre_of(right) + Vec3(0.2, -0.1, 0.05)});
  run.simulation.pose(left, {run.simulation.centre_of(left), {0, 0, 0.1, 1}});
  run.simulation.step();
  run.expect_fresh(kIntactTolerance);
  for (const Index e : {70, 71, 72, 40, 41}) {
    run.simulation.remove(std::vector<Index>{e});
    run.expect_fresh(kCrackTolerance);  // at once, under the same load
    run.simulation.step();
    run.expect_fresh(kCrackTolerance);
    run.expect_wrench(left);
    run.expect_wrench(right);
  }
  run.simulation.release(left);
  run.simulation.step();
  run.expect_fresh(kCrackTolerance);
  run.expect_wrench(right);
}

TEST_P(Grasp, LetsGoAsIfItHadNeverHeld) {
  LiveRun run(live_strip(GetParam())), never(live_strip(GetParam()));
  never.simulation.step();
  never.simulation.remove(std::vector<Index>{50});
  never.simulation.step();
  run.simulation.step();
  const int grip = run.simulation.grasp(kRight, true);
  run.simulation.pose(grip, {Vec3(9, 1, 1), {0, 0.3, 0, 1}});
  run.simulation.remove(std::vector<Index>{50});
  run.simulation.step();
  run.simulation.release(grip);
  run.simulation.step();
  const auto u = never.simulation.displacement(), v = run.simulation.displacement();
  double most = 0, largest_of_all = 0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    most = std::max(most, (u[n] - v[n]).norm());
    largest_of_all = std::max(largest_of_all, u[n].norm());
  }
  EXPECT_LE(most, kCrackTolerance * largest_of_all);
  // And takes hold again, of some of the same nodes.
  const int again = run.simulation.grasp(std::vector<Index>{kRight[1], kLeft[0]});
  EXPECT_EQ(again, 2) << "no id comes twice";
  run.simulation.pose(again, {run.simulation.centre_of(again) + Vec3(0, 0, 0.1)});
  run.simulation.step();
  run.expect_fresh(kCrackTolerance);
}

TEST_P(Grasp, OfAllNodesAround) {
  LiveRun run(live_strip(GetParam()));
  run.simulation.step();
  const int grip = run.simulation.grasp(Vec3(0, 7.4, 0), 1.2, true);
  EXPECT_EQ(run.simulation.centre_of(grip), Vec3(0, 7.4, 0));
  const auto held = run.simulation.held_nodes(grip);
  ASSERT_FALSE(held.empty());
  const auto u = run.simulation.displacement();
  for (Index n = 0; n < run.problem->node_count(); ++n) {
    const auto at = static_cast<std::size_t>(n);
    const Vec3 x = run.problem->mesh().nodes[at] + u[at];
    const bool inside = (x - Vec3(0, 7.4, 0)).norm() <= 1.2 && run.problem->dof(n, 0) != kNone;
    EXPECT_EQ(std::ranges::find(held, n) != held.end(), inside) << n;
  }
  run.simulation.pose(grip, {Vec3(0.1, 7.4, 0), {0, 0, 0.2, 1}});
  run.simulation.step();
  run.expect_fresh(kIntactTolerance);
  run.expect_wrench(grip);
}

TEST_P(Grasp, PushesGoWhereTheyAreMoved) {
  LiveRun run(live_strip(GetParam()));
  const std::vector<Index> other{kLeft[0], kRight[2]};
  const int push = run.push(kRight, Vec3(0.1, 0, 0.4));
  run.simulation.step();
  run.expect_fresh(kIntactTolerance);
  const int grip = run.simulation.grasp(kLeft);
  run.move(push, other, Vec3(-0.2, 0.1, 0));  // a node that is held is pushed too
  run.simulation.step();
  run.expect_fresh(kIntactTolerance);
  run.expect_wrench(grip);
  run.drop(push);
  run.simulation.release(grip);
  run.simulation.step();
  run.expect_fresh(kIntactTolerance);
}

TEST_P(Grasp, HoldsAPieceThatHasComeOff) {
  LiveRun run(live_strip(GetParam()));
  run.drive(Vec3(0, -0.01, 0));  // what pulls at a loose piece has little to hold it by
  run.simulation.step();
  std::vector<Index> across;  // a row of cells through the strip
  for (Index e = 6 * 4 * 5; e < 6 * 4 * 6; ++e) across.push_back(e);
  const int grip = run.simulation.grasp(kLow, true);
  run.simulation.remove(across);
  EXPECT_EQ(run.simulation.piece_of(0), kNone) << "held";
  run.simulation.step();
  run.expect_fresh(kCutTolerance);
  run.simulation.release(grip);
  EXPECT_NE(run.simulation.piece_of(0), kNone);
  EXPECT_TRUE(mentions(run.simulation.warnings(), "cut off"));
  run.simulation.step();
  const int again = run.simulation.grasp(kLow);
  EXPECT_EQ(run.simulation.piece_of(0), kNone);
  run.simulation.step();
  run.expect_fresh(kCutTolerance);
  EXPECT_LE(run.simulation.wrench(again).force.norm(), 0.1);
}

TEST_P(Grasp, IsTakenBackToTheSameBits) {
  LiveRun run(live_strip(GetParam()));
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
  const int left = s.grasp(kLeft, true);
  s.pose(left, {s.centre_of(left) + Vec3(0.1, 0, 0), {0.1, 0, 0, 1}});
  keep();
  s.remove(std::vector<Index>{70, 71});
  s.pose(left, {s.centre_of(left) + Vec3(0.1, 0.1, 0), {0, 0.1, 0, 1}});
  keep();
  const int push = s.push(kRight, Vec3(0.1, 0.1, 0));
  const int right = s.grasp(kRight);
  keep();
  s.release(left);
  keep();
  s.drop(push);
  s.remove(std::vector<Index>{73});
  keep();
  EXPECT_EQ(s.undos(), 7);
  // Before: the removal, the drop, the release, the grip, the push, the removal, the grip.
  const int at[] = {4, 4, 3, 2, 2, 1, 0};
  for (int n = 0; n < 7; ++n) {
    s.undo();
    EXPECT_EQ(s.undos(), 6 - n);
    expect_same_bits(RunState(s), states[static_cast<std::size_t>(at[n])]);
  }
  EXPECT_THROW(s.pose(left, {}), UsageError) << "it is not there yet";
  EXPECT_EQ(s.redos(), 7);
  s.redo(7);
  expect_same_bits(RunState(s), states.back());
  EXPECT_THROW(s.pose(left, {}), UsageError) << "it has let go";
  s.pose(right, {s.centre_of(right)});
  for (const std::size_t to : std::vector<std::size_t>{2, 5, 0, 3, 1, 4}) {
    s.restore(marks[to]);
    expect_same_bits(RunState(s), states[to]);
  }
  s.restore(marks[1]);
  s.release(left);
  s.step();
  run.expect_fresh(kIntactTolerance);
  // What a recording tells another simulation.
  const auto bytes = s.store();
  LiveRun other(live_strip(GetParam()));
  other.keep_history();
  other.simulation.load(bytes);
  expect_same_bits(RunState(other.simulation), RunState(s));
}

TEST_P(Grasp, TellsOfEachRuptureWhichToolItWas) {
  Scene scene = live_strip(GetParam());
  scene.fracture.model = FractureModel::a;
  scene.fracture.max_events = 1;
  scene.materials["board"].yield = 0.2;
  scene.instruments[0].action = Pull{band(-1, 0.1), Vec3(0, -0.01, 0)};
  LiveRun run(std::move(scene));
  run.simulation.attribute_events(true);
  run.simulation.step();
  const int grip = run.simulation.grasp(kLow);
  run.simulation.pose(grip, {run.simulation.centre_of(grip) - Vec3(0, 2, 0)});
  run.simulation.step();
  ASSERT_FALSE(run.simulation.destroyed().empty());
  EXPECT_EQ(run.simulation.destroyed()[0].instrument, grip);
  EXPECT_GT(run.simulation.destroyed()[0].instrument_share, 0.9);
}

INSTANTIATE_TEST_SUITE_P(Ways, Grasp, testing::ValuesIn(kLiveWays),
                         [](const auto& of) { return std::string(of.param.name); });

/// Refused, and nothing has changed.
void grasp_refused(Simulation& s, const std::vector<Index>& nodes, const std::string& why) {
  const auto before = s.backend().gripped_dofs().size();
  refused([&] { static_cast<void>(s.grasp(nodes)); }, why);
  EXPECT_EQ(s.backend().gripped_dofs().size(), before);
}

TEST(GraspAbuse, IsRefusedInASentence) {
  LiveRun run(live_strip(kLiveWays[1]));
  Simulation& s = run.simulation;
  grasp_refused(s, {}, "no nodes");
  grasp_refused(s, {-1}, "node -1 cannot be grasped: the mesh has none");
  grasp_refused(s, {90}, "node 90 cannot be grasped: the mesh has none");
  grasp_refused(s, {4, 3, 4}, "node 4 cannot be grasped: it is named twice");
  grasp_refused(s, {3, 44}, "node 44 cannot be grasped: a support holds it");
  const int grip = s.grasp(kLeft);
  grasp_refused(s, {3, kLeft[0]}, "another grip holds it");
  const Pose nowhere{Vec3(NAN, 0, 0)};
  refused([&] { s.pose(grip, nowhere); }, "must be finite");
  refused([&] { s.pose(grip, {Vec3::Zero(), {0, 0, 0, 0}}); }, "length above 0");
  refused([&] { s.pose(grip, {Vec3::Zero(), {0, NAN, 0, 1}}); }, "must be finite");
  refused([&] { s.pose(grip, {Vec3::Zero(), {0, 0, 0.1, 1}}); }, "holds points");
  s.pose(grip, {s.centre_of(grip), {0, 0, 0, 1e-300}});  // some length
  refused([&] { s.pose(0, {}); }, "instrument 0 is the scene's own");
  refused([&] { s.release(7); }, "there is no grip 7");
  refused([&] { static_cast<void>(s.wrench(-3)); }, "there is no grip -3");
  refused([&] { static_cast<void>(s.grasp(Vec3(0, 0, 0), 0)); }, "radius");
  refused([&] { static_cast<void>(s.grasp(Vec3(0, 0, 0), NAN)); }, "radius");
  refused([&] { static_cast<void>(s.grasp(Vec3(0, NAN, 0), 1)); }, "finite");
  refused([&] { static_cast<void>(s.grasp(Vec3(50, 0, 0), 1)); }, "no node that could be");
  const int push = s.push(std::vector<Index>{3}, Vec3(1, 0, 0));
  refused([&] { s.release(push); }, "that is a push");
  refused([&] { s.drop(grip); }, "that is a grip");
  refused([&] { s.push(std::vector<Index>{3}, Vec3(NAN, 0, 0)); }, "finite");
  refused([&] { s.push(std::vector<Index>{44}, Vec3(1, 0, 0)); }, "node 44 cannot be pushed");
  refused([&] { s.push({}, Vec3(1, 0, 0)); }, "no nodes");
  refused([&] { s.move(push, std::vector<Index>{3, 3}, Vec3(1, 0, 0)); }, "named twice");
  s.release(grip);
  refused([&] { s.release(grip); }, "it has been let go");
  refused([&] { s.pose(grip, {}); }, "it has been let go");
  s.drop(push);
  refused([&] { s.drop(push); }, "it has been let go");
  refused([&] { s.keep_history(); }, "before the first grip");
  s.step();
  std::vector<Index> around;  // all elements at node 0
  for (Index e = 0; e < run.problem->tet_count(); ++e) {
    const auto& tet = run.problem->mesh().tets[static_cast<std::size_t>(e)];
    if (std::ranges::find(tet, 0) != tet.end()) around.push_back(e);
  }
  s.remove(around);
  grasp_refused(s, {0}, "all elements around it are gone");
}

TEST(GraspAbuse, SaysWhatCannot) {
  Scene none = live_strip(kLiveWays[0]);
  none.live = false;
  LiveRun fixed(std::move(none));
  grasp_refused(fixed.simulation, {3}, "live");
}

// On route condensed a grip's first frame needs no full check: what it says of its error holds, by
// a body that is computed everywhere.
TEST(GraspCondensed, IsCheckedByTheRegionAlone) {
  for (const bool torn : {false, true}) {
    SCOPED_TRACE(torn);
    LiveRun run(live_strip({"condensed", Route::condensed})),
        exact(live_strip({"factor", Route::factor}));
    for (LiveRun* of : {&run, &exact}) {
      if (torn) of->simulation.remove(std::vector<Index>{60, 61, 70, 100});
      of->simulation.step();
    }
    const auto differ = [&] {
      double most = 0, largest = 0;
      for (Index e = 0; e < run.problem->tet_count(); ++e) {
        const Voigt a = run.simulation.backend().read_stress(e),
                    b = exact.simulation.backend().read_stress(e);
        if (run.simulation.backend().destroyed()[e]) continue;
        most = std::max(most, (a - b).norm());
        largest = std::max(largest, b.norm());
      }
      return most / largest;
    };
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(-1, 1);
    for (int i = 0; i < 30; ++i) {
      SCOPED_TRACE(i);
      std::vector<Index> nodes;
      while (nodes.size() < 4) {
        const auto n = static_cast<Index>(random() % 90);
        if (run.problem->dof(n, 0) == kNone || std::ranges::find(nodes, n) != nodes.end()) continue;
        nodes.push_back(n);
      }
      const Vec3 way = 0.1 * Vec3(part(random), part(random), part(random));
      const double turn = 0.1 * part(random);
      StepReport report;
      for (LiveRun* of : {&exact, &run}) {
        Simulation& s = of->simulation;
        const int grip = s.grasp(nodes, i % 2 == 0);
        if (i % 2 == 0) s.pose(grip, {s.centre_of(grip) + way, {0, 0, turn, 1}});
        if (i % 2 == 1) s.pose(grip, {s.centre_of(grip) + way});
        report = s.step();
      }
      EXPECT_EQ(report.back_solves, 1) << "a full check has more";
      EXPECT_LE(report.error, 1e-8);
      EXPECT_LE(differ(), report.error + 1e-11);
      for (LiveRun* of : {&exact, &run}) of->simulation.release(i + 1);
    }
  }
}

// Between frames the scene's own grips are told forces with what a host holds where it is.
TEST(GraspForces, AreThoseOfTheBodyThatIsHeld) {
  for (const LiveWay& way : kLiveWays) {
    SCOPED_TRACE(way.name);
    Scene scene = live_strip(way);
    scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -0.3, 0), Axes{7}};
    LiveRun run(std::move(scene));
    Simulation& s = run.simulation;
    s.step();
    const auto forces = s.backend().instrument_forces();
    if (!forces) continue;  // route cg, update eager
    const int grip = s.grasp(kLeft);
    s.pose(grip, {s.centre_of(grip) + Vec3(0.2, 0, 0)});
    s.step();
    const auto own = static_cast<std::size_t>(forces->size());
    std::vector<double> d(own), felt(own), all(s.backend().gripped_dofs().size());
    for (std::size_t g = 1; g < own; g += 3) d[g] = -0.3;
    ASSERT_TRUE(forces->forces(d, felt));
    s.backend().read_reactions(all);
    for (std::size_t g = 0; g < own; ++g) EXPECT_NEAR(felt[g], all[g], 1e-7) << g;
    // As if they had moved on by themselves.
    for (std::size_t g = 1; g < own; g += 3) d[g] = -0.5;
    ASSERT_TRUE(forces->forces(d, felt));
    s.drive(0, Vec3(0, -0.5, 0));
    s.step();
    s.backend().read_reactions(all);
    for (std::size_t g = 0; g < own; ++g) EXPECT_NEAR(felt[g], all[g], 1e-6) << g;
  }
}

}  // namespace
}  // namespace sunder::test
