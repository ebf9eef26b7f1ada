// SPDX-License-Identifier: Apache-2.0
// A strip that is pulled, and whole runs of it on the reference.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

inline Box band(double low, double high) { return {Vec3(-1, low, -1), Vec3(99, high, 9)}; }

/// 4 x 8 x 1 cells, fixed at y = 8, pulled down at y = 0; 192 elements.
inline Scene strip(double yield, double force, int steps) {
  Scene scene;
  scene.mesh = structured_board({4, 8, 1, 4, 8, 1});
  scene.materials["board"] = {5, 0.3, yield};
  scene.supports.push_back({band(7.9, 9), Axes{7}});
  Instrument forceps;
  forceps.name = "forceps";
  forceps.action = Pull{band(-1, 0.1), Vec3(0, -force, 0)};
  forceps.ramp = Ramp{0, 1};
  scene.instruments.push_back(forceps);
  scene.steps = steps;
  scene.fracture.model = FractureModel::a;
  return scene;
}

/// Of a matrix of 5 MPa, at a slope to the strip's axes.
inline Fibres slanted_fibres(MaterialLaw law) {
  Fibres f;
  f.direction = Vec3(1, 2, 0.3);
  if (law == MaterialLaw::linear) {
    f.young_along = 15;
    f.poisson_along = 0.3;
    f.shear_along = 4;
  } else {
    f.k1 = 1;
    f.k2 = 0.5;
  }
  return f;
}

struct SceneRun {
  explicit SceneRun(Scene scene)
      : problem(std::make_shared<Problem>(std::move(scene))),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {}

  std::vector<StepReport> all() {
    std::vector<StepReport> reports;
    while (!simulation.done()) reports.push_back(simulation.step());
    return reports;
  }

  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

inline bool mentions(const std::vector<std::string>& warnings, const std::string& part) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

inline Scene notched(FractureModel model) {
  Scene scene = strip(0.9, 2, 2);
  scene.fracture.model = model;
  std::vector<Index> notch;
  for (Index e = 6 * (3 + 4 * 4); e < 6 * (4 + 4 * 4); ++e) notch.push_back(e);  // cell (3, 4)
  scene.cracks.push_back({notch, Vec3(4, 4.5, 0.5), {Vec3(3, 4.5, 0.5)}});
  return scene;
}

}  // namespace sunder::test
