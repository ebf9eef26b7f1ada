// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/free_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sunder::fracture {

FreeSurface::FreeSurface(const Board& board) : begin_(board.mesh().tets.size() + 1, 0) {
  const Mesh& mesh = board.mesh();
  for (const FreeFace& face : free_faces(mesh)) {  // ordered by element
    const auto& [a, b, c] = face.nodes;
    const auto& x = mesh.nodes;
    const Vec3 area = (x[b] - x[a]).cross(x[c] - x[a]) / 2;
    const double slope = std::abs(area.dot(board.plane().e3)) / area.norm();
    faces_.push_back({face.nodes, area, slope < kLateralNormal, kNone});
    ++begin_[face.tet + 1];
  }
  for (std::size_t e = 1; e < begin_.size(); ++e) begin_[e] += begin_[e - 1];
}

bool FreeSurface::touches(Index element, Part part) const {
  const auto faces = of(element);
  return std::any_of(faces.begin(), faces.end(),
                     [&](const Face& face) { return face.lateral || part == Part::all; });
}

}  // namespace sunder::fracture
