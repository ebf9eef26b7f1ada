// SPDX-License-Identifier: Apache-2.0
// A few elements of one tissue, held on a side, for tests whose device makes solutions up.
#pragma once

#include "sunder/scene.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

inline Scene small_tissue() {
  Scene scene;
  scene.mesh =
      structured_board({2, 2, 1, 2, 2, 1}, [](const Vec3&) { return std::string("tissue"); });
  scene.materials["tissue"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 1.99, -1), Vec3(3, 3, 2)}, Axes{7}});
  return scene;
}

}  // namespace sunder::test
