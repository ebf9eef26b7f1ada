// SPDX-License-Identifier: Apache-2.0
// Cracks that split on the device against the CPU: by the linear law and by others, at rest and in
// motion, and where the device is lost under way.
#include <gtest/gtest.h>

#include "gpu_body.hpp"
#include "support/notch_board.hpp"

namespace sunder::test {
namespace {

struct SplitBoard {
  const char* name;
  MaterialLaw law;
  bool moves;
  Route route;
  Precision precision = Precision::fp64;
  int growths = 6;
};

constexpr double kTight = 1e-10;

Scene scene_of(const SplitBoard& of) {
  Scene scene = notch_board(FractureModel::b);
  scene.fracture.crack = CrackWay::split;
  scene.fracture.sif = SifSource::field;
  scene.fracture.alpha = 1e-12;  // the notch's elements leave as good as nothing on both
  scene.fracture.max_events = 2;
  scene.instruments[0].ramp = Ramp{0, 0.6};
  scene.solver.tolerance = kTight;
  for (auto& [name, material] : scene.materials) {
    material.law = of.law;
    material.density = 1e-9;
    if (of.law != MaterialLaw::linear) material.toughness = 0.5;
  }
  if (!of.moves) return scene;
  scene.dynamics = Dynamics{.time_step = 2e-3, .mass_damping = 50};
  scene.instruments[0].ramp = Ramp{0, 0.3};
  return scene;
}

struct Course {
  std::vector<DestroyedElement> rows;
  std::vector<double> displacement;
  std::vector<Voigt> stress;
  std::vector<std::uint8_t> out;
  Mesh mesh;
  BackendInfo info;
};

Course course_of(const Simulation& simulation) {
  Course of;
  of.rows = simulation.destroyed();
  for (const Vec3& u : simulation.displacement()) {
    of.displacement.insert(of.displacement.end(), u.begin(), u.end());
  }
  of.stress = simulation.stress();
  of.out.assign(simulation.backend().destroyed().begin(), simulation.backend().destroyed().end());
  of.mesh = simulation.mesh();
  of.info = simulation.backend().info();
  return of;
}

/// Until the crack has grown some times.
Course run(const std::shared_ptr<const Problem>& problem, std::unique_ptr<Backend> backend,
           int growths = 6) {
  Simulation simulation(problem, std::move(backend));
  const auto grown = [&] {
    return std::ranges::count_if(simulation.destroyed(),
                                 [](const DestroyedElement& row) { return row.lives; });
  };
  while (!simulation.done() && grown() < growths) simulation.step();
  EXPECT_GE(grown(), growths);
  return course_of(simulation);
}

Course run_on_cpu(Scene scene, int growths = 6) {
  scene.solver = {.backend = "cpu", .tolerance = kTight};
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  return run(problem, cpu_reference::create(problem, needs_of(*problem)), growths);
}

void expect_alike(const Course& found, const Course& expected, double allowed) {
  ASSERT_EQ(found.rows.size(), expected.rows.size());
  for (std::size_t i = 0; i < found.rows.size(); ++i) {
    const DestroyedElement &a = found.rows[i], &b = expected.rows[i];
    EXPECT_EQ(a.step, b.step) << i;
    EXPECT_EQ(a.element, b.element) << i;
    EXPECT_EQ(a.cause, b.cause) << i;
    EXPECT_EQ(a.crack, b.crack) << i;
  }
  ASSERT_EQ(found.mesh.tets, expected.mesh.tets);
  EXPECT_LE(displacement_error(found.mesh, found.out, found.displacement, expected.displacement),
            allowed);
  EXPECT_LE(stress_error(found.out, found.stress, expected.stress), allowed);
}

class SplitCracksOnTheDevice : public WithVulkan<testing::TestWithParam<SplitBoard>> {};

TEST_P(SplitCracksOnTheDevice, GrowAsOnTheHost) {
  const SplitBoard& of = GetParam();
  const Scene scene = scene_of(of);
  WatchedBackend watched(scene,
                         {.precision = of.precision, .tolerance = kTight, .route = of.route});
  const Course found = run(watched.problem, watched.create(), of.growths);
  EXPECT_EQ(found.info.backend, "vulkan");
  EXPECT_EQ(found.info.why.find("took over"), std::string::npos) << found.info.why;
  EXPECT_EQ(found.info.why.find("where nodes part, by the host's factor") != std::string::npos,
            found.info.route == "inverse");
  // fp32 is that of a base alone: its states are the same in fp64.
  expect_alike(found, run_on_cpu(scene, of.growths), 1e-8);
  if (of.route != Route::automatic) return;
  const Course again = run(watched.problem, watched.create(), of.growths);
  EXPECT_EQ(again.displacement, found.displacement);
}

/// A blade between two steps, and a grip beside what it has opened.
Course cut_and_grasped(const std::shared_ptr<const Problem>& problem,
                       std::unique_ptr<Backend> backend) {
  Simulation simulation(problem, std::move(backend));
  simulation.step();
  const Vec3 a(51, 15.2, -1), b(51, 15.2, 3), c(30, 16, -1), d(30, 16, 3);
  EXPECT_GT(simulation.cut(std::vector<std::array<Vec3, 3>>{{a, b, c}, {b, d, c}}), 10);
  simulation.step();
  const int grip = simulation.grasp(Vec3(42, 14, 1), 3, true);
  simulation.pose(grip, {simulation.centre_of(grip) + Vec3(0.1, -0.2, 0.05)});
  simulation.step();
  EXPECT_GT(simulation.wrench(grip).force.norm(), 0);
  return course_of(simulation);
}

TEST_P(SplitCracksOnTheDevice, AreCutAndHeldAsOnTheHost) {
  const SplitBoard& of = GetParam();
  Scene scene = scene_of(of);
  // Nothing tears by itself; under three times the load a step of motion by the corotated law has
  // two ends after the cut, of which rounding chooses one.
  scene.instruments[0].ramp = Ramp{0, 12};
  WatchedBackend watched(scene,
                         {.precision = of.precision, .tolerance = kTight, .route = of.route});
  const Course found = cut_and_grasped(watched.problem, watched.create());
  EXPECT_EQ(found.info.backend, "vulkan");
  EXPECT_EQ(found.info.why.find("took over"), std::string::npos) << found.info.why;
  scene.solver = {.backend = "cpu", .tolerance = kTight};
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  expect_alike(found, cut_and_grasped(problem, cpu_reference::create(problem, needs_of(*problem))),
               1e-8);
}

INSTANTIATE_TEST_SUITE_P(
    All, SplitCracksOnTheDevice,
    testing::Values(
        SplitBoard{"linear", MaterialLaw::linear, false, Route::automatic},
        SplitBoard{"linear_fp32", MaterialLaw::linear, false, Route::inverse, Precision::fp32},
        SplitBoard{"linear_by_factor", MaterialLaw::linear, false, Route::factor},
        SplitBoard{"corotated", MaterialLaw::corotated, false, Route::automatic},
        SplitBoard{"neo_hookean_by_factor", MaterialLaw::neo_hookean, false, Route::factor},
        SplitBoard{"motion_linear", MaterialLaw::linear, true, Route::automatic},
        SplitBoard{"motion_neo_hookean", MaterialLaw::neo_hookean, true, Route::automatic},
        SplitBoard{"motion_corotated_by_cg", MaterialLaw::corotated, true, Route::cg,
                   Precision::fp64, 1}),
    [](const auto& tested) { return std::string(tested.param.name); });

class SplitDeviceLost : public WithVulkan<testing::TestWithParam<bool>> {};

TEST_P(SplitDeviceLost, TheHostGoesOnFromTheLastState) {
  const Scene scene =
      scene_of({"", MaterialLaw::corotated, GetParam(), Route::automatic, Precision::fp64});
  const Course expected = run_on_cpu(scene);
  WatchedBackend watched(scene, {.tolerance = kTight, .route = Route::automatic});
  int losses = 0;
  for (const int submits : {150, 350}) {
    watched.options.probe.submits_until_lost = submits;
    const Course found = run(watched.problem, watched.create());
    expect_alike(found, expected, 1e-8);
    losses += found.info.why.find("took over") != std::string::npos;
  }
  EXPECT_GE(losses, 1);
}

class SplitOutgrows : public WithVulkan<testing::TestWithParam<bool>> {};

/// A buffer of the device holds the inverse of the body as it begins, and of no larger one.
TEST_P(SplitOutgrows, TheInverseOfTheDeviceAndGoesOnByTheFactor) {
  constexpr int kMany = 9;
  const Scene scene =
      scene_of({"", MaterialLaw::corotated, GetParam(), Route::automatic, Precision::fp64});
  WatchedBackend watched(scene, {.tolerance = kTight, .route = Route::automatic});
  constexpr VkDeviceSize kRows = 64;
  const auto unknowns = static_cast<VkDeviceSize>(watched.problem->dof_count());
  const VkDeviceSize rows = (unknowns + kRows - 1) / kRows * kRows;
  watched.options.probe.limits.buffer_bytes = rows * rows * sizeof(double);
  const Course found = run(watched.problem, watched.create(), kMany);
  EXPECT_EQ(found.info.route, "factor") << found.info.why;
  EXPECT_NE(found.info.why.find("of the parted body is larger than a buffer of the device"),
            std::string::npos)
      << found.info.why;
  expect_alike(found, run_on_cpu(scene, kMany), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(All, SplitOutgrows, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "moving" : "resting"; });

INSTANTIATE_TEST_SUITE_P(All, SplitDeviceLost, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "moving" : "resting"; });

}  // namespace
}  // namespace sunder::test
