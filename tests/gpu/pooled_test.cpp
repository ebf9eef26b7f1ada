// SPDX-License-Identifier: Apache-2.0
// Pooled volume on Vulkan: frames along fractures against a fresh factor, runs that tear as on the
// CPU by every law, at rest and in motion, and what is refused.
#include <algorithm>
#include <string>

#include "body/pools.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "gpu_body.hpp"
#include "sunder/simulation.hpp"
#include "support/pooled_body.hpp"

namespace sunder::test {
namespace {

struct PooledAlong {
  const char* name;
  Route route;
  double nu;
  bool crack;
  Precision precision = Precision::fp64;
  double tolerance = kCrackTolerance;
  gpu::Variant variant = gpu::Variant::lvp;
};

/// A solution under a load against a fresh factor of the body that the record is of.
void expect_as_fresh(Backend& backend, const fem::DamagedBody& record,
                     const std::vector<double>& force, std::span<const std::uint8_t> ignored,
                     double tolerance) {
  const Problem& problem = record.problem();
  std::vector<double> u(problem.dofs().size());
  std::vector<Voigt> stress(problem.mesh().tets.size());
  backend.set_load(load_of(problem, force, {}));
  backend.solve();
  backend.stress();
  backend.read_displacement(u);
  backend.read_stress(stress);
  const FreshSolution right(record, force);
  EXPECT_LE(displacement_error(problem.mesh(), ignored, u, right.displacement), tolerance);
  EXPECT_LE(stress_error(ignored, stress, right.stress), tolerance);
}

class PooledFrames : public WithVulkan<testing::TestWithParam<PooledAlong>> {};

TEST_P(PooledFrames, AgreeWithAFreshFactorAlongFractures) {
  const PooledAlong& along = GetParam();
  Scene scene = pooled_board(along.nu);
  scene.live = true;
  const Update update = along.route == Route::cg ? Update::automatic : Update::deferred;
  const WatchedBackend vulkan(scene, {.variant = along.variant,
                                      .precision = along.precision,
                                      .update = update,
                                      .route = along.route});
  const auto backend = vulkan.create();
  const Problem& problem = *vulkan.problem;
  fem::DamagedBody record(vulkan.problem);
  const std::vector<Index> sequence =
      along.crack ? crack_sequence(problem, 200, 12) : scattered_sequence(problem, 200);
  const std::vector<double> force = pull_at_corner(problem);
  std::size_t done = 0;
  for (std::size_t k : {0U, 1U, 10U, 50U, 200U}) {
    while (done < k) {
      const std::size_t size = done < 10 ? 1 : 5;
      const auto event = std::span(sequence).subspan(done, size);
      backend->destroy(event);
      record.destroy(event);
      done += size;
      backend->set_load(load_of(problem, force, {}));
      if (along.route == Route::inverse || done == k) backend->solve();
    }
    SCOPED_TRACE("after " + std::to_string(k));
    expect_as_fresh(*backend, record, force, not_attached(record), along.tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, PooledFrames,
    testing::Values(PooledAlong{"inverse", Route::inverse, 0.499, true},
                    PooledAlong{"scattered", Route::inverse, 0.4, false},
                    PooledAlong{"fp32", Route::inverse, 0.49, true, Precision::fp32, 1e-4},
                    PooledAlong{"gpu", Route::inverse, 0.499, true, Precision::fp64,
                                kCrackTolerance, gpu::Variant::gpu},
                    PooledAlong{"cg", Route::cg, 0.49, true}),
    [](const auto& tested) { return std::string(tested.param.name); });

struct PooledWay {
  const char* name;
  MaterialLaw law;
  bool moves;
  Route route;
  bool fibres = false;
  gpu::Variant variant = gpu::Variant::lvp;
};

class PooledOnTheDevice : public WithVulkan<testing::TestWithParam<PooledWay>> {};

/// Pulled until it tears, "board" of pooled volume beside "soft" without.
Scene pooled_strip(const PooledWay& way) {
  Scene scene;
  scene.mesh = structured_board({4, 6, 2, 4, 6, 2}, [](const Vec3& x) {
    return x.x() < 3 ? std::string("board") : std::string("soft");
  });
  const bool linear = way.law == MaterialLaw::linear;
  Material m{2, 0.3, linear ? 0.2 : way.law == MaterialLaw::neo_hookean ? 0.4 : 0.6};
  m.law = way.law;
  m.density = 1e-9;
  scene.materials["board"] = scene.materials["soft"] = m;
  scene.materials["board"].poisson = 0.49;
  scene.materials["board"].volume = MaterialVolume::pooled;
  if (way.fibres) {
    Fibres f;
    f.direction = Vec3(1, 2, 0.3);
    f.k1 = 0.4;
    f.k2 = 1;
    scene.materials["board"].fibres = {f};
  }
  scene.supports.push_back({Box{Vec3(-1, 5.9, -1), Vec3(9, 9, 9)}, Axes{}});
  const Vec3 way_down(0.6, linear ? -1.2 : -2.0, 0.2);
  scene.instruments.push_back(
      {"grip", Grip{Box{Vec3(-1, -1, -1), Vec3(9, 0.1, 9)}, way_down, Axes{}}, Ramp{0, 1}});
  scene.fracture.model = FractureModel::a;
  scene.fracture.max_events = 4;
  scene.steps = way.moves ? 24 : 6;
  if (way.moves) {
    scene.dynamics = Dynamics{.time_step = 0.004, .mass_damping = 20, .stiffness_damping = 0.001};
  }
  return scene;
}

TEST_P(PooledOnTheDevice, DeformsAndTearsAsOnTheProcessor) {
  Scene scene = pooled_strip(GetParam());
  scene.solver = {.backend = "cpu", .tolerance = 1e-10};
  const auto reference = std::make_shared<const Problem>(scene);
  // Conjugate gradients promise a digit less.
  const WatchedBackend vulkan(scene, {.variant = GetParam().variant,
                                      .precision = Precision::fp64,
                                      .update = Update::automatic,
                                      .tolerance = GetParam().route == Route::cg ? 1e-9 : 1e-10,
                                      .route = GetParam().route});
  Simulation expected(reference, cpu_reference::create(reference, needs_of(*reference)));
  Simulation found(vulkan.problem, vulkan.create());
  ASSERT_EQ(found.backend().info().backend, "vulkan");
  while (!expected.done()) {
    expected.step();
    found.step();
    ASSERT_EQ(found.destroyed().size(), expected.destroyed().size());
    expect_alike(found, expected, 1e-7);
  }
  ASSERT_GE(expected.destroyed().size(), 8U);
  for (std::size_t i = 0; i < expected.destroyed().size(); ++i) {
    EXPECT_EQ(found.destroyed()[i].element, expected.destroyed()[i].element) << i;
  }
  EXPECT_LE((found.support_reaction() - expected.support_reaction()).norm(),
            1e-7 * std::max(expected.support_reaction().norm(), 1e-2));
}

INSTANTIATE_TEST_SUITE_P(
    All, PooledOnTheDevice,
    testing::Values(PooledWay{"linear", MaterialLaw::linear, false, Route::inverse},
                    PooledWay{"linear_cg", MaterialLaw::linear, false, Route::cg},
                    PooledWay{"corotated", MaterialLaw::corotated, false, Route::inverse},
                    PooledWay{"neo_hookean", MaterialLaw::neo_hookean, false, Route::inverse},
                    PooledWay{"neo_hookean_factor", MaterialLaw::neo_hookean, false, Route::factor},
                    PooledWay{"fibres", MaterialLaw::neo_hookean, false, Route::inverse, true},
                    PooledWay{"svk", MaterialLaw::saint_venant_kirchhoff, false, Route::inverse},
                    PooledWay{"linear_moves", MaterialLaw::linear, true, Route::inverse},
                    PooledWay{"corotated_moves", MaterialLaw::corotated, true, Route::inverse},
                    PooledWay{"neo_hookean_moves", MaterialLaw::neo_hookean, true, Route::inverse},
                    PooledWay{"gpu_linear", MaterialLaw::linear, false, Route::inverse, false,
                              gpu::Variant::gpu},
                    PooledWay{"gpu_neo_hookean_moves", MaterialLaw::neo_hookean, true,
                              Route::inverse, false, gpu::Variant::gpu}),
    [](const auto& tested) { return std::string(tested.param.name); });

class PooledPieces : public WithVulkan<testing::TestWithParam<PooledAlong>> {};

// A piece that comes off shares no pressure with what is left: displacement, stress and what a
// solution says of its own error are those of the patches as they are split.
TEST_P(PooledPieces, ShareNoPressure) {
  const PooledAlong& along = GetParam();
  Scene scene = pooled_board(along.nu);
  scene.live = true;
  const WatchedBackend vulkan(scene, {.variant = along.variant,
                                      .precision = along.precision,
                                      .update = Update::automatic,
                                      .route = along.route});
  const auto backend = vulkan.create();
  const Problem& problem = *vulkan.problem;
  fem::DamagedBody record(vulkan.problem), torn(vulkan.problem);
  const CutAcross cut(problem, 33);
  torn.destroy(cut.elements);
  const std::vector<double> force = inflate_beside(cut, torn);
  const std::vector<std::uint8_t> ignored = not_attached(torn);
  const std::size_t half = cut.elements.size() / 2;
  for (const auto event : {std::span<const Index>{}, std::span(cut.elements).first(half),
                           std::span(cut.elements).subspan(half)}) {
    if (!event.empty()) {
      backend->destroy(event);
      record.destroy(event);
    }
    expect_as_fresh(*backend, record, force, ignored, along.tolerance);
  }
  EXPECT_GT(record.forms().pools()->count(), problem.pools()->count() + 1);
}

INSTANTIATE_TEST_SUITE_P(
    All, PooledPieces,
    testing::Values(PooledAlong{"inverse", Route::inverse, 0.4, false},
                    PooledAlong{"fp32", Route::inverse, 0.4, false, Precision::fp32, 1e-4},
                    PooledAlong{"cg", Route::cg, 0.4, false},
                    PooledAlong{"gpu_inverse", Route::inverse, 0.4, false, Precision::fp64,
                                kCrackTolerance, gpu::Variant::gpu},
                    PooledAlong{"gpu_cg", Route::cg, 0.4, false, Precision::fp64, kCrackTolerance,
                                gpu::Variant::gpu}),
    [](const auto& tested) { return std::string(tested.param.name); });

class PooledFlight : public WithVulkan<> {};

// A piece that flies off through patches has patches of its own, on the device too, and none any
// more when it is back.
TEST_F(PooledFlight, IsAsOnTheProcessor) {
  Scene scene = pooled_board(0.49);
  for (auto& [name, material] : scene.materials) {
    material.law = MaterialLaw::neo_hookean;
    material.density = 1e-9;
  }
  std::get<Pull>(scene.instruments[0].action).force = Vec3(0, -5, 0);
  scene.dynamics = Dynamics{.time_step = 1e-4, .stiffness_damping = 1e-4};
  scene.fracture.model = FractureModel::none;
  scene.live = true;
  scene.steps = 1000;
  scene.solver = {.backend = "cpu", .tolerance = 1e-9};
  const auto reference = std::make_shared<const Problem>(scene);
  const WatchedBackend vulkan(
      scene, {.precision = Precision::fp64, .update = Update::automatic, .tolerance = 1e-9});
  Simulation expected(reference, cpu_reference::create(reference, needs_of(*reference))),
      found(vulkan.problem, vulkan.create());
  expected.keep_history([&] { return cpu_reference::create(reference, needs_of(*reference)); });
  found.keep_history([&] { return vulkan.create(); });
  const auto both = [&](const char* when) {
    SCOPED_TRACE(when);
    expect_alike(found, expected, 1e-6);
  };
  const CutAcross cut = cut_through_a_patch(*reference);
  for (Simulation* of : {&expected, &found}) of->step();
  both("whole");
  for (Simulation* of : {&expected, &found}) of->remove(cut.elements);
  for (int step = 0; step < 2; ++step) {
    for (Simulation* of : {&expected, &found}) of->step();
    both("cut");
  }
  for (Simulation* of : {&expected, &found}) of->undo(1);
  for (Simulation* of : {&expected, &found}) of->step();
  both("whole again");
  EXPECT_EQ(found.destroyed().size(), 0U);
}

class PooledRefusals : public WithVulkan<> {
 protected:
  static std::string refused(const PooledWay& way, const Way& as) {
    const WatchedBackend vulkan(pooled_strip(way), as);
    return message_of([&] { static_cast<void>(vulkan.create()); });
  }
};

TEST_F(PooledRefusals, SayWhatCan) {
  const PooledWay still{"", MaterialLaw::linear, false, Route::inverse},
      moves{"", MaterialLaw::neo_hookean, true, Route::cg};
  EXPECT_EQ(refused(still, {.update = Update::automatic, .route = Route::condensed}),
            "route condensed does not compute pooled volume (volume = \"pooled\"); use route "
            "factor, inverse or cg");
  EXPECT_EQ(refused(still, {.update = Update::eager}),
            "update eager on backend vulkan writes over an inverse element by element and does not "
            "compute pooled volume (volume = \"pooled\"); use update deferred or auto, or backend "
            "cpu");
  EXPECT_EQ(refused(moves, {.update = Update::automatic, .route = Route::cg}),
            "route cg cannot serve motion: it knows the tangents of elements, not those of patches "
            "of pooled volume; use route inverse, factor or auto");
}

TEST_F(PooledRefusals, ADeviceWithoutDoublesIsTold) {
  const std::string told = refused({"", MaterialLaw::linear, false, Route::inverse},
                                   {.precision = Precision::fp32, .float64 = false});
  EXPECT_NE(told.find("lacks shaderFloat64, which pooled volume (volume = \"pooled\") needs"),
            std::string::npos)
      << told;
}

}  // namespace
}  // namespace sunder::test
