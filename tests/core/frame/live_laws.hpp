// SPDX-License-Identifier: Apache-2.0
// The strip that a host takes hold of, by the laws of finite deformation and in motion.
#pragma once

#include "core/frame/live_world.hpp"

namespace sunder::test {

struct LawWay {
  const char* name;
  MaterialLaw law;
  Route route;
  bool moves;
  bool fibres = false;
};
inline void PrintTo(const LawWay& way, std::ostream* out) { *out << way.name; }

inline const std::vector<LawWay> kLaws{
    {"corotated", MaterialLaw::corotated, Route::factor, false},
    {"neo_hookean_by_inverse", MaterialLaw::neo_hookean, Route::inverse, false},
    {"saint_venant_kirchhoff", MaterialLaw::saint_venant_kirchhoff, Route::factor, false},
    {"motion_linear", MaterialLaw::linear, Route::factor, true},
    {"motion_corotated", MaterialLaw::corotated, Route::factor, true},
    {"motion_by_inverse", MaterialLaw::neo_hookean, Route::inverse, true},
    {"fibres", MaterialLaw::neo_hookean, Route::factor, false, true},
    {"fibres_linear", MaterialLaw::linear, Route::factor, false, true},
};

inline Scene law_strip(const LawWay& way, double force = 0.3) {
  Scene scene = live_strip({way.name, way.route});
  scene.instruments[0].action = Pull{band(-1, 0.1), Vec3(0, -force, 0)};
  scene.materials["board"].law = way.law;
  scene.materials["board"].density = 1e-9;
  if (way.fibres) scene.materials["board"].fibres = {slanted_fibres(way.law)};
  scene.solver.tolerance = 1e-7;
  if (way.moves) scene.dynamics = Dynamics{.time_step = 2e-4, .mass_damping = 500};
  return scene;
}

/// So many steps, and in statics on until it is at rest.
inline void settle(Simulation& s, int steps = 1) {
  for (int i = 0; i < steps; ++i) s.step();
  for (int i = 0; i < 200 && s.step().unfinished; ++i) {
  }
}

}  // namespace sunder::test
