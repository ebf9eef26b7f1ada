// SPDX-License-Identifier: Apache-2.0
// Scenes in motion: free bodies, a pendulum, what breaks in a step, what grips feel, time of a
// host's own, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "body/lumped_mass.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "sunder/stress_measures.hpp"
#include "support/structured_board.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

constexpr double kDensity = 1e-9, kGravity = 9810;

/// A bar of 8 x 2 x 2 mm that nothing holds.
Scene free_bar(MaterialLaw law = MaterialLaw::corotated, double young = 5) {
  Scene scene;
  scene.mesh = structured_board({8, 2, 2, 8, 2, 2});
  scene.materials["board"] = {young, 0.3, {}, law, kDensity};
  scene.dynamics = Dynamics{.time_step = 0.005};
  scene.steps = 40;
  return scene;
}

const Box kLeft{Vec3(-1e-6, -1, -1), Vec3(1e-6, 9, 9)},
    kRight{Vec3(8 - 1e-6, -1, -1), Vec3(9, 9, 9)};

Instrument grip(const Box& nodes, const Vec3& displacement) {
  Instrument tool;
  tool.name = "hand";
  tool.action = Grip{nodes, displacement, Axes{7}};
  tool.ramp = Ramp{0, 1};
  return tool;
}

std::unique_ptr<Simulation> moving(Scene scene) {
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  return std::make_unique<Simulation>(problem, cpu_reference::create(problem, needs_of(*problem)));
}

double lost(const MotionState& m) { return m.work - m.kinetic - m.strain_energy - m.dissipated(); }

TEST(Motion, ABodyThatNothingHoldsFalls) {
  Scene scene = free_bar();
  scene.gravity = Vec3(0, -kGravity, 0);
  const auto simulation = moving(scene);
  const double mass = 8 * 2 * 2 * kDensity;
  StepReport report;
  while (!simulation->done()) {
    report = simulation->step();
    ASSERT_TRUE(report.motion);
    const double time = 0.005 * (report.step + 1);
    EXPECT_DOUBLE_EQ(report.motion->time, time);
    EXPECT_NEAR(report.motion->momentum.y(), -mass * kGravity * time, 1e-12 * mass * kGravity);
    EXPECT_LE(report.motion->strain_energy, 1e-12 * report.motion->kinetic);
    EXPECT_NEAR(lost(*report.motion), 0, 1e-12 * report.motion->work);
  }
  EXPECT_TRUE(simulation->warnings().empty()) << simulation->warnings().front();
}

// A stiff bar on a hinge swings as the physical pendulum of its lumped masses does.
TEST(Motion, APendulumHasItsPeriod) {
  Scene scene = free_bar(MaterialLaw::corotated, 500);
  scene.supports.push_back({Box{Vec3(-1e-6, -1e-6, -1), Vec3(1e-6, 1e-6, 9)}, Axes{7}});
  constexpr double kTilt = 0.05, kDt = 1e-3;
  // The line from the hinge to the centre is turned against gravity by kTilt.
  const double rest = std::atan2(1.0, 4.0) - kTilt;
  scene.gravity = kGravity * Vec3(std::cos(rest), std::sin(rest), 0);
  scene.dynamics->time_step = kDt;
  scene.steps = 1000;
  const auto simulation = moving(scene);
  const std::vector<double> mass = fem::lumped_masses(simulation->problem());
  double inertia = 0, moment = 0;
  for (std::size_t n = 0; n < mass.size(); ++n) {
    const Vec3 x = simulation->problem().mesh().nodes[n];
    inertia += mass[n] * (x.x() * x.x() + x.y() * x.y());
    moment += mass[n] * std::hypot(4, 1);
  }
  const double period =
      2 * std::numbers::pi * std::sqrt(inertia / (moment * kGravity)) * (1 + kTilt * kTilt / 16);
  double before = 0;
  std::vector<double> turns;  // times at which it turns back
  MotionState last;
  while (!simulation->done()) {
    last = *simulation->step().motion;
    const double spin = last.angular_momentum.z();
    if (before * spin < 0) turns.push_back(last.time - kDt * spin / (spin - before));
    before = spin;
  }
  ASSERT_GE(turns.size(), 5U);
  const double measured =
      2 * (turns.back() - turns.front()) / static_cast<double>(turns.size() - 1);
  std::printf("period %.5f s, of a rigid body %.5f s; %.2e of the work lost by the scheme\n",
              measured, period, last.scheme / last.work);
  EXPECT_NEAR(measured, period, 5e-3 * period);
  EXPECT_NEAR(lost(last), 0, 1e-9 * last.work);
  EXPECT_GE(last.scheme, 0);
  EXPECT_EQ(last.damped, 0);
}

