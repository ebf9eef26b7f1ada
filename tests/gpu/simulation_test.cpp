// SPDX-License-Identifier: Apache-2.0
// Whole runs and frames on Vulkan, by the frame's own interface.
#include "sunder/simulation.hpp"
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

// The scenes' tests do so by the deferred update.
TEST_F(Runs, SameFractureListsAsTheReferenceByEagerUpdates) {
  for (const FractureModel model : {FractureModel::a, FractureModel::b}) {
    Scene scene = torn_board(model);
    scene.solver.backend = "cpu";
    const auto on_cpu = std::make_shared<const Problem>(scene);
    const auto reference = destroyed_by(on_cpu, cpu_reference::create(on_cpu, needs_of(*on_cpu)));
    EXPECT_GE(reference.size(), 10u);
    for (const Way& way : all_ways()) {
      if (way.update != Update::eager) continue;
      if (way.variant == gpu::Variant::gpu && model == FractureModel::a) continue;  // time
      const WatchedBackend watched(scene, way);
      EXPECT_EQ(destroyed_by(watched.problem, watched.create()), reference) << name_of(way);
    }
  }
}

/// The measures of each step of a board that tears until a piece comes off.
TEST_F(Runs, DeformationIsThatOfTheReferenceAndForgetsPiecesThatComeOff) {
  Scene scene = pulled_board(Vec3(0, -6e-3, 0));
  scene.instruments.front().ramp = Ramp{0, 1};
  Instrument above;
  above.name = "above the cut";
  above.action = Pull{Box{Vec3(49.9, 35, -1), Vec3(51, 45, 3)}, Vec3(5, 0, 0)};
  scene.instruments.push_back(above);
  scene.removals.push_back({1, Box{Vec3(-1, 22, -1), Vec3(51, 28, 3)}});
  scene.steps = 3;
  const auto measured = [](const std::shared_ptr<const Problem>& problem,
                           std::unique_ptr<Backend> backend) {
    Simulation simulation(problem, std::move(backend));
    std::vector<Deformation> all;
    while (!simulation.done()) all.push_back(simulation.step().deformation.value());
    return all;
  };
  scene.solver.backend = "cpu";
  const auto on_cpu = std::make_shared<const Problem>(scene);
  const auto expected = measured(on_cpu, cpu_reference::create(on_cpu, needs_of(*on_cpu)));
  for (const Way& way : all_ways()) {
    if (way.update == Update::eager) continue;
    const WatchedBackend watched(scene, way);
    const auto found = measured(watched.problem, watched.create());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double allowed = way.precision == Precision::fp64 ? 1e-5 : 1e-3;
      EXPECT_NEAR(found[i].strain, expected[i].strain, allowed * std::abs(expected[i].strain))
          << name_of(way) << ", step " << i;
      const double of_axis = expected[i].strain * expected[i].strain;
      EXPECT_NEAR(found[i].rotation_deg, expected[i].rotation_deg,
                  (allowed + 1e-3 + of_axis) * expected[i].rotation_deg)
          << name_of(way) << ", step " << i;
      EXPECT_EQ(found[i].inverted, expected[i].inverted) << name_of(way) << ", step " << i;
    }
  }
}

TEST_F(Runs, VulkanByNameGoesThroughTheListOfBackends) {
  Scene scene = torn_board(FractureModel::a);
  scene.solver.backend = "vulkan";
  const auto problem = std::make_shared<const Problem>(scene);
  const auto created = create_backend(problem, needs_of(*problem));
  EXPECT_EQ(created.backend->info().backend, "vulkan");
  EXPECT_EQ(created.backend->info().route, "inverse");
}

TEST_F(Runs, ASolveThatCannotKeepItsPromiseLeavesTheLastOneReadable) {
  for (const Route route : {Route::inverse, Route::condensed, Route::cg}) {
    Way way{.update = Update::automatic, .tolerance = 1e-18, .route = route};
    const WatchedBackend watched(held_board(), way);
    const auto backend = watched.create(all_needs());
    backend->set_load({{}, {}, {}});
    backend->solve();
    backend->stress();
    backend->set_load(corner_pull(*watched.problem));
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
