// SPDX-License-Identifier: Apache-2.0
// Elements that a host takes out between two steps.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/frame/strip.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"

namespace sunder::test {
namespace {

/// Nothing breaks by itself.
Scene whole(int steps = 4) {
  Scene scene = strip(1e9, 2, steps);
  scene.live = true;
  return scene;
}

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

double largest(const std::vector<Vec3>& a) {
  double most = 0;
  for (const Vec3& v : a) most = std::max(most, v.norm());
  return most;
}

const std::vector<Index> kCell{6 * 17, 6 * 17 + 1, 6 * 17 + 2, 6 * 17 + 3, 6 * 17 + 4, 6 * 17 + 5};

// A removal that the scene scripts is the same change, one solution later.
TEST(Removal, IsWhatAScriptDoesAtTheSameStep) {
  for (const Route route : {Route::inverse, Route::factor, Route::condensed, Route::cg}) {
    Scene scripted = whole();
    scripted.removals.push_back({2, kCell});
    scripted.solver.route = route;
    Scene live = whole();
    live.solver.route = route;
    SceneRun script(std::move(scripted)), host(std::move(live));
    for (int step = 0; step < 4; ++step) {
      if (step == 2) host.simulation.remove(kCell);
      script.simulation.step();
      host.simulation.step();
      const auto u = script.simulation.displacement();
      EXPECT_LE(largest_difference(u, host.simulation.displacement()), 1e-9 * largest(u)) << step;
    }
    ASSERT_EQ(host.simulation.destroyed().size(), kCell.size());
    for (std::size_t i = 0; i < kCell.size(); ++i) {
      const DestroyedElement& row = host.simulation.destroyed()[i];
      EXPECT_EQ(row.element, kCell[i]);
      EXPECT_EQ(row.cause, Cause::script);
      EXPECT_EQ(row.step, 2);
      EXPECT_EQ(row.event, 0);
    }
  }
}

TEST(Removal, ShowsAtOnceUnderTheSameLoad) {
  Scene scene = whole();
  scene.instruments[0].ramp.reset();  // the same load in all steps
  SceneRun run(std::move(scene));
  run.simulation.step();
  const auto before = run.simulation.displacement();
  run.simulation.remove(kCell);
  const auto after = run.simulation.displacement();
  EXPECT_GT(largest(after), 1.01 * largest(before)) << "softer";
  EXPECT_EQ(run.simulation.steps_done(), 1);
  run.simulation.step();
  EXPECT_LE(largest_difference(after, run.simulation.displacement()), 1e-9 * largest(after));
  EXPECT_TRUE((run.simulation.support_reaction() - Vec3(0, 2, 0)).norm() < 1e-7);
}

TEST(Removal, TellsGripsAtOnce) {
  Scene scene = whole();
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -0.5, 0), Axes{7}};
  scene.instruments[0].ramp.reset();
  SceneRun run(std::move(scene));
  run.simulation.step();
  const auto forces = run.simulation.backend().instrument_forces();
  ASSERT_TRUE(forces);
  std::vector<double> d(static_cast<std::size_t>(forces->size())), before(d.size()),
      after(d.size());
  for (std::size_t g = 0; g < d.size(); ++g) d[g] = g % 3 == 1 ? -0.5 : 0.0;
  ASSERT_TRUE(forces->forces(d, before));
  run.simulation.remove(kCell);
  ASSERT_TRUE(forces->forces(d, after));
  double felt = 0, sum_before = 0;
  for (std::size_t g = 1; g < d.size(); g += 3) felt += after[g], sum_before += before[g];
  EXPECT_LT(std::abs(felt), 0.99 * std::abs(sum_before));
  EXPECT_NEAR(felt, run.simulation.reactions()[0].y(), 1e-9);
}

TEST(Removal, ComesAfterPresetsBeforeTheFirstStep) {
  SceneRun run(notched(FractureModel::a));
  run.simulation.remove(std::vector<Index>{0});
  run.simulation.step();
  const auto& rows = run.simulation.destroyed();
  ASSERT_GE(rows.size(), 7U);
  EXPECT_EQ(rows[0].cause, Cause::preset);
  EXPECT_EQ(rows[0].event, 0);
  EXPECT_EQ(rows[6].cause, Cause::script);
  EXPECT_EQ(rows[6].event, 1);
}

