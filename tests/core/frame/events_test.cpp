// SPDX-License-Identifier: Apache-2.0
// Events of a step: what breaks first, scripts, presets, and who hears of them.
#include "sunder/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "body/element.hpp"
#include "core/frame/strip.hpp"
#include "sunder/error.hpp"
#include "sunder/stress_measures.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

TEST(ModelA, BreaksTheWorstElementFirst) {
  SceneRun run(strip(0.35, 2, 1));
  std::vector<Index> worst;
  run.simulation.observe_frames([&] {
    const auto stress = run.simulation.stress();
    const auto destroyed = run.simulation.backend().destroyed();
    Index element = kNone;
    double largest = 0;
    for (Index e = 0; e < run.problem->tet_count(); ++e) {
      const double shear = max_shear(stress[e]);
      if (!destroyed[e] && shear >= 0.35 && shear > largest) {
        largest = shear;
        element = e;
      }
    }
    if (element != kNone) worst.push_back(element);
  });
  Scene limited = run.problem->scene();
  const StepReport report = run.simulation.step();
  ASSERT_GT(report.events, 3);
  ASSERT_EQ(worst.size(), run.simulation.destroyed().size());
  for (std::size_t i = 0; i < worst.size(); ++i) {
    const DestroyedElement& d = run.simulation.destroyed()[i];
    EXPECT_EQ(d.element, worst[i]);
    EXPECT_EQ(d.event, static_cast<int>(i));
    EXPECT_EQ(d.cause, Cause::mss);
    EXPECT_EQ(d.crack, kNone);
    EXPECT_TRUE(d.ratio && *d.ratio >= 1);
    EXPECT_DOUBLE_EQ(d.load_factor, 1);
  }
  EXPECT_LT(report.max_yield_ratio, 1);
  EXPECT_TRUE(run.simulation.cracks().empty());
}

TEST(ModelA, MaxEventsEndsTheStepWithAWarning) {
  Scene scene = strip(0.35, 2, 2);
  scene.fracture.max_events = 2;
  scene.instruments[0].ramp.reset();
  SceneRun run(std::move(scene));
  EXPECT_EQ(run.simulation.step().events, 2);
  EXPECT_TRUE(mentions(run.simulation.warnings(), "max_events = 2"));
  EXPECT_EQ(run.simulation.step().events, 2);
  EXPECT_EQ(run.simulation.destroyed().back().event, 3);
}

TEST(ModelA, TrescaIsTwiceTheShear) {
  Scene scene = strip(0.7, 2, 1);
  SceneRun shear(strip(0.35, 2, 1));
  scene.fracture.yield_measure = YieldMeasure::tresca;
  SceneRun tresca(std::move(scene));
  shear.all();
  tresca.all();
  ASSERT_EQ(shear.simulation.destroyed().size(), tresca.simulation.destroyed().size());
  for (std::size_t i = 0; i < shear.simulation.destroyed().size(); ++i) {
    EXPECT_EQ(shear.simulation.destroyed()[i].element, tresca.simulation.destroyed()[i].element);
  }
}

TEST(ModelNone, BreaksNothingByItself) {
  Scene scene = strip(0.01, 2, 2);
  scene.fracture.model = FractureModel::none;
  SceneRun run(std::move(scene));
  EXPECT_FALSE(run.simulation.backend().needs().damage);
  for (const StepReport& r : run.all()) {
    EXPECT_EQ(r.destroyed, 0);
    EXPECT_GT(r.max_yield_ratio, 1);
  }
}

TEST(Scripts, TakeElementsOutBeforeTheFirstSolveOfTheirStep) {
  Scene scene = strip(1e9, 2, 3);
  scene.fracture.model = FractureModel::none;
  scene.instruments[0].ramp.reset();
  scene.removals.push_back({1, std::vector<Index>{40, 20, 30}});
  scene.removals.push_back({1, std::vector<Index>{30, 50}});
  scene.removals.push_back({2, std::vector<Index>{20}});
  SceneRun run(std::move(scene));
  const double intact = run.simulation.step().compliance;
  const StepReport second = run.simulation.step();
  EXPECT_EQ(second.events, 1);
  EXPECT_EQ(second.destroyed, 4);
  EXPECT_GT(second.compliance, intact * (1 + 1e-6)) << "must act in its own step";
  std::vector<Index> order;
  for (const DestroyedElement& d : run.simulation.destroyed()) {
    order.push_back(d.element);
    EXPECT_EQ(d.step, 1);
    EXPECT_EQ(d.event, 0);
    EXPECT_EQ(d.cause, Cause::script);
    EXPECT_FALSE(d.ratio);
    EXPECT_EQ(d.crack, kNone);
    EXPECT_DOUBLE_EQ(d.load_factor, 2.0 / 3);
  }
  EXPECT_EQ(order, (std::vector<Index>{20, 30, 40, 50}));
  EXPECT_TRUE(mentions(run.simulation.warnings(), "destroy 1 in step 1: 1 of its elements"));
  const StepReport third = run.simulation.step();
  EXPECT_EQ(third.events, 0);
  EXPECT_EQ(third.destroyed, 4);
  EXPECT_TRUE(mentions(run.simulation.warnings(), "destroy 2 in step 2"));
  EXPECT_TRUE(run.simulation.cracks().empty());
}

