// SPDX-License-Identifier: Apache-2.0
#include "sunder/board_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sunder/error.hpp"

namespace sunder {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3 bounding_box_extent(const Mesh& mesh) {
  Vec3 lo = Vec3::Constant(kInfinity), hi = Vec3::Constant(-kInfinity);
  const std::vector<std::uint8_t> used = used_nodes(mesh);
  for (std::size_t n = 0; n < used.size(); ++n) {
    if (!used[n]) continue;
    lo = lo.cwiseMin(mesh.nodes[n]);
    hi = hi.cwiseMax(mesh.nodes[n]);
  }
  return hi - lo;
}

/// Coordinate axes by falling extent; ties keep x before y before z.
std::array<int, 3> axes_by_extent(const Vec3& extent) {
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return extent[a] > extent[b]; });
  return axes;
}

void set_axes_from_box(BoardPlane& plane, const std::array<int, 3>& axes) {
  plane.e1 = Vec3::Unit(axes[0]);
  plane.e2 = Vec3::Unit(axes[1]);
  plane.e3 = Vec3::Unit(axes[2]);
}

/// e3 is the given normal. Of the coordinate axes, the one closest to it drops out; the longer of
/// the other two gives e1 by projection, the shorter the sense of e2.
void set_axes_from_normal(BoardPlane& plane, const std::array<int, 3>& axes, const Vec3& normal) {
  if (!normal.allFinite() || !(normal.norm() > 0))
    throw InputError(InputFault::out_of_range,
                     "fracture.plane_normal must be a finite vector that is not zero");
  plane.e3 = normal.normalized();
  int dropped = axes[2];
  for (int axis : {axes[1], axes[0]})
    if (std::abs(plane.e3[axis]) > std::abs(plane.e3[dropped])) dropped = axis;
  std::array<int, 2> kept{};
  std::copy_if(axes.begin(), axes.end(), kept.begin(), [&](int axis) { return axis != dropped; });
  const Vec3 first = Vec3::Unit(kept[0]), second = Vec3::Unit(kept[1]);
  plane.e1 = (first - first.dot(plane.e3) * plane.e3).normalized();
  plane.e2 =
      (second - second.dot(plane.e3) * plane.e3 - second.dot(plane.e1) * plane.e1).normalized();
}

void measure_outline(BoardPlane& plane, const Mesh& mesh) {
  plane.outline_min = Vec2::Constant(kInfinity);
  plane.outline_max = Vec2::Constant(-kInfinity);
  plane.bottom = kInfinity;
  plane.top = -kInfinity;
  const std::vector<std::uint8_t> used = used_nodes(mesh);
  for (std::size_t n = 0; n < used.size(); ++n) {
    if (!used[n]) continue;
    const Vec3& x = mesh.nodes[n];
    const Vec2 p = plane.project(x);
    plane.outline_min = plane.outline_min.cwiseMin(p);
    plane.outline_max = plane.outline_max.cwiseMax(p);
    plane.bottom = std::min(plane.bottom, x.dot(plane.e3));
    plane.top = std::max(plane.top, x.dot(plane.e3));
  }
}

/// h: mean over all elements and their six edges, each element counting its own.
double mean_projected_edge(const BoardPlane& plane, const Mesh& mesh) {
  static constexpr std::array<std::pair<int, int>, 6> kEdges{
      {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  double sum = 0;
  for (const auto& tet : mesh.tets)
    for (auto [a, b] : kEdges) sum += plane.project(mesh.nodes[tet[a]] - mesh.nodes[tet[b]]).norm();
  return sum / (6.0 * static_cast<double>(mesh.tets.size()));
}

}  // namespace

double BoardPlane::inside(const Vec2& p) const {
  return std::min((p - outline_min).minCoeff(), (outline_max - p).minCoeff());
}

double BoardPlane::chord(const Vec2& p, const Vec2& d) const {
  double enter = -kInfinity, leave = kInfinity;  // along d, from p
  for (int axis = 0; axis < 2; ++axis) {
    if (d[axis] == 0) {
      if (p[axis] < outline_min[axis] || p[axis] > outline_max[axis]) return 0;
      continue;
    }
    const double t0 = (outline_min[axis] - p[axis]) / d[axis];
    const double t1 = (outline_max[axis] - p[axis]) / d[axis];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return leave > enter ? leave - enter : 0;
}

BoardPlane board_plane(const Mesh& mesh, const std::optional<Vec3>& normal) {
  BoardPlane plane;
  const std::array<int, 3> axes = axes_by_extent(bounding_box_extent(mesh));
  if (normal)
    set_axes_from_normal(plane, axes, *normal);
  else
    set_axes_from_box(plane, axes);
  measure_outline(plane, mesh);
  plane.edge_length = mean_projected_edge(plane, mesh);
  return plane;
}

}  // namespace sunder
