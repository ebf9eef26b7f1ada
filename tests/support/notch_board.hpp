// SPDX-License-Identifier: Apache-2.0
// The board of Table 1 with a preset notch at its right edge, pulled at the lower right.
#pragma once

#include "support/table1_board.hpp"

namespace sunder::test {

inline Scene notch_board(FractureModel model) {
  Scene scene;
  scene.mesh = read_msh22(SUNDER_SCENES "/meshes/board1954_notch.msh");
  scene.materials = table1_materials();
  scene.materials["preset-crack"] = {5, 0.4, 2.0};
  scene.supports.push_back({top_edge(), Axes{7}});
  Instrument forceps;
  forceps.action = Pull{lower_right_corner(), Vec3(0, -60, 0)};
  forceps.ramp = Ramp{0, 1};
  scene.instruments.push_back(forceps);
  PresetCrack crack;
  crack.elements = VolumeName{"preset-crack"};
  crack.mouth = Vec3(50, 25, 1);
  crack.tips = {Vec3(45.96, 25, 1)};
  scene.cracks.push_back(crack);
  scene.fracture.model = model;
  scene.steps = 20;
  return scene;
}

}  // namespace sunder::test
