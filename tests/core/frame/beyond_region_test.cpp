// SPDX-License-Identifier: Apache-2.0
// What a host does beyond the region of route condensed, which grows by it; every test of
// live_world does so by way "patch".
#include "core/frame/live_world.hpp"

namespace sunder::test {
namespace {

// Stress too, and where the body is not live but breaks: the region grows by what a host takes out.
TEST(BeyondARegion, ElementsLeave) {
  for (const bool live : {false, true}) {
    Scene condensed = live_strip({"patch", Route::condensed, Update::automatic, true}),
          whole = live_strip({"patch", Route::factor, Update::automatic, true});
    condensed.live = whole.live = live;
    LiveRun part(std::move(condensed)), all(std::move(whole));
    EXPECT_TRUE(
        std::ranges::any_of(part.simulation.backend().needs().left_out,
                            [](const auto& what) { return what.starts_with("inverse of"); }));
    for (const std::vector<Index>& elements :
         {std::vector<Index>{102, 103, 104, 105, 106, 107}, std::vector<Index>{150, 151},
          std::vector<Index>{4, 160}}) {
      for (LiveRun* run : {&part, &all}) {
        run->simulation.step();
        run->simulation.remove(elements);
      }
      part.expect_fresh(kCrackTolerance);
      const auto a = part.simulation.stress(), b = all.simulation.stress();
      double most = 0, largest = 0;
      for (std::size_t e = 0; e < a.size(); ++e) {
        most = std::max(most, (a[e] - b[e]).norm());
        largest = std::max(largest, b[e].norm());
      }
      EXPECT_LE(most, 1e-9 * largest);
    }
  }
}

// A grip beyond route condensed's region, which it moves as it is: the stress that the solution is
// right to is elsewhere.
TEST(BeyondARegion, AGripHoldsWhereTheRegionIsWithoutStress) {
  LiveRun run(live_strip({"patch", Route::condensed, Update::automatic, true}));
  Simulation& s = run.simulation;
  run.drive(Vec3(0, 0, 0));
  s.step();
  const int grip = s.grasp(std::vector<Index>{30, 31, 32, 33, 34, 75, 76, 77, 78, 79});
  for (int i = 1; i <= 3; ++i) {
    s.pose(grip, {s.centre_of(grip) + Vec3(0, -0.1, 0)});
    const StepReport report = s.step();
    EXPECT_LE(report.error, s.problem().scene().solver.tolerance);
    run.expect_fresh(kCrackTolerance);
    run.expect_wrench(grip);
    double inside = 0, outside = 0;
    const auto stress = s.stress();
    for (std::size_t e = 0; e < stress.size(); ++e) {
      double& of = s.problem().breakable(static_cast<Index>(e)) ? inside : outside;
      of = std::max(of, stress[e].norm());
    }
    EXPECT_LE(inside, 1e-9 * outside);
    s.remove(std::vector<Index>{180 - 6 * i, 2 * i});
    run.expect_fresh(kCrackTolerance);
  }
  s.release(grip);
  run.drive(Vec3(0, -1, 0));
  s.step();
  run.expect_fresh(kCrackTolerance);
}

// Taken back to where it had just taken hold, it feels nothing: the region's frames had not said
// where its nodes are.
TEST(BeyondARegion, AGripThatComesBackFeelsNothing) {
  LiveRun run(live_strip({"patch", Route::condensed, Update::automatic, true}));
  Simulation& s = run.simulation;
  run.keep_history();
  const auto forces = s.grip_forces();
  ASSERT_TRUE(forces);
  s.step();
  run.drive(Vec3(0.3, -1, 0));
  s.step();
  run.drive(Vec3(0, -3, 0));  // a sum of loads that were checked
  s.step();
  const int grip = s.grasp(std::vector<Index>{30, 31, 75});
  s.remove(std::vector<Index>{150});
  ASSERT_EQ(s.undo(1).events, 1);
  ASSERT_EQ(s.held_nodes(grip).size(), 3u);
  Hand hands[1];
  hands[0].grip = grip;
  hands[0].position = s.centre_of(grip);
  static_cast<void>(forces->feel({}, {}, hands));
  EXPECT_LE(hands[0].force.norm(), 1e-9);
}

// A piece that a push loads comes loose where no frame looks: the body is checked anew.
TEST(BeyondARegion, APieceComesLoose) {
  LiveRun run(live_strip({"patch", Route::condensed, Update::automatic, true}));
  Simulation& s = run.simulation;
  run.push({29, 34, 74, 79}, Vec3(0.5, 0.2, 0));  // cell (3, 5)
  for (int i = 0; i < 3; ++i) s.step();
  std::vector<Index> around;
  for (const Index cell : {4 * 4 + 3, 4 * 6 + 3, 4 * 5 + 2, 4 * 4 + 2, 4 * 6 + 2}) {
    for (Index e = 0; e < 6; ++e) around.push_back(6 * cell + e);
  }
  s.remove(around);
  EXPECT_NE(s.piece_of(6 * (4 * 5 + 3)), kNone);
  for (int i = 0; i < 2; ++i) {
    run.expect_fresh(kCutTolerance);
    s.step();
    s.remove(std::vector<Index>{static_cast<Index>(180 + 2 * i)});
  }
  run.expect_fresh(kCutTolerance);
}

}  // namespace
}  // namespace sunder::test
