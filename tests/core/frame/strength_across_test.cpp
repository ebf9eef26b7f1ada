// SPDX-License-Identifier: Apache-2.0
// Strength along fibres and across: closed forms, and what breaks.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "cpu_reference/cpu_reference.hpp"
#include "fibre_cubes.hpp"
#include "sunder/simulation.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::test {
namespace {

/// Of stress in every element of a cube whose fibres run along x.
Problem weak_across(double along, double across) {
  Scene scene = linear_cube();
  Material& m = scene.materials["board"];
  m.yield = along;
  m.fibres[0].yield_across = across;
  return Problem(std::move(scene));
}

Voigt along(const Vec3& n, double value) {
  Voigt s;
  s << n.x() * n.x(), n.y() * n.y(), n.z() * n.z(), n.x() * n.y(), n.y() * n.z(), n.z() * n.x();
  return value * s;
}

TEST(StrengthAcross, TensionAtAnAngleBreaksByTheClosedForm) {
  const double strong = 3, weak = 0.5;
  const Problem problem = weak_across(strong, weak);
  for (const double degrees : {0.0, 20.0, 45.0, 70.0, 90.0}) {
    const double t = degrees * std::numbers::pi / 180, c = std::cos(t), s = std::sin(t);
    const Vec3 n(c, s * 0.6, s * 0.8);
    const double strength = 1 / (c * c / strong + s * s / weak);
    for (const YieldMeasure measure : {YieldMeasure::tresca, YieldMeasure::principal}) {
      EXPECT_NEAR(problem.yield_ratio(7, along(n, strength), measure), 1, 1e-14) << degrees;
    }
    EXPECT_NEAR(problem.yield_ratio(7, along(n, strength), YieldMeasure::max_shear), 0.5, 1e-14);
  }
}

// Pressed along, it splits along the fibres, by their strength across; pressed across, as well,
// for it is drawn out across in the other direction.
TEST(StrengthAcross, PressureAloneBreaksNothingAndPressureAlongSplits) {
  const Problem problem = weak_across(3, 0.5);
  const Voigt pressure =
      along(Vec3(1, 0, 0), -7) + along(Vec3(0, 1, 0), -7) + along(Vec3(0, 0, 1), -7);
  EXPECT_NEAR(problem.yield_ratio(0, pressure, YieldMeasure::tresca), 0, 1e-14);
  for (const Vec3& n : {Vec3(1, 0, 0), Vec3(0, 1, 0)}) {
    EXPECT_NEAR(problem.yield_ratio(0, along(n, -2), YieldMeasure::tresca), 2 / 0.5, 1e-14);
  }
}

// Of equal strengths it is the isotropic criterion.
TEST(StrengthAcross, EqualStrengthsKnowNoDirection) {
  const Problem problem = weak_across(2, 2);
  Voigt s;
  s << 1, -2, 0.5, 0.7, -0.3, 0.9;
  for (const YieldMeasure measure :
       {YieldMeasure::max_shear, YieldMeasure::tresca, YieldMeasure::principal}) {
    EXPECT_NEAR(problem.yield_ratio(3, s, measure), yield_measure(s, measure) / 2, 1e-14);
  }
}

// Along the pull nothing breaks at a stress that breaks every element across.
TEST(StrengthAcross, DecidesWhatBreaks) {
  for (const int axis : {0, 1}) {
    Scene scene = linear_cube();
    Material& m = scene.materials["board"];
    m.yield = 3;
    m.fibres[0].yield_across = 0.01;
    scene.fracture.model = FractureModel::p;
    scene.fracture.max_events = 1;
    pull(scene, axis, axis == 0 ? 1.1 : 1.01);  // 2 MPa along, .02 across
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
    const StepReport report = run.step();
    EXPECT_EQ(report.events > 0, axis == 1);
  }
}

}  // namespace
}  // namespace sunder::test