TEST(Removal, CutsAPieceOff) {
  SceneRun run(whole());
  run.simulation.step();
  std::vector<Index> across;  // a row of cells through the strip
  for (Index e = 6 * 4 * 5; e < 6 * 4 * 6; ++e) across.push_back(e);
  run.simulation.remove(across);
  EXPECT_TRUE(mentions(run.simulation.warnings(), "cut off"));
}

TEST(Removal, RefusesWhatItCannotTakeAndChangesNothing) {
  const auto refused = [](Simulation& simulation, std::vector<Index> elements,
                          const std::string& why) {
    try {
      simulation.remove(elements);
      ADD_FAILURE() << why;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  SceneRun run(whole());
  refused(run.simulation, {-1}, "element -1");
  refused(run.simulation, {192}, "none of that number");
  refused(run.simulation, {5, 7, 5}, "element 5 cannot be removed: it is named twice");
  run.simulation.remove(std::vector<Index>{5});
  refused(run.simulation, {4, 5}, "gone already");
  EXPECT_EQ(run.simulation.destroyed().size(), 1U);
  run.simulation.remove({});
  EXPECT_EQ(run.simulation.destroyed().size(), 1U);

  SceneRun preset(notched(FractureModel::a));
  refused(preset.simulation, {6 * (3 + 4 * 4)}, "preset crack");

  Scene none = whole();
  none.live = false;
  none.fracture.model = FractureModel::none;
  SceneRun fixed(std::move(none));
  refused(fixed.simulation, {5}, "live");
}

// The clock decides how many events a step has, but not what the sequence is.
TEST(TimeBound, LeavesWhatIsLeftToTheNextStep) {
  Scene scene = strip(0.35, 2, 200);
  scene.instruments[0].ramp.reset();
  SceneRun whole_step(scene), bounded(scene);
  const int all = whole_step.simulation.step().events;
  ASSERT_GT(all, 3);
  int events = 0, steps = 0;
  for (; events < all && steps < 200; ++steps) {
    const StepReport report = bounded.simulation.step_within(1e-6);
    EXPECT_EQ(report.events, 1);
    EXPECT_TRUE(report.out_of_time);
    EXPECT_FALSE(bounded.simulation.interrupted());
    EXPECT_GE(report.max_yield_ratio, 0);
    events += report.events;
  }
  EXPECT_EQ(steps, all);
  const StepReport last = bounded.simulation.step_within(1e-6);
  EXPECT_EQ(last.events, 0);
  EXPECT_FALSE(last.out_of_time);
  for (std::size_t i = 0; i < whole_step.simulation.destroyed().size(); ++i) {
    EXPECT_EQ(bounded.simulation.destroyed()[i].element,
              whole_step.simulation.destroyed()[i].element);
  }
  EXPECT_TRUE(mentions(bounded.simulation.warnings(), "ended by time"));
  EXPECT_FALSE(mentions(whole_step.simulation.warnings(), "ended by time"));
}

TEST(TimeBound, OfTheSceneHoldsForItsSteps) {
  Scene scene = strip(0.35, 2, 2);
  scene.instruments[0].ramp.reset();
  scene.solver.max_ms = 1e-6;
  SceneRun run(scene);
  EXPECT_EQ(run.simulation.step().events, 1);
  EXPECT_GT(run.simulation.step_within(0).events, 1) << "none";
  EXPECT_THROW(run.simulation.step_within(-1), UsageError);
  EXPECT_THROW(run.simulation.step_within(NAN), UsageError);
  for (const double wrong : {-1.0, HUGE_VAL, double{NAN}}) {
    scene.solver.max_ms = wrong;
    EXPECT_THROW(Problem{scene}, InputError) << wrong;
  }
}

}  // namespace
}  // namespace sunder::test
