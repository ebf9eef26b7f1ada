// SPDX-License-Identifier: Apache-2.0
#include "app/output/split_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace sunder::app {
namespace {

constexpr double kOnOutline = 1e-6;  // of h
// Paths that run more nearly along the outline leave its nodes where they are.
constexpr double kSteepest = 0.1;

struct Foot {
  Vec2 point, along;  // `along`: unit, of the path there
};

Foot foot_on_path(std::span<const Vec2> path, const Vec2& p) {
  Foot best{p, Vec2::Zero()};
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec2 piece = path[i] - path[i - 1];
    if (!(piece.squaredNorm() > 0)) continue;
    double share = (p - path[i - 1]).dot(piece) / piece.squaredNorm();
    if (i > 1) share = std::max(share, 0.0);
    if (i + 1 < path.size()) share = std::min(share, 1.0);
    const Vec2 point = path[i - 1] + share * piece;
    const double distance = (p - point).norm();
    if (!(distance < nearest)) continue;
    nearest = distance;
    best = {point, piece.normalized()};
  }
  return best;
}

/// Where the path crosses the side of the outline that p lies on; nothing: p lies on none.
std::optional<Vec2> slid_along_outline(const Foot& foot, const Vec2& p, const BoardPlane& plane) {
  bool on_side = false;
  Vec2 to = foot.point;
  for (int axis = 0; axis < 2; ++axis) {
    const double near = kOnOutline * plane.edge_length;
    if (std::abs(p[axis] - plane.outline_min[axis]) > near &&
        std::abs(p[axis] - plane.outline_max[axis]) > near) {
      continue;
    }
    if (on_side || std::abs(foot.along[axis]) < kSteepest) return p;  // a corner, or no crossing
    on_side = true;
    to += foot.along * (p[axis] - to[axis]) / foot.along[axis];
  }
  if (!on_side) return std::nullopt;
  return to;
}

Vec2 drawn_at(std::span<const Vec2> path, const Vec2& p, const BoardPlane& plane) {
  const Foot foot = foot_on_path(path, p);
  const Vec2 to = slid_along_outline(foot, p, plane).value_or(foot.point);
  // A crack lies within an element of its path: what is farther has no place on it.
  return (to - p).norm() > 2 * plane.edge_length ? p : to;
}

}  // namespace

Vec2 closest_on_path(std::span<const Vec2> path, const Vec2& p) {
  return foot_on_path(path, p).point;
}

std::vector<Vec3> on_ideal_paths(const Mesh& mesh, std::span<const CrackFace> faces,
                                 std::span<const Crack> cracks, const BoardPlane& plane) {
  std::vector<Vec3> drawn = mesh.nodes;
  std::vector<std::uint8_t> moved(drawn.size(), 0);
  for (const CrackFace& face : faces) {
    const auto& path = cracks[static_cast<std::size_t>(face.crack)].path;
    for (const auto& lip : {face.left, face.right}) {
      for (const Index n : lip) {
        const auto node = static_cast<std::size_t>(n);
        if (std::exchange(moved[node], std::uint8_t{1})) continue;
        const Vec2 p = plane.project(mesh.nodes[node]);
        drawn[node] += plane.lift_direction(drawn_at({path.data(), path.size()}, p, plane) - p);
      }
    }
  }
  return drawn;
}

std::vector<double> face_areas(std::span<const Vec3> drawn, std::span<const CrackFace> faces,
                               std::span<const Crack> cracks, const BoardPlane& plane) {
  std::vector<double> areas;
  for (const CrackFace& face : faces) {
    const auto at = [&](std::size_t i) -> const Vec3& {
      return drawn[static_cast<std::size_t>(face.left[i])];
    };
    const Vec3 area = (at(1) - at(0)).cross(at(2) - at(0)) / 2;
    const auto& path = cracks[static_cast<std::size_t>(face.crack)].path;
    const Vec2 middle = plane.project((at(0) + at(1) + at(2)) / 3);
    const Vec2 along = foot_on_path({path.data(), path.size()}, middle).along;
    // The left lip's nodes turn so that its normal leaves its tissue, to the right.
    const double to_right = area.dot(plane.lift_direction({along.y(), -along.x()}));
    areas.push_back(std::copysign(area.norm(), to_right));
  }
  return areas;
}

std::vector<double> openings(const SplitMesh& split, std::span<const Vec3> displacement) {
  std::vector<double> opening(split.mesh.nodes.size(), 0.0);
  for (const CrackFace& face : split.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = static_cast<std::size_t>(face.left[i]);
      const auto b = static_cast<std::size_t>(face.right[i]);
      const double jump = (displacement[a] - displacement[b]).norm();
      opening[a] = std::max(opening[a], jump);
      opening[b] = std::max(opening[b], jump);
    }
  }
  return opening;
}

double crack_area(const SplitMesh& split, int crack) {
  double sum = 0;
  for (std::size_t f = 0; f < split.faces.size(); ++f) {
    if (crack == kNone || split.faces[f].crack == crack) sum += split.area[f];
  }
  return sum;
}

std::shared_ptr<const SplitMesh> split_mesh(const Simulation& simulation) {
  std::vector<CrackFace> faces = simulation.crack_faces();
  if (faces.empty()) return nullptr;
  const Mesh& file = simulation.problem().mesh();
  auto split = std::make_shared<SplitMesh>();
  split->mesh = simulation.mesh();
  split->faces = std::move(faces);
  split->in_file.resize(split->mesh.nodes.size());
  for (Index n = 0; n < file.node_count(); ++n) split->in_file[static_cast<std::size_t>(n)] = n;
  for (std::size_t e = 0; e < file.tets.size(); ++e) {
    for (std::size_t a = 0; a < 4; ++a) {
      split->in_file[static_cast<std::size_t>(split->mesh.tets[e][a])] = file.tets[e][a];
    }
  }
  const BoardPlane plane = board_plane(file, simulation.problem().scene().fracture.plane_normal);
  split->drawn = on_ideal_paths(split->mesh, split->faces, simulation.cracks(), plane);
  split->area = face_areas(split->drawn, split->faces, simulation.cracks(), plane);
  return split;
}

}  // namespace sunder::app
