// SPDX-License-Identifier: Apache-2.0
// Blocks that are pulled apart, sheared and pressed: the law by closed forms, and what breaks.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "body/element.hpp"
#include "bonded_blocks.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/plain/plain.hpp"
#include "material/finite_stress.hpp"
#include "material/neo_hookean.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

constexpr double kArea = 4;  // of blocks() [mm^2]

struct BlockRun {
  explicit BlockRun(Scene scene)
      : problem(std::make_shared<const Problem>(std::move(scene))),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {}
  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

/// Largest traction on the way, and where.
struct Peak {
  double traction = 0, opening = 0, energy = 0;
  double work = 0;  ///< per area, up to where the first pair parts [N/mm]
};
Peak peak_of(Scene scene) {
  BlockRun run(std::move(scene));
  const Grip& grip = std::get<Grip>(run.problem->scene().instruments[0].action);
  const double way = grip.displacement.norm();
  Peak peak;
  double before = 0;
  while (!run.simulation.done()) {
    run.simulation.step();
    const double traction = run.simulation.reactions()[0].dot(grip.displacement) / way / kArea;
    if (!run.simulation.destroyed().empty()) continue;
    peak.work += (traction + before) / 2 * way / run.problem->scene().steps;
    before = traction;
    if (traction <= peak.traction) continue;
    peak.traction = traction;
    peak.opening = way * run.simulation.steps_done() / run.problem->scene().steps;
  }
  for (const DestroyedElement& row : run.simulation.destroyed()) {
    EXPECT_EQ(row.cause, Cause::parting);
    EXPECT_TRUE(run.problem->in_interface(row.element));
    peak.energy += row.energy.value() / kArea;
  }
  return peak;
}

// By hand: of a layer that a displacement opens, in tension, in shear, and turned.
TEST(Traction, IsThatOfTheDeformedLayer) {
  const Problem problem(blocks());
  const Interfaces& interfaces = *problem.interfaces();
  const Index e = problem.tet_count() - 1;
  const InterfaceLayer& layer = interfaces.layers()[0];
  const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const Vec3& opening : {Vec3(0, 0, 0.1), Vec3(0.1, 0, 0), Vec3(0.05, -0.02, 0.07),
                              Vec3(0.03, 0, -0.001), Vec3(0, 0, -0.0019)}) {
    const Mat3 f =
        turn * (Mat3::Identity() + opening * Vec3(0, 0, 1).transpose() / layer.thickness);
    const Mat3 p = kNeoHookean.stress(problem.small_strain(e), f);
    const Voigt biot = biot_stress(p, f);
    const Vec3 force = p * Vec3(0, 0, 1),
               normal = (f.inverse().transpose() * Vec3(0, 0, 1)).normalized();
    const double along = force.dot(normal), shear = (force - along * normal).norm();
    const Traction of = interfaces.traction(e, biot);
    const double scale = 1e-10 * force.norm();
    EXPECT_NEAR(of.normal, along, scale);
    EXPECT_NEAR(of.shear, shear, scale);
    const double w = kNeoHookean.energy(problem.small_strain(e), f);
    EXPECT_NEAR(interfaces.energy(e, biot), w * layer.thickness * interfaces.area(e),
                1e-9 * w * layer.thickness);
    EXPECT_NEAR(interfaces.ratio(e, biot), std::hypot(std::max(along, 0.0), shear) / kStrength,
                1e-9);
  }
}

TEST(Parting, InTensionAtTheStrengthWithTheEnergy) {
  for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::neo_hookean}) {
    Scene scene = blocks(tissue(1e4, law));
    move_top(scene, Vec3(0, 0, 0.25), 250);
    const Peak peak = peak_of(std::move(scene));
    EXPECT_NEAR(peak.traction, kStrength, 0.01 * kStrength);
    EXPECT_NEAR(peak.opening, 2 * kEnergy / kStrength, 0.015 * 2 * kEnergy / kStrength);
    EXPECT_NEAR(peak.energy, kEnergy, 0.001 * kEnergy);
    EXPECT_NEAR(peak.work, kEnergy, 0.02 * kEnergy);
  }
}

TEST(Parting, InShearByTheRatio) {
  for (const double ratio : {0.5, 1.0, 2.0}) {
    Scene scene = blocks(tissue(1e4), ratio);
    move_top(scene, Vec3(0.3 * ratio, 0, 0), 300);
    const Peak peak = peak_of(std::move(scene));
    EXPECT_NEAR(peak.traction, ratio * kStrength, 0.01 * ratio * kStrength) << ratio;
    EXPECT_NEAR(peak.energy, ratio * ratio * kEnergy, 0.02 * ratio * ratio * kEnergy) << ratio;
    EXPECT_NEAR(peak.work, ratio * ratio * kEnergy, 0.03 * ratio * ratio * kEnergy) << ratio;
  }
}

