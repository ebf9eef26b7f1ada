// SPDX-License-Identifier: Apache-2.0
// The frame: time and ramps, needs, grips, reactions, misuse.
#include "sunder/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/frame/strip.hpp"
#include "sunder/error.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

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

TEST(Frame, StagesTakeTheirOwnTime) {
  SceneRun torn(strip(0.6, 3, 3));  // solves several times a step
  for (const StepReport& r : torn.all()) {
    const StageTimes& t = r.times;
    EXPECT_GT(t.solve, 0) << "without its stress";
    EXPECT_GT(t.stress, 0);
    EXPECT_LE(t.load + t.solve + t.stress + t.decide + t.update, t.total + 1e-9);
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
