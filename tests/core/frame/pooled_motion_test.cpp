// SPDX-License-Identifier: Apache-2.0
// Nearly incompressible tissue in motion whose volume is pooled: it swings as it should where an
// element for itself locks, keeps its energy, comes to rest where statics does, and tears.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

constexpr double kLength = 20, kWide = 4, kYoung = 0.03, kDensity = 1e-9;

Box beyond(double x) { return {Vec3(x, -1, -1), Vec3(99, 99, 99)}; }

/// A cantilever whose end a force pulls aside at once.
Scene cantilever(MaterialVolume volume, double poisson,
                 MaterialLaw law = MaterialLaw::neo_hookean) {
  Scene scene;
  scene.mesh = structured_board({20, 4, 4, kLength, kWide, kWide});
  Material& m = scene.materials["board"];
  m.young = kYoung;
  m.poisson = poisson;
  m.law = law;
  m.volume = volume;
  m.density = kDensity;
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{}});
  scene.instruments.push_back({"weight", Pull{beyond(kLength - 1e-6), Vec3(0, 0, 5e-4)}, {}});
  scene.dynamics = Dynamics{.time_step = 0.002};
  scene.solver.backend = "cpu";
  scene.steps = 100;
  return scene;
}

struct Swing {
  explicit Swing(Scene scene)
      : problem(std::make_shared<const Problem>(std::move(scene))),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {}
  [[nodiscard]] double end() const {
    double sum = 0;
    const auto& nodes = problem->instrument_nodes()[0].nodes;
    const auto u = simulation.displacement();
    for (Index n : nodes) sum += u[static_cast<std::size_t>(n)].z();
    return sum / static_cast<double>(nodes.size());
  }
  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

/// Twice the time to where it first turns back [s].
double period(Scene scene) {
  Swing swing(std::move(scene));
  double before = 0, last = 0;
  while (!swing.simulation.done()) {
    swing.simulation.step();
    const double now = swing.end();
    if (now < last) {  // the parabola through the three
      const double top = (before - now) / (2 * (before - 2 * last + now));
      return 2 * (swing.simulation.steps_done() - 1 + top) * 0.002;
    }
    before = std::exchange(last, now);
  }
  ADD_FAILURE() << "it does not turn back";
  return 0;
}

TEST(PooledMotion, SwingsAsABeamWhereElementsLock) {
  // Euler and Bernoulli's first mode; 85 % of its compliance makes it .92 of the period.
  const double inertia = std::pow(kWide, 4) / 12, of_length = kDensity * kWide * kWide;
  const double beam =
      2 * std::numbers::pi * kLength * kLength / (3.516 * std::sqrt(kYoung * inertia / of_length));
  const double pooled = period(cantilever(MaterialVolume::pooled, 0.4999)),
               locked = period(cantilever(MaterialVolume::element, 0.4999)),
               soft = period(cantilever(MaterialVolume::pooled, 0.4));
  std::printf("period over the beam's: pooled %.3f, element %.3f, pooled at nu .4 %.3f\n",
              pooled / beam, locked / beam, soft / beam);
  EXPECT_NEAR(pooled / beam, 0.92, 0.03);
  EXPECT_NEAR(pooled / soft, 1, 0.02);
  EXPECT_LT(locked / beam, 0.4);
}

// The pull is a small one.
TEST(PooledMotion, EveryLawSwingsAlike) {
  const auto swings = [](MaterialLaw law) {
    Scene scene = cantilever(MaterialVolume::pooled, 0.4999, law);
    std::get<Pull>(scene.instruments[0].action).force /= 10;
    return period(std::move(scene));
  };
  const double right = swings(MaterialLaw::neo_hookean);
  for (MaterialLaw law :
       {MaterialLaw::linear, MaterialLaw::corotated, MaterialLaw::saint_venant_kirchhoff}) {
    EXPECT_NEAR(swings(law) / right, 1, 0.01);
  }
}

TEST(PooledMotion, TheAccountOfEnergyCloses) {
  Swing swing(cantilever(MaterialVolume::pooled, 0.4999));
  while (!swing.simulation.done()) {
    const MotionState of = *swing.simulation.step().motion;
    EXPECT_NEAR(of.work, of.kinetic + of.strain_energy + of.dissipated(), 1e-9 * of.work);
    EXPECT_LT(std::abs(of.unsolved), 0.01 * of.work);
    EXPECT_GT(of.scheme, -1e-3 * of.work);
  }
}

// Viscous stress of shape alone: damped it comes to rest, soon, where statics is.
TEST(PooledMotion, ComesToRestWhereStaticsIs) {
  Scene still = cantilever(MaterialVolume::pooled, 0.4999);
  still.dynamics.reset();
  still.steps = 1;
  still.solver.tolerance = 1e-7;
  Scene moving = cantilever(MaterialVolume::pooled, 0.4999);
  moving.dynamics->stiffness_damping = 0.02;
  moving.dynamics->mass_damping = 20;
  moving.dynamics->time_step = 0.01;
  Swing rest(std::move(still)), comes(std::move(moving));
  rest.simulation.step();
  while (!comes.simulation.done()) comes.simulation.step();
  EXPECT_NEAR(comes.end() / rest.end(), 1, 1e-3);
}

// Torn to pieces: what comes off keeps no patch with the rest, and no figure is lost.
TEST(PooledMotion, TearsAndKeepsItsAccount) {
  Scene scene = cantilever(MaterialVolume::pooled, 0.45);
  scene.materials["board"].yield = 0.004;
  std::get<Pull>(scene.instruments[0].action).force = Vec3(0.03, 0, 0.03);
  scene.instruments[0].ramp = Ramp{0, 1};
  scene.fracture.model = FractureModel::a;
  scene.steps = 60;
  Swing swing(std::move(scene));
  MotionState of;
  while (!swing.simulation.done()) of = *swing.simulation.step().motion;
  EXPECT_GT(swing.simulation.destroyed().size(), 20u);
  EXPECT_NEAR(of.work, of.kinetic + of.strain_energy + of.dissipated(), 1e-6 * of.work);
  EXPECT_GT(of.broken, 0);
  for (const Vec3& u : swing.simulation.displacement()) EXPECT_TRUE(u.allFinite());
}

}  // namespace
}  // namespace sunder::test
