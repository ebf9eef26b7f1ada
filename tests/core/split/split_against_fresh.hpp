// SPDX-License-Identifier: Apache-2.0
// A split board on a route of the CPU, against the yardstick on the split mesh.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "split_bodies.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {

struct SplitCase {
  Route route;
  bool grip;  // the lower side is held and moved, else pulled
  double poisson;
  bool notch;  // elements are destroyed where the crack begins
};

inline const Vec3 kBy(0.1, -0.3, 0.05);  // of the pull [N] or the grip [mm]

inline Scene scene_of(const SplitCase& c, Mesh mesh) {
  Scene scene = board_scene(std::move(mesh), FractureModel::b);
  scene.materials["board"] = {5.0, c.poisson, 1.0};
  scene.fracture.alpha = 1e-12;  // what ties lips is beyond the digits that are compared
  scene.fracture.crack = CrackWay::split;
  scene.solver.route = c.route;
  const Box lower{Vec3(-1, -1e-9, -1e9), Vec3(1e9, 1e-9, 1e9)};
  Instrument pull{"pull", Pull{lower, kBy}, {}};
  if (c.grip) pull.action = Grip{lower, kBy, Axes{7}};
  scene.instruments = {pull};
  return scene;
}

inline std::vector<double> grips_of(const Problem& problem) {
  std::vector<double> grips;
  for (Index d : problem.gripped_dofs()) {
    const auto at = std::ranges::find(problem.dofs(), d) - problem.dofs().begin();
    grips.push_back(kBy[static_cast<int>(at % 3)]);
  }
  return grips;
}

/// Forces act on nodes of the mesh, whatever has parted from them.
inline void expect_as_fresh(const EdgeSplit& crack, const SplitCase& c, const Backend& backend,
                            std::vector<double> force) {
  const Problem fresh(scene_of(c, crack.mesh()));
  force.resize(3 * fresh.mesh().nodes.size(), 0.0);
  const auto expected = yardstick(fresh, crack.destroyed, force, grips_of(fresh));
  std::vector<Index> nodes(fresh.mesh().nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  std::vector<Vec3> at(nodes.size());
  backend.read_displacement(nodes, at);
  std::vector<double> u;
  for (const Vec3& x : at) u.insert(u.end(), x.begin(), x.end());
  EXPECT_LE(displacement_error(fresh.mesh(), crack.destroyed, u, expected.displacement),
            kCrackTolerance);
  std::vector<Voigt> stress(fresh.mesh().tets.size());
  backend.read_stress(stress);
  EXPECT_LE(stress_error(crack.destroyed, stress, expected.stress), kCrackTolerance);
}

}  // namespace sunder::test
