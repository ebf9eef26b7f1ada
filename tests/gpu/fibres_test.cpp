// SPDX-License-Identifier: Apache-2.0
// Tissue with fibres on Vulkan deforms and tears as on the CPU: by laws of finite deformation and
// by law linear, one family and two, at rest and in motion.
#include <cmath>

#include "cpu_reference/cpu_reference.hpp"
#include "gpu_body.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

struct FibreWay {
  const char* name;
  MaterialLaw law;
  int families;
  bool moves;
  Route route;
};

class FibresOnTheDevice : public WithVulkan<testing::TestWithParam<FibreWay>> {};

Fibres slanted(const FibreWay& way, const Vec3& direction) {
  Fibres f;
  f.direction = direction;
  if (way.law == MaterialLaw::linear) {
    f.young_along = 9;
    f.poisson_along = 0.3;
    f.shear_along = 2;
  } else {
    f.k1 = 0.4;
    f.k2 = 3;
    f.dispersion = 0.1;
  }
  return f;
}

/// Pulled hard enough that exponents pass 1, "soft" without fibres beside "board" with some.
Scene fibrous_strip(const FibreWay& way) {
  Scene scene;
  scene.mesh = structured_board({4, 6, 1, 4, 6, 1}, [](const Vec3& x) {
    return x.x() < 3 ? std::string("board") : std::string("soft");
  });
  Material m{2, 0.3, way.law == MaterialLaw::linear ? 0.2 : 0.6};
  m.law = way.law;
  m.density = 1e-9;
  scene.materials["board"] = scene.materials["soft"] = m;
  auto& fibres = scene.materials["board"].fibres;
  fibres.push_back(slanted(way, Vec3(1, 2, 0.3)));
  if (way.families == 2) fibres.push_back(slanted(way, Vec3(-1, 1.5, 0)));
  scene.supports.push_back({Box{Vec3(-1, 5.9, -1), Vec3(9, 9, 9)}, Axes{}});
  const Vec3 way_down(0.6, way.law == MaterialLaw::linear ? -1.2 : -2.4, 0.2);
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

TEST_P(FibresOnTheDevice, DeformAndTearAsOnTheProcessor) {
  Scene scene = fibrous_strip(GetParam());
  scene.solver = {.backend = "cpu", .tolerance = 1e-10};
  const auto reference = std::make_shared<const Problem>(scene);
  const WatchedBackend vulkan(
      scene, {.precision = Precision::fp64, .tolerance = 1e-10, .route = GetParam().route});
  Simulation expected(reference, cpu_reference::create(reference, needs_of(*reference)));
  Simulation found(vulkan.problem, vulkan.create());
  ASSERT_EQ(found.backend().info().backend, "vulkan");
  while (!expected.done()) {
    expected.step();
    found.step();
    ASSERT_EQ(found.destroyed().size(), expected.destroyed().size());
    expect_alike(found, expected, 1e-7);
  }
  ASSERT_GE(expected.destroyed().size(), 8u);
  for (std::size_t i = 0; i < expected.destroyed().size(); ++i) {
    EXPECT_EQ(found.destroyed()[i].element, expected.destroyed()[i].element) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, FibresOnTheDevice,
    testing::Values(FibreWay{"one", MaterialLaw::neo_hookean, 1, false, Route::inverse},
                    FibreWay{"two", MaterialLaw::neo_hookean, 2, false, Route::inverse},
                    FibreWay{"corotated", MaterialLaw::corotated, 2, false, Route::inverse},
                    FibreWay{"svk", MaterialLaw::saint_venant_kirchhoff, 1, false, Route::inverse},
                    FibreWay{"linear", MaterialLaw::linear, 1, false, Route::inverse},
                    FibreWay{"motion", MaterialLaw::neo_hookean, 2, true, Route::inverse},
                    FibreWay{"motion_cg", MaterialLaw::neo_hookean, 2, true, Route::cg},
                    FibreWay{"motion_linear_cg", MaterialLaw::linear, 1, true, Route::cg}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace sunder::test
