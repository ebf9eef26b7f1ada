// SPDX-License-Identifier: Apache-2.0
#include "app/figure/inset.hpp"

#include <algorithm>

#include "app/figure/painting.hpp"
#include "app/figure/svg.hpp"
#include "app/figure/visible.hpp"

namespace sunder::app {
namespace {

constexpr Color kBlack{17, 17, 17};
constexpr double kMargin = 2, kLine = 1;  // px on the page
constexpr std::size_t kMostEdges = 6000;  // of an outline; a rectangle stands for more
constexpr double kEdgeOn = 1e-9;          // of h^2: rounding makes no face look at the viewer

std::array<Vec2, 3> projected(const Mesh& mesh, const BoardPlane& plane, const BodyFace& face) {
  return {plane.project(mesh.nodes[face.nodes[0]]), plane.project(mesh.nodes[face.nodes[1]]),
          plane.project(mesh.nodes[face.nodes[2]])};
}

bool looks_at_viewer(const BoardPlane& plane, const std::array<Vec2, 3>& corners) {
  return turn(corners) > kEdgeOn * plane.edge_length * plane.edge_length;
}

/// Edges that one face alone of those that look at the viewer has: what an outline drawing shows.
std::vector<Edge> outline_edges(const Mesh& mesh, const BoardPlane& plane,
                                const std::vector<BodyFace>& surface) {
  std::vector<Edge> edges;
  for (const BodyFace& face : surface) {
    if (!looks_at_viewer(plane, projected(mesh, plane, face))) continue;
    for (int i = 0; i < 3; ++i) edges.push_back(edge(face, i));
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> single;
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end == i + 1) single.push_back(edges[i]);
  }
  return single;
}

std::string outline(const Mesh& mesh, const BoardPlane& plane, const FaceTable& faces,
                    const Canvas& canvas, const std::string& line) {
  const std::vector<std::uint8_t> none(mesh.tets.size(), 0);
  const auto edges = outline_edges(mesh, plane, faces.surface(none));
  if (edges.size() > kMostEdges) {
    const Vec2 a = canvas.map({plane.outline_min.x(), plane.outline_max.y()});
    const Vec2 b = canvas.map({plane.outline_max.x(), plane.outline_min.y()});
    return svg::rect(a, b - a, line);
  }
  std::string d;
  for (const auto& [from, to] : edges) {
    const Vec2 a = canvas.map(plane.project(mesh.nodes[from]));
    const Vec2 b = canvas.map(plane.project(mesh.nodes[to]));
    d += "M" + svg::coordinate(a.x()) + " " + svg::coordinate(a.y()) + "L" +
         svg::coordinate(b.x()) + " " + svg::coordinate(b.y());
  }
  return "<path " + line + " d=\"" + d + "\"/>\n";
}

std::vector<PaintedTriangle> black_triangles(const Mesh& mesh, const BoardPlane& plane,
                                             const std::vector<BodyFace>& removed,
                                             const Canvas& canvas) {
  std::vector<PaintedTriangle> triangles;
  for (const BodyFace& face : removed) {
    const auto corners = projected(mesh, plane, face);
    if (!looks_at_viewer(plane, corners)) continue;
    triangles.push_back(
        {{canvas.map(corners[0]), canvas.map(corners[1]), canvas.map(corners[2])}, kBlack});
  }
  return triangles;
}

}  // namespace

std::string destroyed_inset(const Mesh& mesh, const BoardPlane& plane, const FaceTable& faces,
                            std::span<const std::uint8_t> destroyed, const Vec2& corner,
                            const Vec2& size) {
  Bounds bounds;
  bounds.add(plane.outline_min);
  bounds.add(plane.outline_max);
  const Canvas canvas(bounds);
  const Vec2 room = size - Vec2::Constant(2 * kMargin);
  const double scale = std::min(room.x() / canvas.size().x(), room.y() / canvas.size().y());
  const Vec2 margin = Vec2::Constant(kMargin / scale);
  const Vec2 from = canvas.corner() - margin, extent = canvas.size() + 2 * margin;
  const auto c = [](double v) { return svg::coordinate(v); };
  const std::string line = "fill=\"none\" stroke=\"#8a8f94\" stroke-width=\"" + c(kLine / scale) +
                           "\" stroke-linecap=\"round\"";
  return "<svg class=\"destroyed\" x=\"" + c(corner.x()) + "\" y=\"" + c(corner.y()) +
         "\" width=\"" + c(size.x()) + "\" height=\"" + c(size.y()) + "\" viewBox=\"" +
         c(from.x()) + " " + c(from.y()) + " " + c(extent.x()) + " " + c(extent.y()) +
         "\" preserveAspectRatio=\"xMaxYMin\">\n" + outline(mesh, plane, faces, canvas, line) +
         painted(black_triangles(mesh, plane, faces.removed(destroyed), canvas), canvas,
                 canvas.length(plane.edge_length)) +
         "</svg>\n";
}

}  // namespace sunder::app
