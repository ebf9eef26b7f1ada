// SPDX-License-Identifier: Apache-2.0
// Laws of finite deformation and grips that turn, by the C interface.
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

class CFinite : public testing::Test {
 protected:
  ~CFinite() override {
    if (simulation) {
      EXPECT_OK(sunder_simulation_destroy(simulation));
    }
    EXPECT_OK(sunder_scene_destroy(scene));
  }
  /// The board held at its top, its lower edge in a rigid grip.
  void make(int32_t law) {
    EXPECT_OK(sunder_scene_create(&scene));
    const Arrays a = board_arrays(4);
    EXPECT_OK(sunder_scene_set_mesh(scene, a.nodes.data(), a.nodes.size(), a.tets.data(),
                                    a.tets.size(), nullptr, 0));
    sunder_material tissue = SUNDER_MATERIAL_INIT;
    tissue.young = 5;
    tissue.poisson = 0.3;
    tissue.law = law;
    EXPECT_OK(sunder_scene_add_material(scene, &tissue, nullptr));
    const sunder_support support = top_support();
    EXPECT_OK(sunder_scene_add_support(scene, &support));
    sunder_instrument grip = SUNDER_INSTRUMENT_INIT;
    grip.kind = SUNDER_DISPLACEMENT;
    grip.rigid = 1;
    grip.nodes.kind = SUNDER_SELECT_BOX;
    for (int axis = 0; axis < 3; ++axis) grip.nodes.min[axis] = -1, grip.nodes.max[axis] = 99;
    grip.nodes.max[1] = 1e-6;
    EXPECT_OK(sunder_scene_add_instrument(scene, &grip, nullptr));
    EXPECT_OK(sunder_scene_set_steps(scene, 3));
    const auto solver = on(SUNDER_BACKEND_CPU);
    EXPECT_OK(sunder_scene_set_solver(scene, &solver));
    nodes = a.nodes;
  }

  sunder_scene scene = nullptr;
  sunder_simulation simulation = nullptr;
  std::vector<double> nodes;
};

TEST_F(CFinite, ARigidGripTurnsAsTheHandSays) {
  make(SUNDER_LAW_COROTATED);
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  const double turn[3] = {0, 0, 20}, down[3] = {0, -1, 0};
  ASSERT_OK(sunder_simulation_turn(simulation, 0, turn));
  ASSERT_OK(sunder_simulation_drive(simulation, 0, down));
  sunder_step step = SUNDER_STEP_INIT;
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  EXPECT_GT(step.back_solves, 0);
  EXPECT_EQ(step.unfinished, 0);
  EXPECT_GT(step.rotation_max_deg, 5);
  std::vector<double> u(nodes.size());
  ASSERT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
  // Its centroid goes down by 1 mm; every node keeps its distance from it.
  double centre[3] = {0, 0, 0}, moved[3] = {0, 0, 0};
  int count = 0;
  for (std::size_t n = 0; n < nodes.size(); n += 3) {
    if (nodes[n + 1] > 1e-6) continue;
    ++count;
    for (std::size_t i = 0; i < 3; ++i) centre[i] += nodes[n + i], moved[i] += u[n + i];
  }
  ASSERT_GT(count, 3);
  for (double& c : centre) c /= count;
  EXPECT_NEAR(moved[1] / count, -1, 1e-12);
  const double angle = 20 * std::numbers::pi / 180;
  for (std::size_t n = 0; n < nodes.size(); n += 3) {
    if (nodes[n + 1] > 1e-6) continue;
    const double x = nodes[n] - centre[0];
    EXPECT_NEAR(nodes[n] + u[n], centre[0] + x * std::cos(angle), 1e-9);
    EXPECT_NEAR(nodes[n + 1] + u[n + 1], centre[1] - 1 + x * std::sin(angle), 1e-9);
  }
}

