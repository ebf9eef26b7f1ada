// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/table1_board.hpp"

namespace sunder::test {

/// Table 1's board pulled until it tears, by model A, a few elements a step.
inline Scene pulled_until_it_tears() {
  Scene scene = pulled_board(Vec3(0, -130, 0));
  scene.instruments.front().ramp = Ramp{0, 1};
  scene.fracture.model = FractureModel::a;
  scene.fracture.max_events = 3;
  scene.steps = 3;
  return scene;
}

}  // namespace sunder::test
