// SPDX-License-Identifier: Apache-2.0
// The small body of most tests of the C interface, built through it: a board of 4 x 4 x 1 cells,
// held at the top, pulled at its lower right edge until it tears.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "sunder/sunder.h"
#include "support/structured_board.hpp"

namespace sunder::test {

/// Fails the test with the library's own sentence.
#define EXPECT_OK(call) EXPECT_EQ((call), SUNDER_OK) << sunder_last_error()
#define ASSERT_OK(call) ASSERT_EQ((call), SUNDER_OK) << sunder_last_error()

struct Arrays {
  std::vector<double> nodes;
  std::vector<std::int32_t> tets;
};

inline Arrays board_arrays(Index cells = 4) {
  const Mesh mesh = structured_board({cells, cells, 1, 10, 10, 1});
  Arrays arrays;
  for (const Vec3& x : mesh.nodes) arrays.nodes.insert(arrays.nodes.end(), x.data(), x.data() + 3);
  for (const auto& t : mesh.tets) arrays.tets.insert(arrays.tets.end(), t.begin(), t.end());
  return arrays;
}

inline sunder_selection box(double x0, double y0, double x1, double y1) {
  sunder_selection s{};
  s.kind = SUNDER_SELECT_BOX;
  const double low[] = {x0, y0, -1}, high[] = {x1, y1, 2};
  std::copy_n(low, 3, s.min);
  std::copy_n(high, 3, s.max);
  return s;
}

inline sunder_support top_support() {
  sunder_support support;
  sunder_support_init(&support);
  support.nodes = box(-1, 9.99, 11, 10.01);
  return support;
}

inline sunder_instrument corner_pull(double force = -40) {
  sunder_instrument pull;
  sunder_instrument_init(&pull);
  pull.kind = SUNDER_FORCE;
  pull.nodes = box(9.99, -0.01, 10.01, 0.01);
  pull.value[1] = force;
  return pull;
}

inline sunder_fracture_options model(std::int32_t which) {
  sunder_fracture_options f;
  sunder_fracture_options_init(&f);
  f.model = which;
  return f;
}

inline sunder_solver_options on(sunder_backend backend) {
  sunder_solver_options s;
  sunder_solver_options_init(&s);
  s.backend = backend;
  return s;
}

constexpr int kBoardTets = 96, kBoardNodes = 50;  // of board_scene() as it is by itself

/// A scene that tears within its 4 steps, unless `force` says otherwise.
inline sunder_scene board_scene(sunder_backend backend = SUNDER_BACKEND_CPU, Index cells = 4,
                                double force = -40, std::int32_t law = SUNDER_LAW_LINEAR) {
  sunder_scene scene = nullptr;
  EXPECT_OK(sunder_scene_create(&scene));
  const Arrays a = board_arrays(cells);
  EXPECT_OK(sunder_scene_set_mesh(scene, a.nodes.data(), a.nodes.size(), a.tets.data(),
                                  a.tets.size(), nullptr, 0));
  sunder_material tissue;
  sunder_material_init(&tissue);
  tissue.young = 5;
  tissue.poisson = 0.4;
  tissue.yield = 2;
  tissue.law = law;
  tissue.name = "tissue";
  EXPECT_OK(sunder_scene_add_material(scene, &tissue, nullptr));
  const sunder_support support = top_support();
  EXPECT_OK(sunder_scene_add_support(scene, &support));
  sunder_instrument pull = corner_pull(force);
  pull.name = "forceps";
  pull.has_ramp = 1;
  pull.ramp[1] = 1;
  EXPECT_OK(sunder_scene_add_instrument(scene, &pull, nullptr));
  const auto fracture = model(SUNDER_FRACTURE_B);
  EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
  const auto solver = on(backend);
  EXPECT_OK(sunder_scene_set_solver(scene, &solver));
  EXPECT_OK(sunder_scene_set_steps(scene, 4));
  return scene;
}

inline sunder_simulation board_simulation(sunder_backend backend = SUNDER_BACKEND_CPU) {
  const sunder_scene scene = board_scene(backend);
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  return simulation;
}

/// All that is said of a simulation so far, a line each.
inline std::string warnings_of(sunder_simulation simulation) {
  std::int32_t count = 0;
  EXPECT_OK(sunder_simulation_warning_count(simulation, &count));
  std::string all;
  for (std::int32_t i = 0; i < count; ++i) {
    char text[1024];
    std::size_t length = 0;
    EXPECT_OK(sunder_simulation_warning_at(simulation, i, text, sizeof text, &length));
    all += std::string(text) + "\n";
  }
  return all;
}

}  // namespace sunder::test
