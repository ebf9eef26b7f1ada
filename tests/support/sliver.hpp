// SPDX-License-Identifier: Apache-2.0
// An element pressed flat in a mesh that is otherwise as it was.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "support/sequences.hpp"

namespace sunder::test {

inline double signed_volume(const Mesh& mesh, Index e) {
  const auto& t = mesh.tets[e];
  const Vec3 a = mesh.nodes[t[0]];
  return (mesh.nodes[t[1]] - a).cross(mesh.nodes[t[2]] - a).dot(mesh.nodes[t[3]] - a) / 6;
}

inline bool positive_around(const Mesh& mesh, Index node) {
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    const auto& t = mesh.tets[e];
    if (std::find(t.begin(), t.end(), node) != t.end() && signed_volume(mesh, e) <= 0) return false;
  }
  return true;
}

/// Moves one corner of an element within `reach` of a place (in x and y) towards the opposite face
/// until the height is `quality` times the longest edge; its neighbours keep a positive volume.
inline void make_sliver(Mesh& mesh, const Vec3& place, double reach, double quality) {
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    const Vec3 c = centroid(mesh, e) - place;
    if (std::abs(c.y()) > reach || std::abs(c.x()) > reach) continue;
    for (int corner = 0; corner < 4; ++corner) {
      const auto& t = mesh.tets[e];
      const Index node = t[corner];
      const Vec3 a = mesh.nodes[t[(corner + 1) % 4]], b = mesh.nodes[t[(corner + 2) % 4]],
                 d = mesh.nodes[t[(corner + 3) % 4]], from = mesh.nodes[node];
      const Vec3 normal = (b - a).cross(d - a).normalized();
      const double longest = std::max({(b - a).norm(), (d - a).norm(), (d - b).norm()});
      const double height = normal.dot(from - a);
      mesh.nodes[node] = from - (height - std::copysign(quality * longest, height)) * normal;
      if (positive_around(mesh, node)) return;
      mesh.nodes[node] = from;
    }
  }
  throw std::invalid_argument("no vertex of the mesh gives such a sliver");
}

}  // namespace sunder::test
