// SPDX-License-Identifier: Apache-2.0
#include "app/figure/visible.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace sunder::app {
namespace {

bool inside_out(const Mesh& mesh, const Pose& pose, Index tet) {
  const auto& nodes = mesh.tets[tet];
  const Vec3& origin = pose.position[nodes[0]];
  const Vec3 a = pose.position[nodes[1]] - origin, b = pose.position[nodes[2]] - origin,
             c = pose.position[nodes[3]] - origin;
  return a.cross(b).dot(c) < 0;
}

/// A contour belongs to one visible face of a lip alone.
void outline_lips(std::vector<VisibleFace>& visible) {
  std::vector<Edge> of_lips;
  for (VisibleFace& v : visible) {
    v.outlined = v.face.rim;
    for (int i = 0; v.face.lip && i < 3; ++i) of_lips.push_back(edge(v.face, i));
  }
  std::sort(of_lips.begin(), of_lips.end());
  for (VisibleFace& v : visible)
    for (int i = 0; v.face.lip && i < 3; ++i) {
      const auto [first, last] = std::equal_range(of_lips.begin(), of_lips.end(), edge(v.face, i));
      if (last - first == 1) v.outlined[i] = true;
    }
}

}  // namespace

double turn(const std::array<Vec2, 3>& corners) {
  const Vec2 a = corners[1] - corners[0], b = corners[2] - corners[0];
  return a.x() * b.y() - a.y() * b.x();
}

std::vector<VisibleFace> visible_faces(const Mesh& mesh, const BoardPlane& plane, const Pose& pose,
                                       const std::vector<BodyFace>& faces) {
  const Vec3 eye = plane.e1.cross(plane.e2);  // towards the viewer: e1 points right, e2 up
  std::vector<VisibleFace> visible;
  for (const BodyFace& face : faces) {
    VisibleFace v{{}, 0, face};
    for (int i = 0; i < 3; ++i) {
      const Vec3& x = pose.position[face.nodes[i]];
      v.corners[i] = plane.project(x);
      v.depth += x.dot(eye) / 3;
    }
    const double facing = turn(v.corners);
    if (facing > 0 || (facing < 0 && inside_out(mesh, pose, face.tet))) visible.push_back(v);
  }
  outline_lips(visible);
  std::stable_sort(visible.begin(), visible.end(),
                   [](const VisibleFace& a, const VisibleFace& b) { return a.depth < b.depth; });
  return visible;
}

}  // namespace sunder::app
