// SPDX-License-Identifier: Apache-2.0
// What a host takes hold of where cracks have split, against a body that is made anew.
#include <gtest/gtest.h>

#include "split_live.hpp"

namespace sunder::test {
namespace {

class SplitGrasp : public ::testing::TestWithParam<CutCase> {};

INSTANTIATE_TEST_SUITE_P(All, SplitGrasp,
                         ::testing::Values(CutCase{{}, Route::inverse, false},
                                           CutCase{{}, Route::factor, true},
                                           CutCase{MaterialLaw::corotated, Route::factor, false},
                                           CutCase{MaterialLaw::corotated, Route::inverse, true},
                                           CutCase{MaterialLaw::neo_hookean, Route::factor, true}),
                         name_of);

/// Nodes that parted in a cut, and some beside them.
std::vector<Index> nodes_of_lip(const Simulation& s, std::size_t most) {
  std::vector<Index> nodes;
  for (const CrackFace& face : s.crack_faces()) {
    for (Index n : face.left) {
      if (n >= s.problem().node_count() || std::ranges::find(nodes, n) != nodes.end()) continue;
      if (s.problem().dof(n, 0) == kNone) continue;
      if (nodes.size() < most) nodes.push_back(n);
    }
  }
  return nodes;
}

TEST_P(SplitGrasp, OfALipMovesItAsTheFreshMeshSays) {
  CutRun run(GetParam());
  Simulation& s = run.simulation;
  s.step();
  ASSERT_GT(s.cut(through({-1, 4.1}, {5.2, 4.3})), 0);
  s.step();
  const auto before = s.displacement();
  const int grip = s.grasp(nodes_of_lip(s, 4));
  EXPECT_TRUE(s.displacement() == before) << "nothing moves by it";
  s.step();
  expect_as_fresh(run, GetParam());
  s.pose(grip, {s.centre_of(grip) + Vec3(0.02, -0.1, 0.05)});
  s.step();
  expect_as_fresh(run, GetParam());
  EXPECT_GT(s.wrench(grip).force.norm(), 1e-4);
  // A second one, another cut under them, and letting go in the other order.
  const int other = s.grasp(Vec3(7, 2, 1), 1.2, true);
  s.step();
  expect_as_fresh(run, GetParam());
  EXPECT_GT(s.cut(through({6.2, 6}, {8, 5.5})), 0);
  expect_as_fresh(run, GetParam());
  s.release(grip);
  s.step();
  expect_as_fresh(run, GetParam());
  s.pose(other, {s.centre_of(other) + Vec3(0, 0.03, 0)});
  s.step();
  expect_as_fresh(run, GetParam());
  s.release(other);
  s.step();
  expect_as_fresh(run, GetParam());
}

/// A cut through what a grip holds: the lip that keeps the node stays held, the other one is free.
TEST_P(SplitGrasp, ThatABladePassesHoldsTheNodesOfTheMesh) {
  CutRun run(GetParam());
  Simulation& s = run.simulation;
  s.step();
  const int grip = s.grasp(Vec3(3, 4, 1), 1.5);
  s.pose(grip, {s.centre_of(grip) + Vec3(0.01, -0.04, 0.02)});
  s.step();
  ASSERT_GT(s.cut(through({-1, 4.1}, {5.2, 4.3})), 0);
  expect_as_fresh(run, GetParam());
  s.pose(grip, {s.centre_of(grip) + Vec3(0.01, -0.02, 0)});
  s.step();
  expect_as_fresh(run, GetParam());
}

/// A grip of the scene that has let go: nodes that it held part as those of a scene without it.
TEST_P(SplitGrasp, OfTheSceneLetsNodesPart) {
  Scene held = scene_of(GetParam(), cut_board());
  Instrument forceps;
  Grip grip{Box{Vec3(1.5, 3, -1), Vec3(4.5, 5, 3)}, Vec3(0.01, -0.04, 0.02), Axes{7}};
  forceps.action = grip;
  held.instruments.push_back(forceps);
  const auto at = static_cast<int>(held.instruments.size()) - 1;
  CutRun run(held), never(GetParam());
  Simulation& s = run.simulation;
  s.step();
  s.step();
  EXPECT_GT(s.reactions().back().norm(), 1e-4);
  s.release(at);
  s.step();  // a blade passes the body as it is deformed
  const RunState let_go(s);
  ASSERT_GT(s.cut(through({-1, 4.1}, {5.2, 4.3})), 0);
  s.step();
  const RunState cut(s);
  never.simulation.step();
  never.simulation.step();
  never.simulation.cut(through({-1, 4.1}, {5.2, 4.3}));
  never.simulation.step();
  ASSERT_EQ(s.backend().node_count(), never.simulation.backend().node_count());
  expect_as_fresh(never, GetParam());
  const std::vector<double> u = flat(s.displacement()), v = flat(never.simulation.displacement());
  const std::vector<std::uint8_t> none(s.mesh().tets.size(), 0);
  EXPECT_LE(displacement_error(s.mesh(), none, u, v), GetParam().law ? 1e-7 : kCrackTolerance);
  s.undo();
  expect_same_bits(RunState(s), let_go);
  s.redo();  // with the step after it
  expect_same_bits(RunState(s), cut);
  // It holds again, and a crack comes by: the node would have parted, had it been free.
  s.undo(2);
  s.cut(through({-1, 4.1}, {5.2, 4.3}));
  try {
    s.release(at);
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("a crack of split nodes has reached node"),
              std::string::npos)
        << error.what();
  }
}

TEST_P(SplitGrasp, IsTakenBackAndDoneAgainBitForBitAndTold) {
  CutRun run(GetParam()), other(GetParam());
  Simulation& s = run.simulation;
  s.step();
  s.cut(through({-1, 4.1}, {5.2, 4.3}));
  const RunState cut(s);
  const int grip = s.grasp(nodes_of_lip(s, 3));
  s.pose(grip, {s.centre_of(grip) + Vec3(0, -0.05, 0)});
  s.step();
  s.release(grip);
  s.step();
  const RunState after(s);
  s.undo(2);
  expect_same_bits(cut, RunState(s));
  s.redo(2);
  expect_same_bits(after, RunState(s));
  other.simulation.load(s.store());
  expect_same_bits(after, RunState(other.simulation));
}

/// Bases that are made anew beside the frames take over what is gripped and what has parted.
TEST(SplitGraspAll, OutlivesNewBases) {
  const CutCase c{{}, Route::factor, false};
  Scene scene = scene_of(c, cut_board());
  scene.steps = 1000;
  CutRun run(std::move(scene));
  Simulation& s = run.simulation;
  s.step();
  const int grip = s.grasp(Vec3(5, 0.5, 1), 1.2, true);
  const auto border = [&] {
    std::size_t bytes = 0;
    for (const BufferPlan& b : s.backend().buffers()) {
      if (b.name == "border of the new unknowns") bytes = b.bytes;
    }
    return bytes;
  };
  std::size_t before = 0;
  int bases = 0;
  const auto look = [&] {
    bases += border() < before;  // what had parted is in a base now
    before = border();
  };
  for (int i = 0; i < 6; ++i) {
    const double y = 1.2 + i;
    EXPECT_GT(s.cut(through({i % 2 == 0 ? -1.0 : 6.0, y}, {i % 2 == 0 ? 4.0 : 11.0, y})), 0) << i;
    s.pose(grip, {s.centre_of(grip) + Vec3(0, -0.01, 0.01)});
    s.step();
    expect_as_fresh(run, c);
    look();
  }
  // A base is taken some fifty events after its start.
  for (int i = 0; i < 60; ++i) {
    const int other = s.grasp(Vec3(0.8 + 0.14 * i, 5, 1), 1.0, i % 2 == 0);
    s.pose(other, {s.centre_of(other) + Vec3(0.01, 0, 0)});
    s.step();
    look();
    if (i % 6 == 0) expect_as_fresh(run, c);
    s.release(other);
    if (i == 45) s.cut(through({4.2, 7}, {6, 6.6}));
  }
  s.release(grip);
  s.step();
  expect_as_fresh(run, c);
  EXPECT_GT(bases, 0);
}

/// The soak has ten thousand (split_live_soak_test.cpp).
TEST(SplitGraspAll, RandomActionsLeadToWhatTheBodyIsAnew) {
  play_split({{}, Route::factor, false}, 3, 300, 10, 10);
  play_split({{}, Route::inverse, true}, 4, 200, 10, 10);
  play_split({MaterialLaw::corotated, Route::factor, false}, 5, 60, 10, 3);
}

}  // namespace
}  // namespace sunder::test
