// SPDX-License-Identifier: Apache-2.0
// The paper's board (Table 1) on the 1954-element mesh: fixed top edge, pulled at the lower right.
#pragma once

#include <string>
#include <vector>

#include "sunder/scene.hpp"
#include "support/msh_reader.hpp"

namespace sunder::test {

/// Table 1; the frames are unbreakable.
inline std::map<std::string, Material> table1_materials() {
  return {{"upper", {5, 0.4, 2.0}},
          {"lower", {8, 0.4, 4.0}},
          {"top-frame", {500, 0.4, std::nullopt}},
          {"bottom-frame", {500, 0.4, std::nullopt}}};
}

/// Nodes of the edge x = 50, y = 0.
inline Box lower_right_corner() { return {Vec3(49.999, -0.001, -1), Vec3(50.001, 0.001, 3)}; }
inline Box top_edge() { return {Vec3(-1, 49.999, -1), Vec3(51, 50.001, 3)}; }

/// No instruments yet: see pulled_board.
inline Scene held_board() {
  Scene scene;
  scene.title = "board of Table 1";
  scene.mesh = read_msh22(SUNDER_SCENES "/meshes/board1954.msh");
  scene.materials = table1_materials();
  scene.supports.push_back({top_edge(), Axes{7}});
  scene.solver.backend = "cpu";
  return scene;
}

inline void set_poisson(Scene& scene, double poisson) {
  for (auto& [name, material] : scene.materials) material.poisson = poisson;
}

/// Frames `contrast` times as stiff as the upper half; Table 1 has 100.
inline void set_contrast(Scene& scene, double contrast) {
  for (auto& [name, material] : scene.materials) {
    if (!material.yield) material.young = 5 * contrast;
  }
}

inline Scene pulled_board(const Vec3& force = Vec3(0, -60, 0)) {
  Scene scene = held_board();
  Instrument forceps;
  forceps.name = "right forceps";
  forceps.action = Pull{lower_right_corner(), force};
  scene.instruments.push_back(forceps);
  return scene;
}

}  // namespace sunder::test
