// SPDX-License-Identifier: Apache-2.0
// Bodies with interfaces: blocks that lie on each other, and a strip on a bed.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sunder/interfaces.hpp"
#include "sunder/problem.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

inline constexpr double kStrength = 0.1, kEnergy = 0.01;  // [MPa], [N/mm]

inline Material tissue(double young = 100, MaterialLaw law = MaterialLaw::neo_hookean) {
  Material m;
  m.young = young;
  m.poisson = 0.3;
  m.law = law;
  m.density = 1e-9;
  return m;
}

inline Box slab(int axis, double from, double to) {
  Box box{Vec3::Constant(-99), Vec3::Constant(99)};
  box.min[axis] = from;
  box.max[axis] = to;
  return box;
}

/// A body of cells whose volumes `volume_at` names; every volume is the same tissue.
inline Scene body_of(const BoardShape& shape,
                     const std::function<std::string(const Vec3&)>& volume_at,
                     const Material& material = tissue()) {
  Scene scene;
  scene.mesh = structured_board(shape, volume_at);
  for (const NamedVolume& v : scene.mesh.volumes) scene.materials[v.name] = material;
  return scene;
}

/// Two blocks of 2 x 2 x 1 mm, the upper one on the lower, bonded.
inline Scene blocks(const Material& material = tissue(), double shear_ratio = 1) {
  Scene scene = body_of(
      {2, 2, 2, 2, 2, 2}, [](const Vec3& x) { return x.z() < 1 ? "low" : "high"; }, material);
  scene.interfaces.push_back({{"low", "high"}, kStrength, kEnergy, shear_ratio});
  scene.supports.push_back({slab(2, -1, 1e-6), Axes{}});
  scene.fracture.model = FractureModel::a;
  scene.solver.backend = "cpu";
  return scene;
}

/// Moves the top of blocks() by so much at the end [mm].
inline void move_top(Scene& scene, const Vec3& by, int steps) {
  scene.instruments.push_back({"top", Grip{slab(2, 1.99, 3), by, Axes{}}, Ramp{0, 1}});
  scene.steps = steps;
}

}  // namespace sunder::test
