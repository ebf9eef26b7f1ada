// SPDX-License-Identifier: Apache-2.0
// Scenes with laws of finite deformation: what a rigid turn leaves, which stress breaks an element,
// what is refused.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "cpu_reference/cpu_reference.hpp"
#include "material/law.hpp"
#include "sunder/error.hpp"
#include "sunder/scene_keys.hpp"
#include "sunder/simulation.hpp"
#include "sunder/stress_measures.hpp"
#include "support/structured_board.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

constexpr double kModulus = 5, kRatio = 0.3;

Scene solid(MaterialLaw law) {
  Scene scene;
  scene.mesh = structured_board({8, 2, 2, 8, 2, 2});
  scene.materials["board"] = {kModulus, kRatio, 2.0, law};
  return scene;
}

Instrument rigid_grip(double x, const Vec3& displacement, const Vec3& turn) {
  Instrument tool;
  tool.name = x < 4 ? "left" : "right";
  Grip held{Box{Vec3(x - 1e-6, -1, -1), Vec3(x + 1e-6, 9, 9)}, displacement, Axes{7}};
  held.rigid = true;
  held.turn = turn;
  tool.action = held;
  tool.ramp = Ramp{0, 1};
  return tool;
}

std::unique_ptr<Simulation> simulation_of(Scene scene) {
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  return std::make_unique<Simulation>(problem, cpu_reference::create(problem, needs_of(*problem)));
}

double largest(const std::vector<Voigt>& stress) {
  double most = 0;
  for (const Voigt& s : stress) most = std::max(most, s.cwiseAbs().maxCoeff());
  return most;
}

TEST(FiniteLaws, AreTheWordsOfTheirKey) {
  const auto& words = key_words("material", "law");
  ASSERT_EQ(words.size(), laws().size());
  for (std::size_t i = 0; i < words.size(); ++i) EXPECT_EQ(words[i], laws()[i]->name);
}

// Both ends turn about the strip's middle as one solid does, by hand, 30 degrees a step.
TEST(FiniteLaws, ARigidTurnLeavesNoStressAndNoRupture) {
  const Vec3 axis = Vec3(1, 2, -1).normalized();
  for (const MaterialLaw law :
       {MaterialLaw::corotated, MaterialLaw::neo_hookean, MaterialLaw::saint_venant_kirchhoff}) {
    Scene scene = solid(law);
    for (const double x : {0.0, 8.0}) {
      scene.instruments.push_back(rigid_grip(x, Vec3::Zero(), Vec3::Zero()));
    }
    scene.fracture.model = FractureModel::a;
    scene.steps = 6;
    const auto simulation = simulation_of(scene);
    while (!simulation->done()) {
      const double degrees = 30 * (simulation->steps_done() + 1);
      SCOPED_TRACE(degrees);
      const Mat3 r = Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis).toRotationMatrix();
      for (const std::size_t i : {0U, 1U}) {
        const Vec3 arm(i == 0 ? -4 : 4, 0, 0);
        simulation->drive(i, r * arm - arm);
        simulation->turn(i, degrees * axis);
      }
      const StepReport report = simulation->step();
      EXPECT_EQ(report.events, 0);
      EXPECT_LT(largest(simulation->stress()), 1e-6 * kModulus);
      ASSERT_TRUE(report.deformation);
      EXPECT_NEAR(report.deformation->rotation_deg, degrees, 1e-4);
      EXPECT_LT(std::abs(report.deformation->strain), 1e-6);
      EXPECT_EQ(report.deformation->inverted, 0);
    }
    EXPECT_TRUE(simulation->warnings().empty()) << simulation->warnings().front();
  }
}

// At law linear the same turn is a strain, and says so.
TEST(FiniteLaws, ATurnStrainsTheLinearLaw) {
  Scene scene = solid(MaterialLaw::linear);
  for (const double x : {0.0, 8.0})
    scene.instruments.push_back(rigid_grip(x, Vec3::Zero(), {0, 0, 60}));
  const auto simulation = simulation_of(scene);
  simulation->step();
  EXPECT_GT(largest(simulation->stress()), 0.1 * kModulus);
  const auto said = simulation->warnings();
  EXPECT_TRUE(std::ranges::any_of(
      said, [](const std::string& w) { return mentions(w, "the law is linear"); }));
}