TEST(Parting, MixedModesByTheEllipse) {
  const double ratio = 2;
  for (const double degrees : {30.0, 60.0}) {
    const double t = degrees * std::numbers::pi / 180;
    Scene scene = blocks(tissue(1e4), ratio);
    move_top(scene, 0.4 * Vec3(std::sin(t), 0, std::cos(t)), 400);
    const Peak peak = peak_of(std::move(scene));
    const double expected =
        kStrength / std::hypot(std::cos(t), std::sin(t) / ratio);  // traction goes with the way
    EXPECT_NEAR(peak.traction, expected, 0.015 * expected) << degrees;
  }
}

// Pressed, the sides come no nearer than the layer is thick, whatever presses, and nothing parts.
TEST(Parting, UnderPressureNothingPartsAndNothingPasses) {
  Scene scene = blocks(tissue(1));
  move_top(scene, Vec3(0, 0, -0.5), 5);
  BlockRun run(std::move(scene));
  while (!run.simulation.done()) run.simulation.step();
  EXPECT_TRUE(run.simulation.destroyed().empty());
  EXPECT_LT(run.simulation.reactions()[0].z() / kArea, -0.2);
  const auto u = run.simulation.displacement();
  for (Index e = 0; e < run.problem->tet_count(); ++e) {
    std::array<Vec3, 4> x;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto n =
          static_cast<std::size_t>(run.problem->mesh().tets[static_cast<std::size_t>(e)][a]);
      x[a] = run.problem->mesh().nodes[n] + u[n];
    }
    EXPECT_GT(fem::tet_shape(x[0], x[1], x[2], x[3]).volume, 0) << e;
  }
}

TEST(Parting, APairOfNodesIsOneEvent) {
  Scene scene = blocks();
  move_top(scene, Vec3(0, 0, 0.25), 10);
  BlockRun run(std::move(scene));
  std::vector<std::size_t> events;
  run.simulation.observe_events([&](std::span<const DestroyedElement> rows) {
    const Interfaces& interfaces = *run.problem->interfaces();
    EXPECT_EQ(rows.size(), interfaces.elements(interfaces.pair(rows[0].element)).size());
    for (const DestroyedElement& row : rows) {
      EXPECT_EQ(interfaces.pair(row.element), interfaces.pair(rows[0].element));
      EXPECT_EQ(row.ratio, rows[0].ratio);
    }
    events.push_back(rows.size());
    return true;
  });
  while (!run.simulation.done()) run.simulation.step();
  EXPECT_EQ(events.size(), 9u);
  EXPECT_EQ(run.simulation.destroyed().size(), 24u);
}

// Round an edge the springs of one pair have two normals, and where shear is weaker two ratios: the
// larger one decides, and nothing stays over its strength.
TEST(Parting, RoundAnEdgeNothingStaysOverItsStrength) {
  Scene scene = body_of(
      {4, 4, 4, 4, 4, 4}, [](const Vec3& x) { return x.x() > 2 && x.z() > 2 ? "other" : "one"; },
      tissue(2));
  scene.interfaces.push_back({{"one", "other"}, kStrength, kEnergy, 0.2});
  scene.supports.push_back({slab(2, -1, 1e-6), Axes{}});
  scene.instruments.push_back(
      {"top", Grip{Box{Vec3(2.5, -1, 3.99), Vec3(9, 9, 9)}, Vec3(0, 0, 0.8), Axes{}}, Ramp{0, 1}});
  scene.fracture.model = FractureModel::a;
  scene.steps = 10;
  BlockRun run(std::move(scene));
  while (!run.simulation.done()) EXPECT_LT(run.simulation.step().max_yield_ratio, 1);
  EXPECT_GT(run.simulation.destroyed().size(), 30u);
}

