// SPDX-License-Identifier: Apache-2.0
#include "body/board_check.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "sunder/board_plane.hpp"

namespace sunder {
namespace {

// Share of the shorter side up to which a thickness is small. The paper's board has 0.04; plates
// are called thin up to 0.1 to 0.2 (Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells,
// 1).
constexpr double kThin = 0.2;
// Mean over largest thickness of an even board, with room for the roughness of a mesh.
constexpr double kEven = 0.9;

std::string three(double value) {
  std::ostringstream out;
  out << std::setprecision(3) << value;
  return out.str();
}

/// Volume over the area of the projection: the faces of a flat body cover it twice.
double mean_thickness(const Mesh& mesh, const BoardPlane& plane) {
  const auto& x = mesh.nodes;
  double volume = 0, area = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    volume += (x[b] - x[a]).cross(x[c] - x[a]).dot(x[d] - x[a]) / 6;
  }
  for (const FreeFace& face : free_faces(mesh)) {
    const auto& [a, b, c] = face.nodes;
    area += std::abs((x[b] - x[a]).cross(x[c] - x[a]).dot(plane.e3)) / 4;
  }
  return volume / area;
}

}  // namespace

std::optional<std::string> why_no_board(const Mesh& mesh, const std::optional<Vec3>& plane_normal) {
  const BoardPlane plane = board_plane(mesh, plane_normal);
  const double side = (plane.outline_max - plane.outline_min).minCoeff();
  const double mean = mean_thickness(mesh, plane);
  if (!(plane.thickness() <= kThin * side)) {
    return "it is " + three(plane.thickness()) + " mm thick and " + three(side) +
           " mm wide, over a fifth";
  }
  if (!(mean >= kEven * plane.thickness())) {
    return "its thickness is uneven, " + three(mean) + " mm in the mean and " +
           three(plane.thickness()) + " mm from the lowest to the highest node";
  }
  return std::nullopt;
}

}  // namespace sunder
