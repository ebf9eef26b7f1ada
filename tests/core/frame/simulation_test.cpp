// SPDX-License-Identifier: Apache-2.0
// The frame: time and ramps, presets and scripts, events, reports, warnings, misuse.
#include "sunder/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "body/element.hpp"
#include "body/pieces.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "sunder/error.hpp"
#include "sunder/stress_measures.hpp"
#include "support/structured_board.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

Box band(double low, double high) { return {Vec3(-1, low, -1), Vec3(99, high, 9)}; }

/// 4 x 8 x 1 cells, fixed at y = 8, pulled down at y = 0; 192 elements.
Scene strip(double yield, double force, int steps) {
  Scene scene;
  scene.mesh = structured_board({4, 8, 1, 4, 8, 1});
  scene.materials["board"] = {5, 0.3, yield};
  scene.supports.push_back({band(7.9, 9), Axes{7}});
  Instrument forceps;
  forceps.name = "forceps";
  forceps.action = Pull{band(-1, 0.1), Vec3(0, -force, 0)};
  forceps.ramp = Ramp{0, 1};
  scene.instruments.push_back(forceps);
  scene.steps = steps;
  scene.fracture.model = FractureModel::a;
  return scene;
}

struct SceneRun {
  explicit SceneRun(Scene scene)
      : problem(std::make_shared<Problem>(std::move(scene))),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {}

  std::vector<StepReport> all() {
    std::vector<StepReport> reports;
    while (!simulation.done()) reports.push_back(simulation.step());
    return reports;
  }

  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

bool mentions(const std::vector<std::string>& warnings, const std::string& part) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

TEST(Frame, LoadFollowsSceneTime) {
  SceneRun run(strip(1e9, 2, 4));
  std::vector<double> compliance;
  for (const StepReport& r : run.all()) {
    EXPECT_DOUBLE_EQ(r.load_factor, (r.step + 1) / 4.0);
    EXPECT_EQ(r.events, 0);
    compliance.push_back(r.compliance);
  }
  // Displacement grows with the force, so force times displacement with its square.
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(compliance[i], compliance[3] * (i + 1) * (i + 1) / 16.0, 1e-10 * compliance[3]);
  }
  EXPECT_EQ(run.simulation.steps_done(), 4);
}

TEST(Frame, StepAfterTheLastIsMisuse) {
  SceneRun run(strip(1e9, 2, 1));
  EXPECT_FALSE(run.simulation.done());
  run.simulation.step();
  EXPECT_TRUE(run.simulation.done());
  EXPECT_THROW(run.simulation.step(), UsageError);
}

TEST(Frame, SupportsAndInstrumentsBalance) {
  SceneRun run(strip(0.6, 3, 3));
  for (int i = 0; i < 3; ++i) {
    run.simulation.step();
    Vec3 sum = run.simulation.support_reaction();
    double largest = 0;
    for (const Vec3& r : run.simulation.reactions()) {
      sum += r;
      largest = std::max(largest, r.norm());
    }
    EXPECT_TRUE(sum.norm() <= 1e-9 * largest) << sum.norm();
    EXPECT_EQ(run.simulation.reactions()[0], Vec3(0, -3 * (i + 1) / 3.0, 0));
  }
}

TEST(Frame, ZeroLoadBreaksNothing) {
  SceneRun run(strip(0.1, 0, 2));
  for (const StepReport& r : run.all()) {
    EXPECT_EQ(r.events, 0);
    EXPECT_EQ(r.max_yield_ratio, 0);
    EXPECT_EQ(r.residual, 0);
    EXPECT_EQ(r.error, 0);
    EXPECT_EQ(r.compliance, 0);
  }
}

TEST(Frame, NoLoadAtAll) {
  Scene scene = strip(0.1, 0, 1);
  scene.instruments.clear();
  SceneRun run(std::move(scene));
  EXPECT_EQ(run.all()[0].compliance, 0);
  EXPECT_TRUE(run.simulation.reactions().empty());
  EXPECT_EQ(run.simulation.support_reaction(), Vec3(0, 0, 0));
}

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

