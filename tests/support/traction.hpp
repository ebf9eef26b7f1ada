// SPDX-License-Identifier: Apache-2.0
// Nodal forces of a uniform traction: a third of each free face's force at each corner.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder::test {

/// Forces (3 * nodes) of `traction` [MPa] on the free faces whose corners all satisfy `on`.
inline std::vector<double> traction_force(const Mesh& mesh,
                                          const std::function<bool(const Vec3&)>& on,
                                          const std::function<Vec3(const Vec3&)>& traction) {
  std::vector<double> force(3 * mesh.nodes.size(), 0.0);
  for (const FreeFace& face : free_faces(mesh)) {
    const Vec3 &a = mesh.nodes[face.nodes[0]], &b = mesh.nodes[face.nodes[1]],
               &c = mesh.nodes[face.nodes[2]];
    if (!on(a) || !on(b) || !on(c)) continue;
    const Vec3 twice_area = (b - a).cross(c - a);  // outward
    const Vec3 share = traction(twice_area.normalized()) * twice_area.norm() / 6;
    for (Index n : face.nodes) {
      for (int axis = 0; axis < 3; ++axis) force[3 * n + axis] += share[axis];
    }
  }
  return force;
}

}  // namespace sunder::test