// Model A in motion: a step has one event, of all elements at or over yield in one state.
TEST(Motion, AStepTakesAllThatIsOverYield) {
  Scene scene = free_bar();
  scene.materials["board"].yield = 1.0;
  scene.supports.push_back({kLeft, Axes{7}});
  scene.instruments.push_back(grip(kRight, Vec3(4, -3, 0)));
  scene.fracture.model = FractureModel::a;
  const auto simulation = moving(scene);
  std::vector<Index> over;
  simulation->observe_frames([&] {
    over.clear();
    const auto stress = simulation->stress();
    for (Index e = 0; e < simulation->problem().tet_count(); ++e) {
      const bool live = !simulation->backend().destroyed()[e];
      if (live && yield_measure(stress[e], YieldMeasure::max_shear) >= 1.0) over.push_back(e);
    }
  });
  int most = 0;
  while (!simulation->done()) {
    const std::size_t before = simulation->destroyed().size();
    const StepReport report = simulation->step();
    EXPECT_EQ(report.events, over.empty() ? 0 : 1);
    std::vector<Index> gone;
    for (std::size_t i = before; i < simulation->destroyed().size(); ++i) {
      gone.push_back(simulation->destroyed()[i].element);
      EXPECT_GE(*simulation->destroyed()[i].ratio, 1);
      EXPECT_EQ(simulation->stress()[gone.back()], Voigt::Zero());
    }
    EXPECT_EQ(gone, over);
    most = std::max(most, static_cast<int>(gone.size()));
    EXPECT_NEAR(lost(*report.motion), 0, 1e-9 * report.motion->work);
  }
  EXPECT_GE(most, 2);
  EXPECT_GT(simulation->destroyed().size(), 8U);
}

// With a neighbourhood's mean as strength the same holds of the means.
TEST(Motion, AveragedStrengthDecidesByItsMeans) {
  Scene scene = free_bar();
  scene.materials["board"].yield = 1.0;
  scene.supports.push_back({kLeft, Axes{7}});
  scene.instruments.push_back(grip(kRight, Vec3(5, -3, 0)));
  scene.fracture.model = FractureModel::a;
  scene.fracture.averaging = 0.8;
  const auto simulation = moving(scene);
  std::size_t gone = 0;
  while (!simulation->done()) {
    const StepReport report = simulation->step();
    EXPECT_EQ(report.events > 0, report.max_yield_ratio >= 1) << report.step;
    gone = simulation->destroyed().size();
  }
  EXPECT_GT(gone, 2U);
}

// A piece that is cut off goes on moving: a warning says so, nothing is frozen.
TEST(Motion, APieceThatIsCutOffMovesOn) {
  Scene scene = free_bar();
  scene.supports.push_back({kLeft, Axes{7}});
  scene.gravity = Vec3(0, -kGravity, 0);
  scene.removals.push_back({4, Box{Vec3(3.01, -1, -1), Vec3(3.99, 9, 9)}});
  const auto simulation = moving(scene);
  while (!simulation->done()) simulation->step();
  const std::vector<Vec3> u = simulation->displacement();
  const double fallen = -u.back().y(), time = 0.005 * (40 - 4);
  EXPECT_NEAR(fallen, kGravity * time * time / 2, 0.1 * fallen);
  ASSERT_EQ(simulation->warnings().size(), 1U);
  EXPECT_TRUE(mentions(simulation->warnings().front(),
                       "1 piece with 96 elements moves on by itself (since step 4)"))
      << simulation->warnings().front();
}