TEST(Scripts, MayTakeUnbreakableElements) {
  Scene scene = strip(1, 2, 1);
  scene.materials["board"].yield.reset();
  scene.removals.push_back({0, std::vector<Index>{100}});
  SceneRun run(std::move(scene));
  EXPECT_EQ(run.all()[0].destroyed, 1);
}

TEST(Presets, AreEventZeroOfStepZero) {
  for (FractureModel model : {FractureModel::none, FractureModel::a, FractureModel::b}) {
    SceneRun run(notched(model));
    run.simulation.step();
    ASSERT_GE(run.simulation.destroyed().size(), 6u);
    for (int i = 0; i < 6; ++i) {
      const DestroyedElement& d = run.simulation.destroyed()[i];
      EXPECT_EQ(d.element, 6 * 19 + i);
      EXPECT_EQ(d.event, 0);
      EXPECT_EQ(d.step, 0);
      EXPECT_EQ(d.cause, Cause::preset);
      EXPECT_DOUBLE_EQ(d.load_factor, 0.5);
    }
  }
}

// An unbreakable board with a preset crack under model B: nothing can grow, nothing may fail.
TEST(Presets, OnAnUnbreakableBoard) {
  for (bool stress : {true, false}) {
    Scene scene = notched(FractureModel::b);
    scene.materials["board"].yield.reset();
    scene.output.stress = stress;
    SceneRun run(std::move(scene));
    for (const StepReport& r : run.all()) EXPECT_EQ(r.destroyed, 6);
  }
}

TEST(Observer, InterruptsAfterAnEventAndLeavesTheStateConsistent) {
  SceneRun run(strip(0.35, 2, 2));
  int events = 0;
  run.simulation.observe_events([&](std::span<const DestroyedElement> d) {
    EXPECT_EQ(d.size(), 1u);
    return ++events < 2;
  });
  const int first = run.simulation.step().events;
  const int second = run.simulation.step().events;
  EXPECT_EQ(first + second, events);
  EXPECT_GE(events, 2);
  EXPECT_TRUE(run.simulation.interrupted());
  EXPECT_EQ(run.simulation.destroyed().size(), static_cast<std::size_t>(events));
  // Fields belong together: a_e D B u with the elements destroyed by now.
  const auto displacement = run.simulation.displacement();
  const auto stress = run.simulation.stress();
  for (Index e = 0; e < run.problem->tet_count(); ++e) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int a = 0; a < 4; ++a) corners.col(a) = displacement[run.problem->mesh().tets[e][a]];
    const double scale = run.simulation.backend().destroyed()[e] ? 1e-6 : 1.0;
    const Voigt s =
        scale * fem::stress(run.problem->shape(e), run.problem->small_strain(e), corners);
    EXPECT_LE((stress[e] - s).norm(), 1e-12 * s.norm()) << e;
  }
  Vec3 sum = run.simulation.support_reaction() + run.simulation.reactions()[0];
  EXPECT_LE(sum.norm(), 1e-9 * run.simulation.reactions()[0].norm());
}

TEST(Observer, TheNextStepGoesOnAfterAnInterruption) {
  Scene scene = strip(0.35, 2, 2);
  scene.instruments[0].ramp.reset();
  SceneRun run(std::move(scene));
  bool stop = true;
  run.simulation.observe_events([&](auto) { return !stop; });
  EXPECT_EQ(run.simulation.step().events, 1);
  EXPECT_TRUE(run.simulation.interrupted());
  stop = false;
  EXPECT_GT(run.simulation.step().events, 1);
  EXPECT_FALSE(run.simulation.interrupted());
}

TEST(Observer, HearsHowFarTheStepHasCome) {
  SceneRun run(strip(0.35, 2, 2));
  std::vector<StepReport> heard;
  run.simulation.observe_frames([&] { heard.push_back(run.simulation.so_far()); });
  const StepReport report = run.simulation.step();
  // A frame for each event, and one in which nothing breaks: that is the report's.
  ASSERT_EQ(heard.size(), static_cast<std::size_t>(report.events) + 1);
  for (std::size_t i = 0; i < heard.size(); ++i) EXPECT_EQ(heard[i].events, static_cast<int>(i));
  EXPECT_EQ(heard.back().destroyed, report.destroyed);
  EXPECT_EQ(heard.back().compliance, report.compliance);
  EXPECT_EQ(heard.back().residual, report.residual);
  EXPECT_EQ(heard.back().load_factor, report.load_factor);
  EXPECT_EQ(run.simulation.so_far().compliance, 0);
}

}  // namespace
}  // namespace sunder::test