Scene notched(FractureModel model) {
  Scene scene = strip(0.9, 2, 2);
  scene.fracture.model = model;
  std::vector<Index> notch;
  for (Index e = 6 * (3 + 4 * 4); e < 6 * (4 + 4 * 4); ++e) notch.push_back(e);  // cell (3, 4)
  scene.cracks.push_back({notch, Vec3(4, 4.5, 0.5), {Vec3(3, 4.5, 0.5)}});
  return scene;
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

TEST(Needs, FollowTheScene) {
  const auto needs = [](const std::function<void(Scene&)>& change) {
    Scene scene = strip(0.5, 2, 1);
    change(scene);
    return needs_of(Problem(std::move(scene)));
  };
  const Needs a = needs([](Scene&) {});
  EXPECT_TRUE(a.stress && a.yield && a.damage && !a.pristine);
  const Needs b = needs([](Scene& s) { s.fracture.model = FractureModel::b; });
  EXPECT_TRUE(b.stress && b.yield && b.damage && b.pristine);
  const Needs present = needs([](Scene& s) {
    s.fracture.model = FractureModel::b;
    s.fracture.sigma0 = RemoteStress::present;
  });
  EXPECT_TRUE(present.stress && present.damage && !present.pristine);
  const Needs quiet = needs([](Scene& s) {
    s.fracture.model = FractureModel::none;
    s.output.stress = false;
  });
  EXPECT_FALSE(quiet.stress || quiet.yield || quiet.damage || quiet.pristine);
  EXPECT_FALSE(quiet.left_out.empty());
  const Needs script = needs([](Scene& s) {
    s.fracture.model = FractureModel::none;
    s.removals.push_back({0, std::vector<Index>{0}});
  });
  EXPECT_TRUE(script.damage);
}

TEST(Needs, StressThatWasLeftOutIsMisuse) {
  Scene scene = strip(0.5, 2, 1);
  scene.fracture.model = FractureModel::none;
  scene.output.stress = false;
  SceneRun run(std::move(scene));
  EXPECT_THROW((void)run.simulation.stress(), UsageError);
  run.simulation.step();
  EXPECT_THROW((void)run.simulation.stress(), UsageError);
}

TEST(Needs, ABackendThatOffersLessIsRefused) {
  const auto problem = std::make_shared<Problem>(strip(0.5, 2, 1));
  EXPECT_THROW(Simulation(problem, cpu_reference::create(problem, Needs{})), UsageError);
  EXPECT_THROW(Simulation(problem, nullptr), UsageError);
  const auto other = std::make_shared<Problem>(strip(0.5, 2, 1));
  EXPECT_THROW(Simulation(problem, cpu_reference::create(other, needs_of(*other))), UsageError);
}

TEST(Determinism, TwoRunsAgreeToTheLastBit) {
  for (FractureModel model : {FractureModel::a, FractureModel::b}) {
    Scene scene = notched(model);
    scene.materials["board"].yield = 0.35;
    SceneRun first(scene), second(scene);
    const auto a = first.all(), b = second.all();
    ASSERT_GT(first.simulation.destroyed().size(), 6u);
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].compliance, b[i].compliance);
      EXPECT_EQ(a[i].residual, b[i].residual);
      EXPECT_EQ(a[i].error, b[i].error);
      EXPECT_EQ(a[i].events, b[i].events);
    }
    EXPECT_EQ(first.simulation.displacement(), second.simulation.displacement());
    EXPECT_EQ(first.simulation.stress(), second.simulation.stress());
    ASSERT_EQ(first.simulation.destroyed().size(), second.simulation.destroyed().size());
    for (std::size_t i = 0; i < first.simulation.destroyed().size(); ++i) {
      const auto &d = first.simulation.destroyed()[i], &e = second.simulation.destroyed()[i];
      EXPECT_EQ(d.element, e.element);
      EXPECT_EQ(d.ratio, e.ratio);
    }
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

