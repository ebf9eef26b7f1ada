// SPDX-License-Identifier: Apache-2.0
// Cubes with fibres that are held and pulled.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "sunder/problem.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

inline constexpr double kMu = 0.03, kK1 = 0.02, kK2 = 1.5;  // [MPa]
inline constexpr double kNearlyOne = 0.4999;                // twice Poisson's ratio

/// A cube of 4 mm whose matrix is neo-Hookean.
inline Scene cube(MaterialLaw law = MaterialLaw::neo_hookean) {
  Scene scene;
  scene.mesh = structured_board({2, 2, 2, 4, 4, 4});
  Material m;
  m.young = 2 * kMu * (1 + kNearlyOne);
  m.poisson = kNearlyOne;
  m.law = law;
  scene.materials["board"] = m;
  scene.solver.tolerance = 1e-6;
  return scene;
}

/// In the plane of x and y, at this angle to x [deg].
inline Fibres at_angle(double degrees, double dispersion = 0) {
  Fibres f;
  const double angle = degrees * std::numbers::pi / 180;
  f.direction = Vec3(3 * std::cos(angle), 3 * std::sin(angle), 0);
  f.k1 = kK1;
  f.k2 = kK2;
  f.dispersion = dispersion;
  return f;
}

inline Box face(int axis, double at) {
  Box box{Vec3::Constant(-1), Vec3::Constant(9)};
  box.min[axis] = at - 1e-6;
  box.max[axis] = at + 1e-6;
  return box;
}

inline Axes only(int axis) { return Axes{static_cast<std::uint8_t>(1 << axis)}; }

inline void pull(Scene& scene, int axis, double stretch) {
  Instrument tool;
  tool.name = std::string(1, static_cast<char>('x' + axis));
  tool.action = Grip{face(axis, 4), 4 * (stretch - 1) * Vec3::Unit(axis), only(axis)};
  scene.instruments.push_back(tool);
}

/// Ends that slide in their planes.
inline void hold(Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) scene.supports.push_back({face(axis, 0), only(axis)});
}

/// Of law linear, its fibres along x.
inline Scene linear_cube() {
  Scene scene = cube(MaterialLaw::linear);
  Material& m = scene.materials["board"];
  m.young = 2;
  m.poisson = 0.35;
  Fibres f;
  f.direction = Vec3(5, 0, 0);
  f.young_along = 20;
  f.poisson_along = 0.28;
  f.shear_along = 3;
  m.fibres.push_back(f);
  hold(scene);
  return scene;
}

}  // namespace sunder::test
