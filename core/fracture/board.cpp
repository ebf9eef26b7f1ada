// SPDX-License-Identifier: Apache-2.0
#include "fracture/board.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sunder::fracture {
namespace {

std::vector<Vec2> projected_centroids(const Mesh& mesh, const BoardPlane& plane) {
  std::vector<Vec2> centroids;
  centroids.reserve(mesh.tets.size());
  for (const auto& [a, b, c, d] : mesh.tets) {
    const auto& x = mesh.nodes;
    centroids.push_back(plane.project((x[a] + x[b] + x[c] + x[d]) / 4));
  }
  return centroids;
}

}  // namespace

Board::Board(const Mesh& mesh, const std::optional<Vec3>& plane_normal)
    : mesh_(mesh),
      plane_(board_plane(mesh, plane_normal)),
      around_(mesh),
      centroids_(projected_centroids(mesh, plane_), plane_.edge_length),
      surface_(mesh.nodes.size(), 0) {
  for (Index e = 0; e < mesh.tet_count(); ++e)
    for (Index n : mesh.tets[e])
      largest_element_ = std::max(largest_element_, (node(n) - centroid(e)).norm());
  sort_free_faces();
}

double Board::edge_length(Index e) const {
  const auto& tet = mesh_.tets[e];
  double sum = 0;
  for (int a = 0; a < 4; ++a)
    for (int b = a + 1; b < 4; ++b) sum += (node(tet[a]) - node(tet[b])).norm();
  return sum / 6;
}

void Board::sort_free_faces() {
  for (const FreeFace& face : free_faces(mesh_)) {
    const auto& [a, b, c] = face.nodes;
    const auto& x = mesh_.nodes;
    const double slope = (x[b] - x[a]).cross(x[c] - x[a]).normalized().dot(plane_.e3);
    if (std::abs(slope) < kLateralNormal) {
      lateral_.push_back({face.tet, plane_.project((x[a] + x[b] + x[c]) / 3)});
      continue;
    }
    for (Index n : face.nodes) surface_[n] |= slope < 0 ? kBottom : kTop;
  }
}

std::span<const Board::LateralFace> Board::lateral_faces(Index e) const {
  const auto first =
      std::lower_bound(lateral_.begin(), lateral_.end(), e,
                       [](const LateralFace& face, Index tet) { return face.tet < tet; });
  const auto last =
      std::find_if(first, lateral_.end(), [e](const LateralFace& face) { return face.tet != e; });
  return {first, last};
}

}  // namespace sunder::fracture
