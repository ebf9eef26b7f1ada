// SPDX-License-Identifier: Apache-2.0
// A board that tears between held ends, whole frames on the reference.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

struct Torn {
  std::vector<DestroyedElement> rows;
  std::vector<Crack> cracks;
};

/// 20 x 21 x 1 mm with a preset edge notch of 6 cells at mid-height, held below, its upper end
/// moved by a grip in 20 steps.
struct HeldStrip {
  double young = 5, poisson = 0.3, height = 21;

  /// K between held ends moved apart by u, whatever the crack's length (Rice 1967): far ahead
  /// e_xx = 0 and s_yy = E/(1 - nu^2) u/H, far behind nothing; K = sqrt(E G).
  [[nodiscard]] double rice(double u) const {
    return young * u / height * std::sqrt(height / 2 / (1 - poisson * poisson));
  }

  [[nodiscard]] Scene scene(SifSource sif, const Vec3& displacement) const {
    const BoardShape shape{20, 21, 1, 20, height, 1};
    Scene scene;
    scene.mesh = structured_board(shape);
    scene.materials["board"] = {young, poisson, 2.0};
    Support support;
    support.nodes = Box{{-1, -0.1, -1}, {21, 0.1, 2}};
    scene.supports.push_back(support);
    Instrument grip;
    grip.name = "grip";
    grip.action = Grip{Box{{-1, 20.9, -1}, {21, 21.1, 2}}, displacement, Axes{7}};
    grip.ramp = Ramp{0, 1};
    scene.instruments.push_back(grip);
    PresetCrack notch;
    notch.elements = Box{{-1, 10, -1}, {6, 11, 2}};
    notch.mouth = Vec3(0, 10.5, 0.5);
    notch.tips = {Vec3(6, 10.5, 0.5)};
    scene.cracks.push_back(notch);
    scene.fracture.model = FractureModel::b;
    scene.fracture.sif = sif;
    scene.solver.backend = "cpu";
    scene.steps = 20;
    return scene;
  }

  [[nodiscard]] Torn tear(SifSource sif, const Vec3& displacement) const {
    auto problem = std::make_shared<const Problem>(scene(sif, displacement));
    Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
    while (!simulation.done() && simulation.destroyed().size() < 200) simulation.step();
    return {simulation.destroyed(), simulation.cracks()};
  }
};

}  // namespace sunder::test