// Of a body that follows its grip as a whole the hand feels what accelerates the rest of it, and by
// choice what accelerates the nodes that it holds.
TEST(Motion, AGripFeelsInertiaByChoice) {
  const auto force = [](bool felt) {
    Scene scene = free_bar(MaterialLaw::corotated, 5000);
    Instrument tool = grip(kLeft, Vec3(0, 0, 0));
    tool.ramp.reset();
    scene.instruments.push_back(tool);
    scene.dynamics->felt_inertia = felt;
    const auto simulation = moving(scene);
    Vec3 sum = Vec3::Zero();
    constexpr double kAcceleration = 1e4;  // mm/s^2
    for (int i = 1; i <= 40; ++i) {
      const double time = 0.005 * i;
      simulation->drive(0, Vec3(kAcceleration * time * time / 2, 0, 0));
      simulation->step();
      if (i > 30) sum += simulation->reactions()[0] / 10;
    }
    return sum.x() / kAcceleration;
  };
  const Problem problem(free_bar());
  const std::vector<double> mass = fem::lumped_masses(problem);
  double held = 0, whole = 0;
  for (std::size_t n = 0; n < mass.size(); ++n) {
    whole += mass[n];
    if (problem.mesh().nodes[n].x() < 1e-6) held += mass[n];
  }
  EXPECT_NEAR(force(true), whole, 0.02 * whole);
  EXPECT_NEAR(force(false), whole - held, 0.02 * whole);
}

// What supports hold of a body that swings, its viscous forces included: with the weight of all it
// is what changes the momentum, as the scheme has it (backward Euler, then BDF2).
TEST(Motion, SupportsHoldWhatDampingAsks) {
  for (const double viscosity : {0.0, 0.02}) {
    Scene scene = free_bar();
    scene.supports.push_back({kLeft, Axes{7}});
    scene.gravity = Vec3(0, -kGravity, 0);
    scene.dynamics->stiffness_damping = viscosity;
    scene.solver.tolerance = 1e-10;
    const auto simulation = moving(scene);
    const Vec3 weight = 8 * 2 * 2 * kDensity * scene.gravity;
    std::vector<Vec3> momentum{Vec3::Zero()};
    for (int i = 0; i < 6; ++i) {
      const StepReport report = simulation->step();
      momentum.push_back(report.motion->momentum);
      const std::size_t n = momentum.size() - 1;
      const Vec3 from = n == 1 ? momentum[0] : Vec3((4 * momentum[n - 1] - momentum[n - 2]) / 3);
      const Vec3 change = (n == 1 ? 1 : 1.5) / 0.005 * (momentum[n] - from);
      EXPECT_LE((weight + simulation->support_reaction() - change).norm(), 1e-8 * weight.norm())
          << viscosity << ", step " << n;
    }
  }
}

// Small motions are the same by the linear law and by one of finite deformation; the linear body
// needs one base.
TEST(Motion, SmallSwingsAreThoseOfTheLinearLaw) {
  const auto end = [](MaterialLaw law) {
    Scene scene = free_bar(law);
    scene.supports.push_back({kLeft, Axes{7}});
    Instrument pull;
    pull.name = "pull";
    pull.action = Pull{kRight, Vec3(0, 1e-6, 0)};
    scene.instruments.push_back(pull);
    scene.dynamics->time_step = 1e-3;
    scene.solver.tolerance = 1e-8;
    const auto simulation = moving(scene);
    int back_solves = 0;
    while (!simulation->done()) back_solves += simulation->step().back_solves;
    EXPECT_LE(back_solves, 3 * 40);
    return simulation->displacement();
  };
  const auto linear = end(MaterialLaw::linear), corotated = end(MaterialLaw::corotated);
  double most = 0, apart = 0;
  for (std::size_t n = 0; n < linear.size(); ++n) {
    most = std::max(most, linear[n].norm());
    apart = std::max(apart, (linear[n] - corotated[n]).norm());
  }
  EXPECT_GT(most, 0);
  EXPECT_LE(apart, 1e-4 * most);
}

// Model B grows the crack of a notched board in motion, by the formula (the intact body moves
// beside) and by the field.
TEST(Motion, CracksGrow) {
  for (const SifSource sif : {SifSource::formula, SifSource::field}) {
    Scene scene;
    scene.mesh = structured_board({16, 16, 1, 16, 16, 1});
    scene.materials["board"] = {5, 0.3, 0.1, MaterialLaw::corotated, kDensity};
    scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(17, 1e-6, 9)}, Axes{7}});
    scene.instruments.push_back(
        grip(Box{Vec3(-1, 16 - 1e-6, -1), Vec3(17, 17, 9)}, Vec3(0, 0.6, 0)));
    PresetCrack notch;
    notch.elements = Box{Vec3(-1, 8.01, -1), Vec3(5, 8.99, 9)};
    notch.mouth = Vec3(0, 8.5, 0.5);
    notch.tips = {Vec3(5, 8.5, 0.5)};
    scene.cracks.push_back(notch);
    scene.fracture.model = FractureModel::b;
    scene.fracture.sif = sif;
    scene.dynamics = Dynamics{.time_step = 0.005};
    scene.steps = 40;
    const auto simulation = moving(scene);
    int grown = 0;
    while (!simulation->done()) {
      const StepReport report = simulation->step();
      EXPECT_LE(report.events, report.step == 0 ? 2 : 1);
    }
    for (const DestroyedElement& d : simulation->destroyed()) grown += d.cause == Cause::sif;
    EXPECT_GT(grown, 4) << (sif == SifSource::field);
  }
}

