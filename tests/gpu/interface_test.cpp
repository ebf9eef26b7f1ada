// SPDX-License-Identifier: Apache-2.0
// Interfaces part on Vulkan as they part on the CPU: pulled askew in statics and in motion, with
// viscous tissue beside them.
#include <cmath>

#include "core/interface/bonded_blocks.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "gpu_body.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

struct InterfaceWay {
  const char* name;
  bool moves;
  Route route;
};

class InterfacesOnTheDevice : public WithVulkan<testing::TestWithParam<InterfaceWay>> {};

Scene pulled_askew(bool moves) {
  Scene scene = blocks(tissue(2), 1.5);
  move_top(scene, Vec3(0.26, 0.05, 0.4), moves ? 40 : 12);
  if (moves) {
    scene.dynamics = Dynamics{.time_step = 0.004, .mass_damping = 50, .stiffness_damping = 0.002};
  }
  return scene;
}

TEST_P(InterfacesOnTheDevice, PartAsOnTheProcessor) {
  Scene scene = pulled_askew(GetParam().moves);
  scene.solver = {.backend = "cpu", .tolerance = 1e-9};
  const auto reference = std::make_shared<const Problem>(scene);
  const WatchedBackend vulkan(
      scene, {.precision = Precision::fp64, .tolerance = 1e-9, .route = GetParam().route});
  Simulation expected(reference, cpu_reference::create(reference, needs_of(*reference)));
  Simulation found(vulkan.problem, vulkan.create());
  EXPECT_EQ(found.backend().info().backend, "vulkan");
  StepReport at, on_device;
  while (!expected.done()) {
    at = expected.step();
    on_device = found.step();
    ASSERT_TRUE(at.deformation && on_device.deformation);
    EXPECT_NEAR(on_device.deformation->strain, at.deformation->strain, 1e-6);
    EXPECT_EQ(on_device.deformation->inverted, 0);
  }
  ASSERT_EQ(expected.destroyed().size(), 24u);
  ASSERT_EQ(found.destroyed().size(), expected.destroyed().size());
  for (std::size_t i = 0; i < found.destroyed().size(); ++i) {
    const DestroyedElement &a = found.destroyed()[i], &b = expected.destroyed()[i];
    EXPECT_EQ(a.element, b.element) << i;
    EXPECT_EQ(a.step, b.step) << i;
    EXPECT_EQ(a.cause, Cause::parting) << i;
    EXPECT_NEAR(*a.ratio, *b.ratio, 1e-6) << i;
    EXPECT_NEAR(*a.energy, *b.energy, 1e-6 * *b.energy) << i;
  }
  if (!GetParam().moves) return;
  EXPECT_NEAR(on_device.motion->broken, at.motion->broken, 1e-6 * at.motion->broken);
  EXPECT_NEAR(on_device.motion->damped, at.motion->damped, 1e-5 * at.motion->damped);
}

INSTANTIATE_TEST_SUITE_P(All, InterfacesOnTheDevice,
                         testing::Values(InterfaceWay{"statics", false, Route::inverse},
                                         InterfaceWay{"motion", true, Route::inverse},
                                         InterfaceWay{"motion_cg", true, Route::cg}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace sunder::test