TEST(Grips, RampAndReactions) {
  Scene scene = strip(1e9, 0, 4);
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -0.4, 0), Axes{2}};
  SceneRun run(std::move(scene));
  for (int i = 1; i <= 4; ++i) {
    const StepReport report = run.simulation.step();
    const double moved = -0.4 * i / 4.0;
    EXPECT_DOUBLE_EQ(run.simulation.displacement()[0].y(), moved);
    const Vec3 reaction = run.simulation.reactions()[0];
    EXPECT_LT(reaction.y(), 0);
    EXPECT_EQ(reaction.x(), 0);
    EXPECT_NEAR(report.compliance, reaction.y() * moved, 1e-12 * std::abs(report.compliance));
    EXPECT_LE(std::abs(run.simulation.support_reaction().y() + reaction.y()),
              1e-9 * std::abs(reaction.y()));
  }
}

/// A strip that a grip pulls: its strain is that of the board's ends, some more at the corners.
StepReport stretched(double strain, std::vector<std::string>& warnings) {
  Scene scene = strip(1e9, 0, 2);
  scene.fracture.model = FractureModel::none;
  scene.materials["board"].poisson = 0;  // so that nothing narrows: one strain everywhere
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -8 * strain, 0), Axes{7}};
  SceneRun run(std::move(scene));
  run.simulation.step();
  const StepReport report = run.simulation.step();
  warnings = run.simulation.warnings();
  return report;
}

TEST(SmallStrain, IsWarnedOfFromTenPercent) {
  std::vector<std::string> warnings;
  EXPECT_NEAR(stretched(0.099, warnings).deformation.value().strain, 0.099, 1e-8);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_NEAR(stretched(0.101, warnings).deformation.value().strain, 0.101, 1e-8);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("step 1 strained live tissue by over 10 % (most in step 1: 10.1 %)"),
            std::string::npos)
      << warnings[0];
  EXPECT_NEAR(stretched(-0.101, warnings).deformation.value().strain, -0.101, 1e-8);
  EXPECT_TRUE(mentions(warnings, "strained live tissue"));
}

/// Simple shear turns by atan(shear / 2) and strains by half of it; the linear body has no say in
/// it, as all its nodes are gripped but for one layer.
StepReport turned(double degrees, std::vector<std::string>& warnings) {
  Scene scene = strip(1e9, 0, 1);
  scene.fracture.model = FractureModel::none;
  scene.materials["board"].poisson = 0;
  scene.mesh = structured_board({4, 1, 1, 4, 1, 1});
  scene.supports = {{band(0.9, 2), Axes{7}}};
  const double radians = degrees * std::numbers::pi / 180;
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(2 * std::tan(radians), 0, 0), Axes{7}};
  SceneRun run(std::move(scene));
  const StepReport report = run.simulation.step();
  warnings = run.simulation.warnings();
  return report;
}

TEST(SmallRotation, IsWarnedOfFromTenDegrees) {
  std::vector<std::string> warnings;
  EXPECT_NEAR(turned(9.9, warnings).deformation.value().rotation_deg, 9.9, 1e-6);
  EXPECT_FALSE(mentions(warnings, "turned live tissue"));
  EXPECT_NEAR(turned(10.1, warnings).deformation.value().rotation_deg, 10.1, 1e-6);
  EXPECT_TRUE(mentions(warnings, "step 0 turned live tissue by over 10 deg (most in step 0: 10.1"));
}

TEST(Inversion, IsWarnedOfWithTheNumberOfElements) {
  std::vector<std::string> warnings;
  EXPECT_EQ(stretched(-0.99, warnings).deformation.value().inverted, 0);
  EXPECT_FALSE(mentions(warnings, "inside out"));
  EXPECT_EQ(stretched(-1.01, warnings).deformation.value().inverted, 192);
  EXPECT_TRUE(mentions(warnings, "step 1 turned live elements inside out (most in step 1: 192"));
}

TEST(Deformation, IsNotMeasuredWhereNobodyAsksForStress) {
  Scene scene = strip(1e9, 2, 1);
  scene.fracture.model = FractureModel::none;
  scene.output.stress = false;
  SceneRun run(std::move(scene));
  EXPECT_FALSE(run.simulation.step().deformation);
  EXPECT_TRUE(mentions(run.simulation.backend().needs().left_out, "largest strain and rotation"));
}