TEST(Motion, AHostStepsByTimesOfItsOwn) {
  Scene scene = free_bar();
  scene.supports.push_back({kLeft, Axes{7}});
  scene.instruments.push_back(grip(kRight, Vec3(0.4, 0, 0)));
  const auto simulation = moving(scene);
  double time = 0;
  for (const double dt : {0.005, 0.001, 0.002, 0.004, 0.0005}) {
    const StepReport report = simulation->step(dt);
    time += dt;
    EXPECT_NEAR(report.motion->time, time, 1e-15);
    EXPECT_NEAR(report.load_factor, time / 0.2, 1e-14);
    EXPECT_NEAR(simulation->displacement().back().x(), 0.4 * time / 0.2, 1e-14);
  }
  for (const double dt : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW(simulation->step(dt), UsageError);
  }
  Scene statics = scene;
  statics.dynamics.reset();
  EXPECT_THROW(moving(statics)->step(0.01), UsageError);
}

TEST(Motion, VelocitiesGoInAndOut) {
  Scene scene = free_bar();
  scene.supports.push_back({kLeft, Axes{7}});
  const auto simulation = moving(scene);
  EXPECT_EQ(simulation->velocity().back(), Vec3::Zero());
  std::vector<Vec3> v(simulation->problem().mesh().nodes.size(), Vec3(0, 5, 0));
  simulation->set_velocity(v);
  EXPECT_EQ(simulation->velocity().back(), Vec3(0, 5, 0));
  EXPECT_EQ(simulation->velocity().front(), Vec3::Zero());
  const StepReport report = simulation->step();
  EXPECT_GT(report.motion->work, 0);
  EXPECT_NEAR(lost(*report.motion), 0, 1e-12 * report.motion->work);
  v.back().x() = std::nan("");
  EXPECT_THROW(simulation->set_velocity(v), UsageError);
  v.pop_back();
  EXPECT_THROW(simulation->set_velocity(v), UsageError);
}

TEST(Motion, ACapSaysSo) {
  Scene scene = free_bar();
  scene.supports.push_back({kLeft, Axes{7}});
  scene.instruments.push_back(grip(kRight, Vec3(4, -6, 0)));
  scene.dynamics->max_iterations = 1;
  scene.solver.tolerance = 1e-8;
  const auto simulation = moving(scene);
  int capped = 0;
  while (!simulation->done()) {
    const StepReport report = simulation->step();
    capped += report.capped;
    EXPECT_LE(report.back_solves, 1);
  }
  EXPECT_GE(capped, 30);
  ASSERT_EQ(simulation->warnings().size(), 1U);
  EXPECT_TRUE(mentions(simulation->warnings().front(), "ended at dynamics.max_iterations = 1"));
}

// A hand that jumps by half the bar's length in one step: by neo-Hookean no element ends inverted.
TEST(Motion, AHandThatJumpsIsFollowedInParts) {
  Scene scene = free_bar(MaterialLaw::neo_hookean);
  scene.supports.push_back({kLeft, Axes{7}});
  scene.instruments.push_back(grip(kRight, Vec3::Zero()));
  scene.steps = 12;
  const auto simulation = moving(scene);
  for (const Vec3& to : {Vec3(4, 0, 0), Vec3(0, 4, 0), Vec3(-4, 0, 3), Vec3(0, 0, 0)}) {
    simulation->drive(0, to);
    for (int i = 0; i < 3; ++i) {
      const StepReport report = simulation->step();
      EXPECT_EQ(report.deformation->inverted, 0);
      EXPECT_NEAR((simulation->displacement().back() - to).norm(), 0, 1e-12);
      EXPECT_NEAR(lost(*report.motion), 0, 1e-9 * std::abs(report.motion->work));
    }
  }
}

