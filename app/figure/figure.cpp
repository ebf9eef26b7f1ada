// SPDX-License-Identifier: Apache-2.0
#include "app/figure/figure.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "app/figure/annotations.hpp"
#include "app/figure/canvas.hpp"
#include "app/figure/pose.hpp"
#include "app/figure/raster.hpp"
#include "app/figure/shading.hpp"
#include "app/figure/surface.hpp"
#include "app/figure/svg.hpp"
#include "app/figure/tip_vectors.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

/// Above this number of triangles the surface goes into the figure as an image: a picture of a
/// million elements stays a small file.
constexpr std::size_t kMostVectorTriangles = 12000;
/// Mesh lines help the eye on a coarse mesh and darken a fine one.
constexpr std::size_t kMostOutlined = 3000;
constexpr double kPngZoom = 1.6, kImageZoom = 2.0;

struct Visible {
  std::array<Vec2, 3> corners;  ///< in the plane, mm
  double depth;                 ///< towards the viewer
  Index tet;
};

/// Towards the viewer when e1 points right and e2 up.
Vec3 viewer(const BoardPlane& plane) { return plane.e1.cross(plane.e2); }

double signed_area(const std::array<Vec2, 3>& p) {
  const Vec2 a = p[1] - p[0], b = p[2] - p[0];
  return (a.x() * b.y() - a.y() * b.x()) / 2;
}

/// Faces that the viewer sees, back to front. Destroyed elements may have turned inside out while
/// they stretched across the tear: theirs count from both sides.
std::vector<Visible> visible_faces(const std::vector<BodyFace>& faces, const Pose& pose,
                                   const BoardPlane& plane, const State& state) {
  std::vector<Visible> visible;
  const Vec3 eye = viewer(plane);
  for (const BodyFace& face : faces) {
    Visible v{{}, 0, face.tet};
    for (int i = 0; i < 3; ++i) {
      const Vec3& x = pose.position[face.nodes[i]];
      v.corners[i] = plane.project(x);
      v.depth += x.dot(eye) / 3;
    }
    const double area = signed_area(v.corners);
    if (area > 0 || (state.destroyed[face.tet] && area != 0)) visible.push_back(v);
  }
  std::stable_sort(visible.begin(), visible.end(),
                   [](const Visible& a, const Visible& b) { return a.depth < b.depth; });
  return visible;
}

std::string triangle_path(const std::array<Vec2, 3>& p) {
  std::string d = "M";
  for (int i = 0; i < 3; ++i)
    d += (i ? " " : "") + svg::coordinate(p[i].x()) + " " + svg::coordinate(p[i].y());
  return d + "z";
}

/// Runs of one colour share a path.
std::string vector_surface(const std::vector<PaintedTriangle>& triangles) {
  const bool outlined = triangles.size() <= kMostOutlined;
  std::string out =
      "<g stroke-linejoin=\"round\" stroke-width=\"" +
      std::string(outlined ? "0.6\" stroke=\"#000\" stroke-opacity=\"0.22\"" : "0.4\"") + ">\n";
  for (std::size_t i = 0; i < triangles.size();) {
    const Color fill = triangles[i].fill;
    out += "<path fill=\"" + hex(fill) + "\"";
    if (!outlined) out += " stroke=\"" + hex(fill) + "\"";
    out += " d=\"";
    for (; i < triangles.size() && triangles[i].fill == fill; ++i)
      out += triangle_path(triangles[i].corners);
    out += "\"/>\n";
  }
  return out + "</g>\n";
}

std::string image_surface(const std::vector<PaintedTriangle>& triangles, const Canvas& canvas) {
  const Vec2 corner = canvas.corner(), size = canvas.size();
  return "<image x=\"" + svg::coordinate(corner.x()) + "\" y=\"" + svg::coordinate(corner.y()) +
         "\" width=\"" + svg::coordinate(size.x()) + "\" height=\"" + svg::coordinate(size.y()) +
         "\" href=\"data:image/png;base64," +
         base64(png_of_triangles(triangles, corner, size, kImageZoom)) + "\"/>\n";
}

std::string surface(const std::vector<Visible>& visible, const std::vector<Color>& colors,
                    const Canvas& canvas) {
  std::vector<PaintedTriangle> triangles;
  triangles.reserve(visible.size());
  for (const Visible& v : visible)
    triangles.push_back(
        {{canvas.map(v.corners[0]), canvas.map(v.corners[1]), canvas.map(v.corners[2])},
         colors[v.tet]});
  return triangles.size() <= kMostVectorTriangles ? vector_surface(triangles)
                                                  : image_surface(triangles, canvas);
}

}  // namespace

FigurePainter::FigurePainter(const Problem& problem)
    : problem_(problem),
      plane_(board_plane(problem.mesh(), problem.scene().fracture.plane_normal)),
      faces_(std::make_unique<FaceTable>(problem.mesh())) {}

FigurePainter::~FigurePainter() = default;

/// What one state puts into a picture.
struct FigurePainter::Scenery {
  Pose pose;
  std::vector<BodyFace> faces;
  std::vector<Visible> visible;
  std::optional<StressScale> scale;
  std::vector<Arrow> arrows;
  Bounds bounds;
};

FigurePainter::Scenery FigurePainter::scenery(const State& state) const {
  Scenery scene;
  scene.pose = pose_of(problem_, plane_, state);
  scene.faces = faces_->surface(state.destroyed);
  scene.visible = visible_faces(scene.faces, scene.pose, plane_, state);
  scene.scale = stress_scale(problem_, state);
  scene.arrows = instrument_arrows(plane_, scene.pose, state);
  scene.bounds.add(plane_.outline_min);
  scene.bounds.add(plane_.outline_max);
  for (const Visible& v : scene.visible)
    for (const Vec2& p : v.corners) scene.bounds.add(p);
  for (const Arrow& arrow : scene.arrows)
    for (const Vec2& p : {arrow.from, arrow.to}) scene.bounds.add(p);
  return scene;
}

std::string FigurePainter::draw_body(const State& state, const Scenery& scene,
                                     const Canvas& canvas) const {
  std::string out = undeformed_outline(plane_, canvas);
  out += surface(scene.visible, element_colors(problem_, state, scene.scale), canvas);
  out += held_edges(problem_, plane_, scene.pose, scene.faces, canvas);
  out += crack_paths(problem_.mesh(), plane_, scene.pose, state, canvas);
  out += draw(scene.arrows, canvas);
  return out + draw_tip_vectors(problem_, plane_, scene.pose, state, canvas);
}

Bounds FigurePainter::bounds(const State& state) const { return scenery(state).bounds; }

double FigurePainter::displacement_scale(const State& state) const {
  return pose_of(problem_, plane_, state).scale;
}

std::string FigurePainter::drawing(const State& state, const Canvas& canvas) const {
  return draw_body(state, scenery(state), canvas);
}

std::string FigurePainter::svg(const State& state) const {
  const Scenery scene = scenery(state);
  const Canvas canvas(scene.bounds);
  std::string out = canvas.open(problem_.scene().title);
  out += draw_body(state, scene, canvas);
  if (scene.scale) out += color_bar(*scene.scale, canvas);
  out += caption(problem_, scene.pose, state, canvas);
  out += tip_vector_key(canvas.corner() - Vec2(0, 8), problem_.scene().fracture.sif,
                        !state.growths.empty());
  return out + "</svg>\n";
}

std::string FigurePainter::png(const std::string& svg) { return png_of_svg(svg, kPngZoom); }

}  // namespace sunder::app