// F = diag(2, a, a) and stress free sides: Cauchy and Biot differ by the area, a^2.
TEST(FiniteLaws, TheNamedStressIsWhatBreaks) {
  for (const StressMeasure measure : {StressMeasure::cauchy, StressMeasure::biot}) {
    Scene scene = solid(MaterialLaw::corotated);
    scene.materials["board"].poisson = 0.3;
    // Ends that slide in their planes: nothing but the stretch.
    scene.supports.push_back({Box{Vec3(-1e-6, -1, -1), Vec3(1e-6, 9, 9)}, Axes{1}});
    scene.supports.push_back({Box{Vec3(-1, -1e-6, -1), Vec3(9, 1e-6, 9)}, Axes{2}});
    scene.supports.push_back({Box{Vec3(-1, -1, -1e-6), Vec3(9, 9, 1e-6)}, Axes{4}});
    Instrument tool;
    tool.name = "pull";
    tool.action = Grip{Box{Vec3(8 - 1e-6, -1, -1), Vec3(8 + 1e-6, 9, 9)}, Vec3(8, 0, 0), Axes{1}};
    scene.instruments.push_back(tool);
    scene.fracture.stress = measure;
    scene.solver.tolerance = 1e-9;
    const auto simulation = simulation_of(scene);
    simulation->step();
    // Corotated: 2 mu (l - 1) + lambda (l + 2 a - 3) along, 0 = 2 mu (a - 1) + lambda (l + 2 a - 3)
    // across, so a = 1 - nu (l - 1) and P = E (l - 1).
    const double a = 1 - kRatio, p = kModulus;
    const double expected = measure == StressMeasure::cauchy ? p / (a * a) : p;
    for (const Voigt& s : simulation->stress()) EXPECT_NEAR(s[0], expected, 1e-6 * p);
    EXPECT_NEAR(simulation->reactions()[0].x(), 4 * p, 1e-6 * p);
    EXPECT_NEAR(simulation->support_reaction().x(), -4 * p, 1e-6 * p);
  }
}

TEST(FiniteLaws, RefuseWhatTheyCannot) {
  const auto refused = [](auto change, const std::string& what) {
    Scene scene = solid(MaterialLaw::corotated);
    scene.instruments.push_back(rigid_grip(0, Vec3::Zero(), Vec3::Zero()));
    change(scene.solver);
    try {
      simulation_of(scene);
      FAIL() << what;
    } catch (const DeviceError& error) {
      EXPECT_TRUE(mentions(error.what(), what)) << error.what();
      EXPECT_TRUE(mentions(error.what(), "law \"corotated\"")) << error.what();
      EXPECT_TRUE(mentions(error.what(), "use ")) << error.what();
    }
  };
  refused([](SolverOptions& s) { s.route = Route::cg; }, "route cg");
  refused([](SolverOptions& s) { s.route = Route::condensed; }, "route condensed");
  refused([](SolverOptions& s) { s.update = Update::eager; }, "update eager");
  refused([](SolverOptions& s) { s.precision = Precision::fp32; }, "precision fp32");
  Scene scene = solid(MaterialLaw::neo_hookean);
  scene.instruments.push_back(rigid_grip(0, Vec3::Zero(), Vec3::Zero()));
  EXPECT_THROW(simulation_of(scene)->attribute_events(true), UsageError);
}