TEST_F(CFinite, WhatTurnsNotSaysSo) {
  make(SUNDER_LAW_LINEAR);
  sunder_instrument pull = corner_pull(-1);
  pull.name = "pull";
  pull.nodes.kind = SUNDER_SELECT_BOX;
  for (int axis = 0; axis < 3; ++axis) pull.nodes.min[axis] = -1, pull.nodes.max[axis] = 99;
  pull.nodes.min[1] = 1;
  ASSERT_OK(sunder_scene_add_instrument(scene, &pull, nullptr));
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  const double turn[3] = {0, 0, 20}, bad[3] = {0, NAN, 0};
  EXPECT_EQ(sunder_simulation_turn(simulation, 1, turn), SUNDER_ERROR_VALUE);
  EXPECT_NE(std::string(sunder_last_error()).find("no rigid grip"), std::string::npos);
  EXPECT_EQ(sunder_simulation_turn(simulation, 0, bad), SUNDER_ERROR_VALUE);
  EXPECT_EQ(sunder_simulation_turn(simulation, 0, nullptr), SUNDER_ERROR_NULL);
  EXPECT_OK(sunder_simulation_turn(simulation, 0, turn));
}

TEST_F(CFinite, AttributionIsRefusedWithTheReason) {
  make(SUNDER_LAW_NEO_HOOKEAN);
  sunder_fracture_options fracture = SUNDER_FRACTURE_OPTIONS_INIT;
  fracture.attribution = 1;
  ASSERT_OK(sunder_scene_set_fracture(scene, &fracture));
  EXPECT_NE(sunder_simulation_create(scene, nullptr, &simulation), SUNDER_OK);
  EXPECT_NE(std::string(sunder_last_error()).find("superposition"), std::string::npos);
}

// Displacements of both are promised to a stress error of 1e-8.
TEST_F(CFinite, VulkanComputesThemToo) {
  make(SUNDER_LAW_COROTATED);
  if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) GTEST_SKIP() << "no Vulkan device is expected";
  const auto displacement = [&](sunder_backend backend) {
    auto solver = on(backend);
    solver.tolerance = 1e-8;
    EXPECT_OK(sunder_scene_set_solver(scene, &solver));
    std::vector<double> u(nodes.size());
    const auto created = sunder_simulation_create(scene, nullptr, &simulation);
    if (std::string(sunder_last_error()).find("this build leaves out the backend vulkan") == 0) {
      return std::vector<double>();
    }
    EXPECT_OK(created);
    const double turn[3] = {0, 0, 20}, down[3] = {0, -1, 0};
    EXPECT_OK(sunder_simulation_turn(simulation, 0, turn));
    EXPECT_OK(sunder_simulation_drive(simulation, 0, down));
    EXPECT_OK(sunder_simulation_step(simulation, nullptr));
    EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
    EXPECT_OK(sunder_simulation_destroy(simulation));
    simulation = nullptr;
    return u;
  };
  const std::vector<double> expected = displacement(SUNDER_BACKEND_CPU),
                            found = displacement(SUNDER_BACKEND_VULKAN);
  if (found.empty()) return;
  double apart = 0, norm = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    apart += (found[i] - expected[i]) * (found[i] - expected[i]);
    norm += expected[i] * expected[i];
  }
  EXPECT_GT(norm, 1);
  EXPECT_LE(apart, 1e-16 * norm);
}

// Older callers' materials and grips end before what is new.
TEST_F(CFinite, OlderStructsMeanTheLinearLawAndNoTurn) {
  make(SUNDER_LAW_LINEAR);
  sunder_material older = SUNDER_MATERIAL_INIT;
  older.struct_size = offsetof(sunder_material, law);
  older.young = 5;
  older.law = -1;  // not the caller's memory any more
  EXPECT_OK(sunder_scene_add_material(scene, &older, nullptr));
  sunder_instrument grip = SUNDER_INSTRUMENT_INIT;
  grip.struct_size = offsetof(sunder_instrument, turn);
  grip.turn[0] = NAN;
  EXPECT_OK(sunder_scene_add_instrument(scene, &grip, nullptr));
}

}  // namespace
}  // namespace sunder::test