// Two interfaces between the same two nodes, as along the line where two blocks that are bonded to
// each other lie on a third: the strength of each is its own.
TEST(Parting, OfTwoBetweenTheSameNodesTheWeakerAlone) {
  Scene scene = body_of(
      {2, 2, 2, 2, 2, 2},
      [](const Vec3& x) { return x.z() < 1   ? "bed"
                                 : x.x() < 1 ? "left"
                                             : "right"; }, tissue(20));
  scene.interfaces.push_back({{"bed", "left"}, kStrength, kEnergy, 1});
  scene.interfaces.push_back({{"bed", "right"}, 100 * kStrength, 100 * kEnergy, 1});
  scene.supports.push_back({slab(2, -1, 1e-6), Axes{}});
  move_top(scene, Vec3(0, 0, 0.4), 8);
  scene.fracture.model = FractureModel::a;
  BlockRun run(std::move(scene));
  while (!run.simulation.done()) run.simulation.step();
  const Interfaces& of = *run.problem->interfaces();
  double parted = 0;
  for (const DestroyedElement& row : run.simulation.destroyed()) {
    EXPECT_EQ(&of.layer(row.element), &of.layers()[0]) << row.element;
    parted += of.area(row.element);
  }
  EXPECT_NEAR(parted, 1, 1e-4) << "along the line the stronger one holds both";
}

// Every tissue may break beside it, by its own strength.
TEST(Parting, BesideTissueThatBreaks) {
  for (const bool weak : {false, true}) {
    Scene scene = blocks(tissue(1));
    scene.materials["high"].yield = weak ? 0.01 : 1;
    move_top(scene, Vec3(0, 0, 0.8), 10);
    BlockRun run(std::move(scene));
    while (!run.simulation.done()) run.simulation.step();
    ASSERT_FALSE(run.simulation.destroyed().empty());
    EXPECT_EQ(run.simulation.destroyed()[0].cause, weak ? Cause::mss : Cause::parting);
  }
}

// The yardstick finds tractions by P N of its own, in extended precision.
TEST(Parting, AsTheYardstickParts) {
  Scene scene = blocks(tissue(2));
  move_top(scene, Vec3(0.24, 0.04, 0.36), 60);
  scene.fracture.max_events = 1;
  scene.solver.tolerance = 1e-10;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation right(problem, plain::create(problem, needs_of(*problem)));
  Simulation tested(problem, cpu_reference::create(problem, needs_of(*problem)));
  // Once all of it has parted there is no force left that a residual could be measured by.
  while (!right.done() && right.destroyed().size() < 15) {
    const StepReport exact = right.step(), found = tested.step();
    if (right.destroyed().empty()) {
      EXPECT_NEAR(found.max_yield_ratio, exact.max_yield_ratio, 1e-8);
      EXPECT_GT(exact.max_yield_ratio, 0);
    }
    ASSERT_EQ(tested.destroyed().size(), right.destroyed().size());
  }
  ASSERT_GE(right.destroyed().size(), 10u);
  for (std::size_t i = 0; i < right.destroyed().size(); ++i) {
    EXPECT_EQ(tested.destroyed()[i].element, right.destroyed()[i].element) << i;
    EXPECT_NEAR(*tested.destroyed()[i].ratio, *right.destroyed()[i].ratio, 1e-7) << i;
  }
  const auto u = tested.displacement(), exact = right.displacement();
  for (std::size_t n = 0; n < u.size(); ++n) EXPECT_NEAR((u[n] - exact[n]).norm(), 0, 1e-8);
}

// What a layer does is no strain of the body, and turns nothing.
TEST(Parting, OpeningIsNoStrain) {
  Scene scene = blocks(tissue(1e4));
  move_top(scene, Vec3(0.05, 0, 0.1), 1);
  BlockRun run(std::move(scene));
  const StepReport report = run.simulation.step();
  ASSERT_TRUE(report.deformation);
  EXPECT_LT(std::abs(report.deformation->strain), 1e-4);
  EXPECT_LT(report.deformation->rotation_deg, 0.1);
  EXPECT_EQ(report.deformation->inverted, 0);
}

// In motion what breaks takes its energy out of the body's account, and viscous tissue does not
// make the layers viscous: an opening is no strain.
TEST(Parting, InMotionTheAccountHasTheEnergy) {
  Scene scene = blocks(tissue(100));
  move_top(scene, Vec3(0, 0, 0.25), 50);
  scene.dynamics = Dynamics{.time_step = 0.004, .mass_damping = 100, .stiffness_damping = 0.01};
  BlockRun run(std::move(scene));
  StepReport last;
  while (!run.simulation.done()) last = run.simulation.step();
  EXPECT_EQ(run.simulation.destroyed().size(), 24u);
  EXPECT_NEAR(last.motion->broken, kEnergy * kArea, 0.06 * kEnergy * kArea);
  EXPECT_LT(last.motion->damped, 0.02 * kEnergy * kArea);
}

}  // namespace
}  // namespace sunder::test