// Route inverse is the same base, applied as a product: the same elements break, the same stress.
TEST(FiniteLaws, RouteInverseFindsWhatRouteFactorFinds) {
  std::vector<std::vector<Voigt>> stress;
  std::vector<std::vector<DestroyedElement>> broken;
  for (const Route route : {Route::factor, Route::inverse}) {
    Scene scene = solid(MaterialLaw::neo_hookean);
    scene.instruments.push_back(rigid_grip(0, Vec3::Zero(), Vec3::Zero()));
    scene.instruments.push_back(rigid_grip(8, Vec3(4, 1, 0), Vec3(40, 0, 0)));
    scene.fracture.model = FractureModel::a;
    scene.materials["board"].yield = 0.7;
    scene.fracture.max_events = 4;
    scene.steps = 6;
    scene.solver.route = route;
    scene.solver.tolerance = 1e-9;
    const auto simulation = simulation_of(scene);
    const auto& words = key_words("solver", "route");
    EXPECT_EQ(simulation->backend().info().route, words.at(static_cast<std::size_t>(route)));
    while (simulation->steps_done() < 4) simulation->step();
    stress.push_back(simulation->stress());
    broken.push_back(simulation->destroyed());
  }
  ASSERT_FALSE(broken[0].empty());
  ASSERT_EQ(broken[0].size(), broken[1].size());
  for (std::size_t i = 0; i < broken[0].size(); ++i) {
    EXPECT_EQ(broken[0][i].element, broken[1][i].element);
  }
  const double most = largest(stress[0]);
  for (std::size_t e = 0; e < stress[0].size(); ++e) {
    EXPECT_LT((stress[0][e] - stress[1][e]).cwiseAbs().maxCoeff(), 1e-7 * most);
  }
}

TEST(FiniteLaws, AMixedBodyNamesThemAll) {
  Scene scene = solid(MaterialLaw::corotated);
  scene.mesh.volumes.push_back({"stiff", 2});
  scene.mesh.volume_of.back() = 1;
  scene.materials["stiff"] = {50, kRatio, {}, MaterialLaw::linear};
  scene.instruments.push_back(rigid_grip(0, Vec3::Zero(), Vec3::Zero()));
  const Problem problem(scene);
  EXPECT_TRUE(problem.finite());
  EXPECT_EQ(problem.law(), "linear, corotated");
}

TEST(RigidGrip, TurnsAboutTheCentroidOfItsNodes) {
  Scene scene = solid(MaterialLaw::linear);
  scene.instruments.push_back(rigid_grip(0, Vec3::Zero(), Vec3::Zero()));
  scene.instruments.push_back(rigid_grip(8, Vec3(1, 0, 0), Vec3(0, 0, 90)));
  scene.steps = 2;
  const auto simulation = simulation_of(scene);
  simulation->step();  // half of both
  const auto expect_turned = [&](double degrees, const Vec3& moved) {
    const Mat3 r =
        Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitZ()).toRotationMatrix();
    const auto u = simulation->displacement();
    const Vec3 centre(8, 1, 1);
    for (Index n : simulation->problem().instrument_nodes()[1].nodes) {
      const Vec3 x = simulation->problem().mesh().nodes[n];
      EXPECT_LT((x + u[n] - (centre + moved + r * (x - centre))).norm(), 1e-9);
    }
  };
  expect_turned(45, Vec3(0.5, 0, 0));
  simulation->turn(1, Vec3(0, 0, 10));
  simulation->drive(1, Vec3(0, 0.25, 0));
  simulation->step();
  expect_turned(10, Vec3(0, 0.25, 0));
  EXPECT_THROW(simulation->turn(2, Vec3::Zero()), UsageError);
  EXPECT_THROW(simulation->turn(1, Vec3(0, std::nan(""), 0)), UsageError);
}

TEST(RigidGrip, HoldsAllAxesAndAloneTurns) {
  Scene scene = solid(MaterialLaw::linear);
  scene.instruments.push_back(rigid_grip(0, Vec3::Zero(), Vec3(0, 0, 5)));
  std::get<Grip>(scene.instruments[0].action).axes = Axes{3};
  EXPECT_THROW(Problem{scene}, InputError);
  std::get<Grip>(scene.instruments[0].action).axes = Axes{7};
  EXPECT_NO_THROW(Problem{scene});
  std::get<Grip>(scene.instruments[0].action).rigid = false;
  EXPECT_THROW(Problem{scene}, InputError);
}

}  // namespace
}  // namespace sunder::test