TEST(Deformation, OfAPieceCutOffDoesNotCount) {
  const auto measured = [](bool cut) {
    Scene scene = strip(1e9, 0.001, 2);
    scene.fracture.model = FractureModel::none;
    scene.solver.tolerance = 1e-3;
    if (cut) scene.removals.push_back({1, Box{Vec3(0, 4, 0), Vec3(4, 5, 1)}});
    SceneRun run(std::move(scene));
    run.simulation.step();
    return run.simulation.step().deformation.value();
  };
  // The piece is pulled off by alpha of the stiffness; what is held keeps almost no load.
  EXPECT_GT(std::abs(measured(false).strain), 1e-5);
  EXPECT_LT(std::abs(measured(true).strain), 1.1 * std::abs(measured(false).strain));
  EXPECT_LT(measured(true).rotation_deg, 1.1 * measured(false).rotation_deg + 1e-6);
}

// Pressure on a surface up to a plane of symmetry: what acts on the held axis goes into the
// reaction, and the body moves as if that part were not there.
TEST(Frame, ForcesOnHeldAxesGoIntoTheReaction) {
  const auto scene = [](bool held_part) {
    Scene s = strip(1e9, 0, 1);
    s.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(0.1, 9, 9)}, Axes{1}});  // symmetry: x = 0
    Instrument& forceps = s.instruments[0];
    // Ten nodes at y = 0, two of which are held along x.
    forceps.action = Pull{band(-1, 0.1), Vec3(held_part ? 10 : 0, -20, 0)};
    forceps.ramp.reset();
    if (!held_part) {
      Instrument free = forceps;
      free.name = "free";
      free.action = Pull{Box{Vec3(0.9, -1, -1), Vec3(9, 0.1, 9)}, Vec3(8, 0, 0)};
      s.instruments.push_back(free);
    }
    return s;
  };
  SceneRun with(scene(true)), without(scene(false));
  with.simulation.step();
  without.simulation.step();
  EXPECT_TRUE(mentions(with.simulation.warnings(), "x of 2 nodes out of 10"));
  const auto u = with.simulation.displacement(), expected = without.simulation.displacement();
  double largest = 0;
  for (const Vec3& v : expected) largest = std::max(largest, v.norm());
  for (std::size_t n = 0; n < u.size(); ++n)
    EXPECT_LE((u[n] - expected[n]).norm(), 1e-10 * largest) << n;
  const Vec3 sum = with.simulation.support_reaction() + Vec3(10, -20, 0);
  EXPECT_LE(sum.norm(), 1e-9 * 20);
  EXPECT_LE(std::abs(with.simulation.support_reaction().x() -
                     (without.simulation.support_reaction().x() - 2)),
            1e-9 * 20);
}

// What nothing holds stays where it is; what hangs by a node turns freely; neither disturbs the
// rest, on any route.
TEST(Frame, UnusedNodesAndLooseBodiesDisturbNothing) {
  const Scene plain = strip(1e9, 2, 1);
  SceneRun alone(plain);
  alone.simulation.step();
  const auto expected = alone.simulation.displacement();
  for (const Route route : {Route::inverse, Route::factor, Route::cg}) {
    Scene scene = plain;
    scene.solver.route = route;
    const Index own = scene.mesh.node_count();
    for (const Vec3& x : {Vec3(90, 90, 90), Vec3(20, 30, 0), Vec3(21, 30, 0), Vec3(20, 31, 0),
                          Vec3(20, 30, 1), Vec3(5, 4, 0), Vec3(5, 3, 0), Vec3(5, 4, 1)})
      scene.mesh.nodes.push_back(x);
    const Index corner = 4 + 5 * 4;
    ASSERT_EQ(scene.mesh.nodes[corner], Vec3(4, 4, 0));
    scene.mesh.tets.push_back({own + 1, own + 2, own + 3, own + 4});
    scene.mesh.tets.push_back({corner, own + 5, own + 6, own + 7});
    scene.mesh.volume_of.insert(scene.mesh.volume_of.end(), 2, 0);
    SceneRun run(std::move(scene));
    run.simulation.step();
    const std::vector<std::string> warnings = run.simulation.warnings();
    EXPECT_TRUE(mentions(warnings, "1 element of negative volume was turned"));
    EXPECT_TRUE(mentions(warnings, "nothing holds or drives it"));
    EXPECT_TRUE(mentions(warnings, "1 part hangs on the rest"));
    const auto u = run.simulation.displacement();
    for (Index n = 0; n < own; ++n)
      EXPECT_LE((u[n] - expected[n]).norm(), 1e-9 * expected[0].norm()) << n;
    for (Index n = own; n < own + 5; ++n) EXPECT_EQ(u[n], Vec3(0, 0, 0));
    for (const Vec3& v : u) EXPECT_LE(v.norm(), 100 * expected[0].norm());
  }
}