TEST(Motion, TheSameBitsEachTime) {
  const auto run = [] {
    Scene scene = free_bar(MaterialLaw::neo_hookean);
    scene.materials["board"].yield = 1.0;
    scene.gravity = Vec3(0, -kGravity, 0);
    scene.dynamics->stiffness_damping = 1e-3;
    scene.supports.push_back({kLeft, Axes{7}});
    scene.instruments.push_back(grip(kRight, Vec3(4, -3, 0)));
    scene.fracture.model = FractureModel::a;
    const auto simulation = moving(scene);
    while (!simulation->done()) simulation->step();
    EXPECT_FALSE(simulation->destroyed().empty());
    return simulation->displacement();
  };
  EXPECT_EQ(run(), run());
}

std::string refusal(const Scene& scene) {
  try {
    moving(scene);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Motion, WhatCannotServeItIsRefused) {
  const auto with = [](auto change) {
    Scene scene = free_bar();
    scene.supports.push_back({kLeft, Axes{7}});
    change(scene);
    return refusal(scene);
  };
  EXPECT_EQ(with([](Scene&) {}), "");
  EXPECT_EQ(with([](Scene& s) { s.materials["board"].density.reset(); }),
            "scene: material \"board\" has no density, which motion needs; add density = 1e-9 "
            "(water, in t/mm^3)");
  EXPECT_TRUE(mentions(with([](Scene& s) { s.materials["board"].density = -1; }),
                       "density = -1; it must be finite and above 0"));
  EXPECT_TRUE(mentions(with([](Scene& s) { s.dynamics->time_step = 0; }),
                       "dynamics.time_step = 0; it must be finite and above 0 s"));
  EXPECT_TRUE(mentions(with([](Scene& s) { s.dynamics->mass_damping = -1; }),
                       "dynamics.damping = -1; it must be finite and at least 0"));
  EXPECT_TRUE(mentions(with([](Scene& s) { s.dynamics->stiffness_damping = std::nan(""); }),
                       "dynamics.damping"));
  EXPECT_TRUE(mentions(with([](Scene& s) { s.dynamics->max_iterations = -1; }),
                       "dynamics.max_iterations = -1; it must be at least 0"));
  EXPECT_TRUE(mentions(with([](Scene& s) { s.gravity.x() = std::nan(""); }), "load.gravity"));
  EXPECT_TRUE(
      mentions(with([](Scene& s) { s.solver.route = Route::cg; }), "route cg cannot serve motion"));
  EXPECT_TRUE(mentions(with([](Scene& s) { s.solver.route = Route::condensed; }),
                       "use route factor or auto"));
  EXPECT_TRUE(mentions(with([](Scene& s) { s.solver.precision = Precision::fp32; }),
                       "use precision fp64 or auto"));
  EXPECT_TRUE(mentions(with([](Scene& s) { s.solver.update = Update::eager; }),
                       "use update deferred or auto"));
}

TEST(Motion, OddOptionsAreWarnings) {
  Scene scene = free_bar();
  scene.materials["board"].yield = 1.0;
  scene.materials["board"].density = 1e-6;
  scene.fracture.model = FractureModel::a;
  scene.dynamics->time_step = 0.02;
  const Problem problem(scene);
  ASSERT_EQ(problem.warnings().size(), 2U);
  EXPECT_TRUE(mentions(problem.warnings()[0], "dynamics.time_step = 0.02 s is too coarse"));
  EXPECT_TRUE(mentions(problem.warnings()[1], "its unit is t/mm^3"));
}

// The dense inverse of a tangent is a base as good as its factor.
TEST(Motion, RouteInverseGoesTheSameWay) {
  const auto end = [](Route route) {
    Scene scene = free_bar();
    scene.supports.push_back({kLeft, Axes{7}});
    scene.gravity = Vec3(0, -kGravity, 0);
    scene.solver.route = route;
    scene.solver.tolerance = 1e-10;
    scene.removals.push_back({4, Box{Vec3(3.01, -1, -1), Vec3(3.99, 1, 9)}});
    const auto simulation = moving(scene);
    while (!simulation->done()) simulation->step();
    return simulation->displacement();
  };
  const auto factor = end(Route::factor), inverse = end(Route::inverse);
  double most = 0, apart = 0;
  for (std::size_t n = 0; n < factor.size(); ++n) {
    most = std::max(most, factor[n].norm());
    apart = std::max(apart, (factor[n] - inverse[n]).norm());
  }
  EXPECT_GT(most, 1e-3);
  EXPECT_LE(apart, 1e-7 * most);
}

}  // namespace
}  // namespace sunder::test
