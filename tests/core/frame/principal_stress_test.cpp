// SPDX-License-Identifier: Apache-2.0
// Model P against hand values: bodies in a uniform state that grows with time (method.md
// "Model P").
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/simulation.hpp"
#include "sunder/stress_measures.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

constexpr double kYoung = 5, kPoisson = 0.25, kStrength = 2;
constexpr int kSteps = 10;

/// Every node gripped so that the stress of the last step is `stress` everywhere.
Scene uniform(const Mat3& stress, FractureModel model) {
  const Mat3 strain =
      ((1 + kPoisson) * stress - kPoisson * stress.trace() * Mat3::Identity()) / kYoung;
  Scene scene;
  scene.mesh = structured_board({2, 2, 2, 2, 2, 2});
  scene.materials["board"] = {kYoung, kPoisson, kStrength};
  for (Index n = 0; n < scene.mesh.node_count(); ++n) {
    Instrument grip;
    grip.name = "node " + std::to_string(n);
    grip.action = Grip{std::vector<Index>{n}, strain * scene.mesh.nodes[n], Axes{7}};
    grip.ramp = Ramp{0, 1};
    scene.instruments.push_back(grip);
  }
  scene.steps = kSteps;
  scene.fracture.model = model;
  return scene;
}

std::vector<DestroyedElement> broken(Scene scene) {
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!simulation.done()) simulation.step();
  return simulation.destroyed();
}

Mat3 turned(const Mat3& stress) {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  return turn * stress * turn.transpose();
}

// The largest principal stress passes yield in step 7: 0.8 * 1.3.
void expect_breaks_in_step_7(const Mat3& stress) {
  const auto rows = broken(uniform(stress, FractureModel::p));
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows[0].step, 7);
  EXPECT_EQ(rows[0].cause, Cause::principal);
  EXPECT_STREQ(to_string(rows[0].cause), "principal");
  EXPECT_EQ(rows[0].crack, kNone);
  ASSERT_TRUE(rows[0].ratio);
  EXPECT_NEAR(*rows[0].ratio, 0.8 * 1.3, 1e-9);
}

TEST(ModelP, BreaksInTensionAtYield) {
  const Mat3 tension = Vec3(1.3 * kStrength, 0, 0).asDiagonal();
  expect_breaks_in_step_7(tension);
  expect_breaks_in_step_7(turned(tension));
  // Model A waits for twice that: (s1 - s3)/2.
  EXPECT_TRUE(broken(uniform(tension, FractureModel::a)).empty());
}

TEST(ModelP, BreaksInPureShearAtYield) {
  Mat3 shear = Mat3::Zero();
  shear(0, 1) = shear(1, 0) = 1.3 * kStrength;
  expect_breaks_in_step_7(shear);
  expect_breaks_in_step_7(turned(shear));
}

// Pull from all sides has no shear: model A never sees it.
TEST(ModelP, BreaksWherePullComesFromAllSides) {
  const Mat3 pull = 1.3 * kStrength * Mat3::Identity();
  expect_breaks_in_step_7(pull);
  EXPECT_TRUE(broken(uniform(pull, FractureModel::a)).empty());
}

TEST(ModelP, BreaksNothingInCompression) {
  const Mat3 press = Vec3(-10 * kStrength, 0, 0).asDiagonal();
  EXPECT_TRUE(broken(uniform(press, FractureModel::p)).empty());
  EXPECT_TRUE(broken(uniform(-10 * kStrength * Mat3::Identity(), FractureModel::p)).empty());
  EXPECT_FALSE(broken(uniform(press, FractureModel::a)).empty());
}

TEST(ModelP, TakesOneElementAnEvent) {
  const auto rows = broken(uniform(Vec3(1.3 * kStrength, 0, 0).asDiagonal(), FractureModel::p));
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].event, static_cast<int>(i));
}

TEST(ModelP, IsMeasuredByTheLargestPrincipalStress) {
  FractureOptions options;
  options.model = FractureModel::p;
  EXPECT_EQ(strength_measure(options), YieldMeasure::principal);
  options.model = FractureModel::a;
  EXPECT_EQ(strength_measure(options), YieldMeasure::max_shear);
  Voigt s;
  s << 1, -2, 3, 0, 0, 0;
  EXPECT_DOUBLE_EQ(yield_measure(s, YieldMeasure::principal), 3);
  s << -1, -2, -3, 0, 0, 0;
  EXPECT_DOUBLE_EQ(yield_measure(s, YieldMeasure::principal), -1);
}

TEST(ModelP, SaysThatItDoesNotReadTheYieldMeasure) {
  Scene scene = uniform(Mat3::Identity(), FractureModel::p);
  EXPECT_TRUE(Problem(scene).warnings().empty());
  scene.fracture.yield_measure = YieldMeasure::tresca;
  const auto warnings = Problem(scene).warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("yield_measure is not read: model \"P\""), std::string::npos)
      << warnings[0];
}

TEST(ModelP, RefusesAPress) {
  Scene scene = uniform(Mat3::Identity(), FractureModel::p);
  Instrument press;
  press.name = "probe";
  press.action = Press{Vec3::Zero(), CrackSide::upper, 0, Vec3(0, 1, 0)};
  scene.instruments.push_back(press);
  try {
    const Problem problem(scene);
    FAIL() << "no error";
  } catch (const InputError& error) {
    const std::string words = error.what();
    EXPECT_NE(words.find("model \"P\" keeps no cracks; use model \"B\" or \"none\""),
              std::string::npos)
        << words;
  }
}

}  // namespace
}  // namespace sunder::test
