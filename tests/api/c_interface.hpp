// SPDX-License-Identifier: Apache-2.0
// Two cubes of 1 mm side by side that an interface joins, built through the C interface: held at
// one end, pulled at the other. Poisson's ratio is 0, so a pull along x is the same everywhere.
#pragma once

#include <vector>

#include "api/c_scene.hpp"

namespace sunder::test {

constexpr std::size_t kHostNodes = 12, kHostTets = 12;
/// The face's four nodes twice, and three elements for each of its two triangles.
constexpr std::size_t kBodyNodes = 16, kBodyTets = 18;

constexpr double kStrength = 0.2, kEnergy = 0.05;  // MPa, N/mm
constexpr double kPull = 0.8;                      // mm

inline Mesh two_cubes() {
  return structured_board({2, 1, 1, 2, 1, 1},
                          [](const Vec3& x) { return x[0] < 1 ? "left" : "right"; });
}

/// What is pulled [mm], over all steps.
inline sunder_instrument pulled(const sunder_selection& nodes, double x, double y) {
  sunder_instrument grip = SUNDER_INSTRUMENT_INIT;
  grip.kind = SUNDER_DISPLACEMENT;
  grip.nodes = nodes;
  grip.value[0] = x;
  grip.value[1] = y;
  grip.has_ramp = 1;
  grip.ramp[1] = 1;
  return grip;
}

/// Without the interface, and nothing pulls.
inline sunder_scene cubes_scene() {
  sunder_scene scene = nullptr;
  EXPECT_OK(sunder_scene_create(&scene));
  const Mesh mesh = two_cubes();
  std::vector<double> nodes;
  std::vector<std::int32_t> tets;
  for (const Vec3& x : mesh.nodes) nodes.insert(nodes.end(), x.data(), x.data() + 3);
  for (const auto& t : mesh.tets) tets.insert(tets.end(), t.begin(), t.end());
  EXPECT_OK(sunder_scene_set_mesh(scene, nodes.data(), nodes.size(), tets.data(), tets.size(),
                                  mesh.volume_of.data(), mesh.volume_of.size()));
  for (const char* name : {"left", "right"}) {
    sunder_material tissue = SUNDER_MATERIAL_INIT;
    tissue.young = 5;
    tissue.law = SUNDER_LAW_NEO_HOOKEAN;
    tissue.name = name;
    EXPECT_OK(sunder_scene_add_material(scene, &tissue, nullptr));
  }
  sunder_support support = SUNDER_SUPPORT_INIT;
  support.nodes = box(-0.1, -1, 0.1, 2);
  EXPECT_OK(sunder_scene_add_support(scene, &support));
  const auto fracture = model(SUNDER_FRACTURE_A);
  EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
  const auto solver = on(SUNDER_BACKEND_CPU);
  EXPECT_OK(sunder_scene_set_solver(scene, &solver));
  EXPECT_OK(sunder_scene_set_steps(scene, 4));
  return scene;
}

inline sunder_simulation joined_cubes(double shear_ratio = 1) {
  const sunder_scene scene = cubes_scene();
  const sunder_instrument grip = pulled(box(1.9, -1, 2.1, 2), kPull, 0);
  EXPECT_OK(sunder_scene_add_instrument(scene, &grip, nullptr));
  EXPECT_OK(sunder_scene_add_interface(scene, 0, 1, kStrength, kEnergy, shear_ratio));
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  return simulation;
}

}  // namespace sunder::test
