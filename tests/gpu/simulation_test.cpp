// SPDX-License-Identifier: Apache-2.0
// Whole runs on Vulkan: the reference's fracture lists, and a device lost in the middle.
#include "sunder/simulation.hpp"
#include "failover_backend.hpp"
#include "gpu_body.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using Runs = WithVulkan<>;

Scene torn_board(FractureModel model) {
  Scene scene = pulled_board(Vec3(0, -110, 0));
  scene.instruments.front().ramp = Ramp{0, 1};
  scene.fracture.model = model;
  scene.fracture.max_events = 12;
  scene.steps = 6;
  return scene;
}

std::shared_ptr<const Problem> problem_of(Scene scene, const SolverOptions& solver) {
  scene.solver = solver;
  return std::make_shared<const Problem>(std::move(scene));
}

std::vector<Index> destroyed_by(std::shared_ptr<const Problem> problem,
                                std::unique_ptr<Backend> backend) {
  Simulation simulation(std::move(problem), std::move(backend));
  while (!simulation.done()) simulation.step();
  std::vector<Index> list;
  for (const DestroyedElement& d : simulation.destroyed()) list.push_back(d.element);
  return list;
}

TEST_F(Runs, SameFractureListsAsTheReference) {
  for (const FractureModel model : {FractureModel::a, FractureModel::b}) {
    const Scene scene = torn_board(model);
    const auto on_cpu = problem_of(scene, {.backend = "cpu"});
    const auto reference = destroyed_by(on_cpu, cpu_reference::create(on_cpu, needs_of(*on_cpu)));
    EXPECT_GE(reference.size(), 10u);
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      const auto problem = problem_of(scene, {.backend = "vulkan", .precision = precision});
      EXPECT_EQ(destroyed_by(problem, gpu::create(problem, needs_of(*problem), {})), reference)
          << (precision == Precision::fp64 ? "fp64" : "fp32");
    }
  }
}

TEST_F(Runs, ALostDeviceLosesNothing) {
  const Scene scene = torn_board(FractureModel::a);
  const auto problem = problem_of(scene, {.backend = "vulkan", .precision = Precision::fp64});
  const auto on_cpu = problem_of(scene, {.backend = "cpu"});
  const auto reference = destroyed_by(on_cpu, cpu_reference::create(on_cpu, needs_of(*on_cpu)));
  for (const int submits : {0, 1, 9, 14}) {
    gpu::VulkanOptions options;
    options.probe.submits_until_lost = submits;
    auto primary = gpu::create(problem, needs_of(*problem), options);
    auto backend = with_failover(problem, std::move(primary),
                                 [&] { return cpu_reference::create(on_cpu, needs_of(*on_cpu)); });
    const Backend& watched = *backend;
    Simulation simulation(problem, std::move(backend));
    while (!simulation.done()) simulation.step();
    std::vector<Index> list;
    for (const DestroyedElement& d : simulation.destroyed()) list.push_back(d.element);
    EXPECT_EQ(list, reference) << "lost after " << submits << " submits";
    EXPECT_EQ(watched.info().backend, "cpu");
    EXPECT_NE(watched.info().why.find("device was lost"), std::string::npos);
  }
}

TEST_F(Runs, VulkanByNameGoesThroughTheListOfBackends) {
  const auto problem = problem_of(torn_board(FractureModel::a), {.backend = "vulkan"});
  const auto created = create_backend(problem, needs_of(*problem));
  EXPECT_EQ(created.backend->info().backend, "vulkan");
  EXPECT_EQ(created.backend->info().route, "inverse");
}

TEST_F(Runs, ASolveThatCannotKeepItsPromiseLeavesTheLastOneReadable) {
  Scene scene = held_board();
  for (const Route route : {Route::inverse, Route::cg}) {
    const auto problem =
        problem_of(scene, {.backend = "vulkan", .route = route, .tolerance = 1e-18});
    const auto backend = gpu::create(problem, everything(), {});
    backend->set_load({{}, {}, {}});
    backend->solve();
    backend->stress();
    backend->set_load(corner_pull(*problem));
    EXPECT_THROW(backend->solve(), NumericalError);
    for (double u : Pair::displacement(*backend)) ASSERT_EQ(u, 0);
    for (const Voigt& s : Pair::stress(*backend)) ASSERT_EQ(s, Voigt::Zero());
  }
}

TEST_F(Runs, AQuietFrameOfAScaledLoadKeepsItsEstimate) {
  Pair pair(held_board(), {});
  pair.load(corner_pull(pair.problem(), Vec3(0, -60, 0)));
  const auto first = pair.solve();
  pair.load(corner_pull(pair.problem(), Vec3(0, -75, 0)));
  const auto scaled = pair.solve();
  EXPECT_EQ(scaled.report.error, first.report.error);
  EXPECT_LE(scaled.stress, kIntactTolerance);
  pair.load(corner_pull(pair.problem(), Vec3(5, -75, 0)));
  const auto turned = pair.solve();
  EXPECT_NE(turned.report.error, first.report.error);
  EXPECT_LE(turned.stress, kIntactTolerance);
}

}  // namespace
}  // namespace sunder::test
