// SPDX-License-Identifier: Apache-2.0
// A board of which a strip can tear: the scene of route condensed.
#pragma once

#include <optional>

#include "support/loads.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

/// 50 x 50 x 2.5 mm, 1680 elements; three rows of cells around y = 26 can tear, 360 of 1800
/// unknowns.
inline Scene organ(double contrast = 1, double poisson = 0.4) {
  Scene scene;
  scene.mesh = structured_board({14, 20, 1, 50, 50, 2.5}, [](const Vec3& x) {
    return x.y() > 22.5 && x.y() < 30 ? "tissue" : "organ";
  });
  scene.materials = {{"tissue", {5, poisson, 2.0}},
                     {"organ", {5 * contrast, poisson, std::nullopt}}};
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
  return scene;
}

inline void add_pull(Scene& scene, double force = -60) {
  Instrument forceps;
  forceps.name = "forceps";
  forceps.action = Pull{lower_right_corner(), Vec3(0, force, 0)};
  scene.instruments.push_back(forceps);
}

}  // namespace sunder::test