// A strip cut through: reported once, with what is cut off; the rest stays finite and right.
TEST(LooseParts, AreReported) {
  Scene scene = strip(1e9, 0.001, 2);
  scene.fracture.model = FractureModel::none;
  scene.solver.tolerance = 1e-3;
  scene.removals.push_back({1, Box{Vec3(0, 4, 0), Vec3(4, 5, 1)}});  // a row of cells
  SceneRun run(std::move(scene));
  run.simulation.step();
  EXPECT_TRUE(run.simulation.warnings().empty());
  run.simulation.step();
  EXPECT_TRUE(
      mentions(run.simulation.warnings(), "1 piece with 96 elements is cut off (since step 1)"));
  for (const Vec3& u : run.simulation.displacement()) EXPECT_TRUE(u.allFinite());
}

TEST(LooseParts, ByHand) {
  Scene scene = strip(1, 1, 1);
  const Problem problem(std::move(scene));
  std::vector<std::uint8_t> destroyed(192, 0);
  EXPECT_TRUE(find_loose_parts(problem, destroyed).none());
  for (Index e = 0; e < 48; ++e) destroyed[e] = 1;  // the two lowest rows
  LooseParts parts = find_loose_parts(problem, destroyed);
  EXPECT_EQ(parts.isolated_nodes.size(), 20u);  // y = 0 and y = 1, five by two each
  EXPECT_TRUE(parts.pieces.empty());
  std::fill(destroyed.begin(), destroyed.begin() + 24, 0);  // only the second row is out
  parts = find_loose_parts(problem, destroyed);
  EXPECT_TRUE(parts.isolated_nodes.empty());
  ASSERT_EQ(parts.pieces.size(), 1u);
  EXPECT_EQ(parts.pieces[0].size(), 24u);
}

// A frame that fails leaves the last good fields readable: "results so far".
TEST(Failure, LeavesTheLastFieldsReadable) {
  Scene scene = strip(1e9, 1e308, 2);
  scene.instruments[0].ramp = Ramp{0.5, 0.5};
  scene.instruments.push_back(scene.instruments[0]);
  scene.instruments[0].ramp = Ramp{0.6, 0.6};
  scene.instruments[1].name = "gentle";
  std::get<Pull>(scene.instruments[1].action).force = Vec3(0, -1, 0);
  SceneRun run(std::move(scene));
  run.simulation.step();
  const auto u = run.simulation.displacement();
  const auto stress = run.simulation.stress();
  EXPECT_THROW(run.simulation.step(), NumericalError);
  EXPECT_EQ(run.simulation.steps_done(), 1);
  EXPECT_EQ(run.simulation.displacement(), u);
  EXPECT_EQ(run.simulation.stress(), stress);
}

TEST(Frame, BeforeTheFirstStep) {
  SceneRun run(strip(1, 1, 1));
  EXPECT_EQ(run.simulation.displacement()[0], Vec3(0, 0, 0));
  EXPECT_EQ(run.simulation.stress()[0], Voigt(Voigt::Zero()));
  EXPECT_EQ(run.simulation.acting_nodes(0).size(), 10u);
}

}  // namespace
}  // namespace sunder::test
