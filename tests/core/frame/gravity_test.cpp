// SPDX-License-Identifier: Apache-2.0
// Gravity in statics: stretch of a hanging bar, reactions, what a piece that falls off weighs.
#include <gtest/gtest.h>

#include <cmath>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

constexpr double kSoftYoung = 0.01, kOfWater = 1e-9, kDownwards = 9810, kLength = 8;
constexpr double kWeight = kLength * 2 * 2 * kOfWater * kDownwards;

/// A bar of 8 x 2 x 2 mm that hangs from x = 0 along x, of nu 0: it stretches by rho g L^2 / (2 E).
Scene hanging(MaterialLaw law = MaterialLaw::linear) {
  Scene scene;
  scene.mesh = structured_board({8, 2, 2, kLength, 2, 2});
  scene.materials["board"] = {kSoftYoung, 0, {}, law, kOfWater};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
  scene.gravity = Vec3(kDownwards, 0, 0);
  return scene;
}

std::unique_ptr<Simulation> weighed(Scene scene) {
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  return std::make_unique<Simulation>(problem, cpu_reference::create(problem, needs_of(*problem)));
}

/// Of the lower end, along the bar.
double stretch(const Simulation& simulation) {
  double sum = 0;
  int count = 0;
  for (Index n = 0; n < simulation.problem().node_count(); ++n) {
    if (simulation.problem().mesh().nodes[n].x() < kLength - 1e-6) continue;
    sum += simulation.displacement()[n].x();
    ++count;
  }
  return sum / count;
}

TEST(Gravity, AHangingBarStretchesAndItsSupportHoldsIt) {
  const double expected = kOfWater * kDownwards * kLength * kLength / (2 * kSoftYoung);
  for (const Route route : {Route::automatic, Route::factor, Route::inverse, Route::cg}) {
    Scene scene = hanging();
    scene.solver.route = route;
    const auto simulation = weighed(scene);
    simulation->step();
    EXPECT_NEAR(stretch(*simulation), expected, 0.01 * expected);
    EXPECT_NEAR(simulation->support_reaction().x(), -kWeight, 1e-9 * kWeight);
  }
  for (const MaterialLaw law : {MaterialLaw::corotated, MaterialLaw::neo_hookean}) {
    const auto simulation = weighed(hanging(law));
    simulation->step();
    EXPECT_NEAR(stretch(*simulation), expected, 0.02 * expected);
    EXPECT_NEAR(simulation->support_reaction().x(), -kWeight, 1e-5 * kWeight);
  }
}

// Held by a grip in place of a support: its reaction is the whole weight, that of its nodes too.
TEST(Gravity, AGripHoldsTheWholeWeight) {
  for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::corotated}) {
    Scene scene = hanging(law);
    Instrument hand;
    hand.name = "hand";
    hand.action = Grip{scene.supports.front().nodes, Vec3::Zero(), Axes{7}};
    scene.supports.clear();
    scene.instruments.push_back(hand);
    const auto simulation = weighed(scene);
    simulation->step();
    EXPECT_NEAR(simulation->reactions().front().x(), -kWeight, 1e-5 * kWeight);
    EXPECT_NEAR(simulation->support_reaction().norm(), 0, 1e-12);
  }
}

// Nothing would hold a piece up but the small stiffness that destroyed elements keep.
TEST(Gravity, WhatIsCutOffWeighsNothing) {
  for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::corotated}) {
    Scene scene = hanging(law);
    scene.steps = 2;
    scene.removals.push_back({1, Box{Vec3(4.01, -1, -1), Vec3(4.99, 9, 9)}});
    const auto simulation = weighed(scene);
    simulation->step();
    const double whole = simulation->displacement().back().x();
    simulation->step();
    // Of the destroyed column, 1 mm long, half hangs on the part that is held.
    const double held = kWeight * 4.5 / kLength;
    EXPECT_NEAR(simulation->support_reaction().x(), -held, 0.02 * kWeight);
    EXPECT_LE(std::abs(simulation->displacement().back().x()), 2 * whole);
  }
}

// The same displacement as by point loads: superposition with an instrument.
TEST(Gravity, AddsToInstruments) {
  const auto at_end = [](bool gravity, double force) {
    Scene scene = hanging();
    if (!gravity) scene.gravity = Vec3::Zero();
    Instrument pull;
    pull.name = "pull";
    pull.action = Pull{Box{Vec3(8 - 1e-6, -1, -1), Vec3(9, 9, 9)}, Vec3(0, force, 0)};
    scene.instruments.push_back(pull);
    const auto simulation = weighed(scene);
    simulation->step();
    return simulation->displacement().back();
  };
  const Vec3 both = at_end(true, 1e-5), sum = at_end(true, 0) + at_end(false, 1e-5);
  EXPECT_LE((both - sum).norm(), 1e-9 * both.norm());
}

TEST(Gravity, RouteCondensedSaysWhyNot) {
  Scene scene = hanging();
  scene.materials["board"].yield = 100.0;
  scene.fracture.model = FractureModel::a;
  scene.solver.route = Route::condensed;
  try {
    weighed(scene);
    FAIL() << "not refused";
  } catch (const DeviceError& error) {
    EXPECT_TRUE(mentions(error.what(), "gravity loads the whole body; use route factor or cg"));
  }
  scene.solver.route = Route::automatic;
  EXPECT_NE(weighed(scene)->backend().info().route, "condensed");
}

TEST(Gravity, NeedsADensity) {
  Scene scene = hanging();
  scene.materials["board"].density.reset();
  try {
    const Problem problem(scene);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "scene: material \"board\" has no density, which gravity needs; add density = 1e-9 "
              "(water, in t/mm^3)");
  }
}

}  // namespace
}  // namespace sunder::test
