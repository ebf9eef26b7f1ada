// SPDX-License-Identifier: Apache-2.0
// Motion by the C interface: a body that falls, steps by the host's time, velocities, what statics
// refuses.
#include <cmath>
#include <limits>
#include <vector>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

class CMotion : public testing::Test {
 protected:
  ~CMotion() override {
    if (simulation) {
      EXPECT_OK(sunder_simulation_destroy(simulation));
    }
    EXPECT_OK(sunder_scene_destroy(scene));
  }
  /// A board that nothing holds, under gravity.
  void make(bool moves) {
    EXPECT_OK(sunder_scene_create(&scene));
    const Arrays a = board_arrays(4);
    EXPECT_OK(sunder_scene_set_mesh(scene, a.nodes.data(), a.nodes.size(), a.tets.data(),
                                    a.tets.size(), nullptr, 0));
    sunder_material tissue = SUNDER_MATERIAL_INIT;
    tissue.young = 5;
    tissue.poisson = 0.3;
    tissue.law = SUNDER_LAW_COROTATED;
    tissue.density = 1e-9;
    EXPECT_OK(sunder_scene_add_material(scene, &tissue, nullptr));
    const double gravity[3] = {0, -9810, 0};
    EXPECT_OK(sunder_scene_set_gravity(scene, gravity));
    if (moves) {
      sunder_dynamics dynamics = SUNDER_DYNAMICS_INIT;
      dynamics.time_step = 0.01;
      EXPECT_OK(sunder_scene_set_dynamics(scene, &dynamics));
    } else {
      const sunder_support support = top_support();
      EXPECT_OK(sunder_scene_add_support(scene, &support));
    }
    EXPECT_OK(sunder_scene_set_steps(scene, 10));
    const auto solver = on(SUNDER_BACKEND_CPU);
    EXPECT_OK(sunder_scene_set_solver(scene, &solver));
    nodes = a.nodes;
  }

  sunder_scene scene = nullptr;
  sunder_simulation simulation = nullptr;
  std::vector<double> nodes;
};

TEST_F(CMotion, ABodyFallsByTheHostsTime) {
  make(true);
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  sunder_step step = SUNDER_STEP_INIT;
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  EXPECT_EQ(step.moves, 1);
  EXPECT_EQ(step.capped, 0);
  EXPECT_DOUBLE_EQ(step.time, 0.01);
  EXPECT_DOUBLE_EQ(step.load_factor, 0.1);
  ASSERT_OK(sunder_simulation_step_by(simulation, 0.025, &step));
  EXPECT_NEAR(step.time, 0.035, 1e-15);
  EXPECT_NEAR(step.load_factor, 0.35, 1e-14);
  EXPECT_LT(step.momentum[1], 0);
  EXPECT_NEAR(step.work, step.kinetic + step.strain_energy + step.dissipated, 1e-12 * step.work);
  std::vector<double> v(nodes.size());
  ASSERT_OK(sunder_simulation_velocity(simulation, v.data(), v.size()));
  for (std::size_t i = 1; i < v.size(); i += 3) EXPECT_NEAR(v[i], -9810 * 0.035, 1e-6);
  for (double& x : v) x = 0;
  ASSERT_OK(sunder_simulation_set_velocity(simulation, v.data(), v.size()));
  ASSERT_OK(sunder_simulation_step_by(simulation, 0.01, &step));
  ASSERT_OK(sunder_simulation_velocity(simulation, v.data(), v.size()));
  for (std::size_t i = 1; i < v.size(); i += 3) EXPECT_NEAR(v[i], -9810 * 0.01, 1e-6);
  EXPECT_EQ(sunder_simulation_velocity(simulation, v.data(), v.size() - 1), SUNDER_ERROR_SIZE);
  v[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sunder_simulation_set_velocity(simulation, v.data(), v.size()), SUNDER_ERROR_VALUE);
  for (const double dt : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(sunder_simulation_step_by(simulation, dt, nullptr), SUNDER_ERROR_VALUE);
  }
}

TEST_F(CMotion, StaticsHasNoTime) {
  make(false);
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_EQ(sunder_simulation_step_by(simulation, 0.01, nullptr), SUNDER_ERROR_ORDER);
  std::vector<double> v(nodes.size());
  EXPECT_EQ(sunder_simulation_velocity(simulation, v.data(), v.size()), SUNDER_ERROR_ORDER);
  EXPECT_EQ(sunder_simulation_set_velocity(simulation, v.data(), v.size()), SUNDER_ERROR_ORDER);
  sunder_step step = SUNDER_STEP_INIT;
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  EXPECT_EQ(step.moves, 0);
  // Gravity: the support holds the whole weight.
  double force[3];
  ASSERT_OK(sunder_simulation_support_reaction(simulation, force, 3));
  const double weight = 10 * 10 * 1 * 1e-9 * 9810;
  EXPECT_NEAR(force[0], 0, 1e-4 * weight);  // statics' residual at the default tolerance
  EXPECT_NEAR(force[1], weight, 1e-4 * weight);
  EXPECT_NEAR(force[2], 0, 1e-4 * weight);
}

TEST_F(CMotion, BadValuesAreRefused) {
  make(true);
  sunder_dynamics dynamics = SUNDER_DYNAMICS_INIT;
  dynamics.time_step = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sunder_scene_set_dynamics(scene, &dynamics), SUNDER_ERROR_VALUE);
  dynamics.time_step = 0;  // of a scene that is checked with the rest
  EXPECT_OK(sunder_scene_set_dynamics(scene, &dynamics));
  EXPECT_EQ(sunder_simulation_create(scene, nullptr, &simulation), SUNDER_ERROR_INPUT);
  const double gravity[3] = {0, std::numeric_limits<double>::infinity(), 0};
  EXPECT_EQ(sunder_scene_set_gravity(scene, gravity), SUNDER_ERROR_VALUE);
  EXPECT_OK(sunder_scene_set_dynamics(scene, nullptr));  // statics again
  EXPECT_EQ(sunder_simulation_create(scene, nullptr, &simulation), SUNDER_ERROR_INPUT);
  EXPECT_EQ(simulation, nullptr);
}

}  // namespace
}  // namespace sunder::test
