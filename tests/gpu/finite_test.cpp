// SPDX-License-Identifier: Apache-2.0
// Bodies at finite deformation and in motion on the device against the CPU: frames, the same pieces
// falling; a device lost in mid-step.
#include "fracture_lists.hpp"
#include "gpu_body.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::test {
namespace {

/// The promise of both sides: what they may be apart by is the accuracy table's.
constexpr double kTight = 1e-10;

/// A sheet that hangs from its upper edge under gravity, pulled by a grip until it tears.
Scene torn_sheet(bool moves, MaterialLaw law, FractureModel model) {
  Scene scene;
  scene.mesh = structured_board({8, 8, 1, 8, 8, 1});
  scene.materials["board"] = {5, 0.4, 1.2, law, 1e-9};
  scene.supports.push_back({Box{Vec3(-1, 8 - 1e-6, -1), Vec3(9, 9, 9)}, Axes{7}});
  Instrument hand;
  hand.name = "hand";
  hand.action = Grip{Box{Vec3(6, -1, -1), Vec3(9, 1e-6, 9)}, Vec3(1, -5, 1), Axes{7}};
  hand.ramp = Ramp{0, 1};
  scene.instruments.push_back(hand);
  scene.fracture.model = model;
  scene.fracture.birth = CrackBirth::through;
  scene.fracture.max_events = 4;
  scene.steps = moves ? 24 : 8;
  scene.gravity = Vec3(0, -9810, 0);
  if (moves) {
    scene.dynamics = Dynamics{.time_step = 0.002};
    scene.dynamics->stiffness_damping = 1e-4;
  }
  scene.solver.tolerance = kTight;
  return scene;
}

struct Course {
  Fractures destroyed;
  std::vector<Vec3> displacement;
  std::vector<Voigt> stress;
  std::vector<double> kinetic;
  std::vector<std::string> warnings;
  BackendInfo info;
};

Course run(const std::shared_ptr<const Problem>& problem, std::unique_ptr<Backend> backend) {
  Simulation simulation(problem, std::move(backend));
  Course of;
  while (!simulation.done()) {
    const StepReport report = simulation.step();
    if (report.motion) of.kinetic.push_back(report.motion->kinetic);
  }
  of.destroyed = simulation.destroyed();
  of.displacement = simulation.displacement();
  of.stress = simulation.stress();
  of.warnings = simulation.warnings();
  of.info = simulation.backend().info();
  return of;
}

Course run_on_cpu(Scene scene) {
  scene.solver.precision = Precision::automatic;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  return run(problem, cpu_reference::create(problem, needs_of(*problem)));
}

double table_error(Precision precision) {
  return precision == Precision::fp32 ? kFp32Tolerance : kCrackTolerance;
}

/// What the host knows of elements at the decision at which the lists part: run again up to there.
std::function<Yielding(Index)> yielding_at(Scene scene, const Parting& parting, double error) {
  scene.solver.precision = Precision::automatic;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  std::vector<Voigt> stress;
  simulation.observe_frames([&] {
    if (simulation.steps_done() == parting.step && simulation.destroyed().size() == parting.before)
      stress = simulation.stress();
  });
  while (simulation.steps_done() <= parting.step) simulation.step();
  double largest = 0;
  for (const Voigt& s : stress) largest = std::max(largest, tensor_norm(s));
  return [=](Index e) {
    return Yielding{max_shear(stress[static_cast<std::size_t>(e)]) / problem->yield(e),
                    error * largest / problem->yield(e)};
  };
}

/// The same lists, or such as part where a ratio lies in the named band; with the same lists the
/// same fields, within the accuracy table.
void expect_alike(const Scene& scene, const Course& found, const Course& expected,
                  Precision precision) {
  const double allowed = table_error(precision);
  EXPECT_GE(expected.destroyed.size(), 4u);
  if (const auto at = parting(expected.destroyed, found.destroyed)) {
    const std::string why =
        excuse(*at, expected.destroyed, found.destroyed, yielding_at(scene, *at, allowed));
    ASSERT_NE(why, "") << "the lists part after " << at->index << " fractures, in step " << at->step
                       << ", where no ratio is near the limit";
    std::printf("the lists part after %zu fractures: %s\n", at->index, why.c_str());
    return;
  }
  const Problem problem(scene);
  std::vector<std::uint8_t> gone(problem.mesh().tets.size(), 0);
  for (const DestroyedElement& d : expected.destroyed)
    gone[static_cast<std::size_t>(d.element)] = 1;
  const auto u_of = [](const Course& of) {
    return std::span<const double>(of.displacement.front().data(), 3 * of.displacement.size());
  };
  const double u = displacement_error(problem.mesh(), gone, u_of(found), u_of(expected)),
               stress = stress_error(gone, found.stress, expected.stress);
  std::printf("%zu fractures: errors of u %.1e, of stress %.1e\n", expected.destroyed.size(), u,
              stress);
  EXPECT_LE(u, allowed);
  EXPECT_LE(stress, allowed);
  for (std::size_t i = 0; i < expected.kinetic.size(); ++i) {
    // Twice the relative error of the velocities, which differences of displacements are.
    EXPECT_NEAR(found.kinetic[i], expected.kinetic[i], 100 * allowed * expected.kinetic[i]) << i;
  }
}

struct Sheet {
  const char* name;
  bool moves;
  MaterialLaw law;
  FractureModel model;
  Precision precision = Precision::fp64;
  Route route = Route::automatic;
};

using FiniteRoutes = WithVulkan<>;
class FiniteScenes : public WithVulkan<testing::TestWithParam<Sheet>> {};

TEST_P(FiniteScenes, TearAsOnTheHost) {
  const Sheet& of = GetParam();
  Scene scene = torn_sheet(of.moves, of.law, of.model);
  if (of.route == Route::cg) scene.solver.tolerance = 10 * kTight;  // a software device's time
  const Course expected = run_on_cpu(scene);
  WatchedBackend watched(
      scene, {.precision = of.precision, .tolerance = scene.solver.tolerance, .route = of.route});
  const Course found = run(watched.problem, watched.create());
  expect_alike(scene, found, expected, of.precision);
  EXPECT_EQ(found.info.backend, "vulkan");
  EXPECT_EQ(found.info.precision, of.precision == Precision::fp64 ? "fp64" : "fp32");
  const Course again = run(watched.problem, watched.create());
  EXPECT_EQ(again.displacement, found.displacement);
}

INSTANTIATE_TEST_SUITE_P(
    All, FiniteScenes,
    ::testing::Values(
        Sheet{"corotated_A", false, MaterialLaw::corotated, FractureModel::a},
        Sheet{"neo_hookean_B", false, MaterialLaw::neo_hookean, FractureModel::b},
        Sheet{"motion_corotated_B", true, MaterialLaw::corotated, FractureModel::b},
        Sheet{"motion_neo_hookean_A", true, MaterialLaw::neo_hookean, FractureModel::a},
        Sheet{"motion_neo_hookean_A_fp32", true, MaterialLaw::neo_hookean, FractureModel::a,
              Precision::fp32},
        Sheet{"by_factor", false, MaterialLaw::corotated, FractureModel::a, Precision::fp64,
              Route::factor},
        Sheet{"motion_by_factor", true, MaterialLaw::neo_hookean, FractureModel::a, Precision::fp64,
              Route::factor},
        Sheet{"motion_corotated_by_cg", true, MaterialLaw::corotated, FractureModel::b,
              Precision::fp64, Route::cg},
        Sheet{"motion_neo_hookean_by_cg_fp32", true, MaterialLaw::neo_hookean, FractureModel::a,
              Precision::fp32, Route::cg},
        Sheet{"motion_kirchhoff_A", true, MaterialLaw::saint_venant_kirchhoff, FractureModel::a},
        Sheet{"motion_linear_A", true, MaterialLaw::linear, FractureModel::a}),
    [](const auto& tested) { return std::string(tested.param.name); });

// Small bodies by an inverse, others in motion without a base at all, at rest by the host's factor.
TEST_F(FiniteRoutes, AutoGoesBySize) {
  const auto info_of = [](bool moves, Index cells) {
    Scene scene = torn_sheet(moves, MaterialLaw::corotated, FractureModel::a);
    scene.mesh = structured_board({cells, cells, cells, 8, 8, 8});
    scene.solver.backend = "vulkan";
    scene.solver.tolerance = 1e-4;
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    const auto backend = gpu::create(problem, needs_of(*problem), {});
    const std::vector<std::string>& left_out = backend->needs().left_out;
    const bool without_forces = std::ranges::any_of(left_out, [](const std::string& text) {
      return text.find("forces of grips between frames") == 0;
    });
    EXPECT_EQ(without_forces, backend->info().route == "cg");
    EXPECT_EQ(backend->instrument_forces() == nullptr, backend->info().route == "cg");
    return backend->info();
  };
  EXPECT_EQ(info_of(true, 4).route, "inverse");
  EXPECT_EQ(info_of(false, 4).route, "inverse");
  const BackendInfo moving = info_of(true, 11);
  EXPECT_EQ(moving.route, "cg");
  EXPECT_NE(moving.why.find("conjugate gradients on the tangent of every state, on the device"),
            std::string::npos);
  const BackendInfo resting = info_of(false, 11);
  EXPECT_EQ(resting.route, "factor");
  EXPECT_NE(resting.why.find("by the host; forces and stress on the device"), std::string::npos);
}

struct Loss {
  bool moves;
  Route route;
};
class FiniteDeviceLost : public WithVulkan<testing::TestWithParam<Loss>> {};

TEST_P(FiniteDeviceLost, InMidStepTheHostGoesOnFromTheLastState) {
  Scene scene = torn_sheet(GetParam().moves, MaterialLaw::neo_hookean, FractureModel::a);
  const Course expected = run_on_cpu(scene);
  WatchedBackend watched(scene, {.tolerance = kTight, .route = GetParam().route});
  int losses = 0;
  for (const int submits : {2, 9, 40, 77, 150, 400}) {
    watched.options.probe.submits_until_lost = submits;
    std::unique_ptr<Backend> backend;
    try {
      backend = watched.create();
    } catch (const sunder::DeviceLost&) {
      continue;  // while it was made
    }
    const Course found = run(watched.problem, std::move(backend));
    expect_alike(scene, found, expected, Precision::fp64);
    const bool lost = found.info.why.find("took over") != std::string::npos;
    losses += lost;
    EXPECT_EQ(std::ranges::any_of(found.warnings,
                                  [](const std::string& text) {
                                    return text.find("backend vulkan failed in mid-run") == 0;
                                  }),
              lost);
  }
  EXPECT_GE(losses, 3);
}

INSTANTIATE_TEST_SUITE_P(All, FiniteDeviceLost,
                         ::testing::Values(Loss{false, Route::inverse}, Loss{true, Route::inverse},
                                           Loss{true, Route::cg}),
                         [](const auto& tested) {
                           return std::string(tested.param.moves ? "moving_" : "resting_") +
                                  (tested.param.route == Route::cg ? "cg" : "inverse");
                         });

using FiniteRefusals = WithVulkan<>;

TEST_F(FiniteRefusals, SayWhatWouldDo) {
  const auto refusal = [](Scene scene,
                          const std::function<void(gpu::VulkanOptions&)>& adjust = {}) {
    scene.solver.backend = "vulkan";
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    gpu::VulkanOptions options;
    if (adjust) adjust(options);
    return message_of(
        [&] { static_cast<void>(gpu::create(problem, needs_of(*problem), options)); });
  };
  Scene resting = torn_sheet(false, MaterialLaw::corotated, FractureModel::a);
  resting.solver.tolerance = 1e-4;
  resting.solver.route = Route::cg;
  EXPECT_EQ(refusal(resting),
            "route cg cannot serve law \"corotated\": whether a rest is stable is judged by a "
            "factor of its tangent; use route inverse, factor or auto");
  Scene scene = torn_sheet(true, MaterialLaw::corotated, FractureModel::a);
  scene.solver.tolerance = 1e-4;
  EXPECT_NE(refusal(scene, [](gpu::VulkanOptions& o) { o.probe.no_float64 = true; })
                .find("lacks shaderFloat64, which motion needs"),
            std::string::npos);
  EXPECT_NE(refusal(scene, [](gpu::VulkanOptions& o) { o.probe.memory = 100000; })
                .find("bytes on the device"),
            std::string::npos);
}

}  // namespace
}  // namespace sunder::test
