// SPDX-License-Identifier: Apache-2.0
#include "app/figure/figure.hpp"

#include "app/figure/annotations.hpp"
#include "app/figure/canvas.hpp"
#include "app/figure/fibre_strokes.hpp"
#include "app/figure/inset.hpp"
#include "app/figure/painting.hpp"
#include "app/figure/pose.hpp"
#include "app/figure/raster.hpp"
#include "app/figure/shading.hpp"
#include "app/figure/surface.hpp"
#include "app/figure/svg.hpp"
#include "app/figure/tip_vectors.hpp"
#include "app/figure/visible.hpp"

namespace sunder::app {
namespace {

constexpr double kPngZoom = 1.6;

std::string surface(const std::vector<VisibleFace>& visible, const std::vector<Color>& colors,
                    const Canvas& canvas, double edge_length) {
  std::vector<PaintedTriangle> triangles;
  triangles.reserve(visible.size());
  for (const VisibleFace& v : visible) {
    const Color color = colors[v.face.tet];
    triangles.push_back(
        {{canvas.map(v.corners[0]), canvas.map(v.corners[1]), canvas.map(v.corners[2])},
         v.face.lip ? shaded(color) : color,
         v.outlined});
  }
  return painted(triangles, canvas, canvas.length(edge_length));
}

std::string fibres(const Problem& problem, const BoardPlane& plane, const Pose& pose,
                   const State& state, const std::vector<VisibleFace>& visible,
                   const Canvas& canvas) {
  std::vector<DrawnTriangle> drawn;
  for (std::size_t i = 0; i < visible.size(); ++i) {  // the last ones lie in front
    const auto order = static_cast<double>(i);
    const auto& [a, b, c] = visible[i].corners;
    drawn.push_back({{canvas.map(a), canvas.map(b), canvas.map(c)},
                     {order, order, order},
                     visible[i].face.tet});
  }
  const auto flat = [&](const Vec3& direction) -> Vec2 {
    return canvas.map(plane.project(direction)) - canvas.map(Vec2::Zero());
  };
  std::string out;
  for (const FibreStroke& stroke :
       fibre_strokes(problem, state, pose.position, pose.scale, drawn, canvas.length(1), flat)) {
    out += svg::line(stroke.from, stroke.to,
                     "stroke=\"" + hex(kFibres[static_cast<std::size_t>(stroke.family)]) +
                         "\" stroke-width=\"1\" stroke-opacity=\"0.6\"");
  }
  return out;
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
  std::vector<VisibleFace> visible;
  std::optional<StressScale> scale;
  std::vector<Arrow> arrows;
  Bounds bounds;
};

FigurePainter::Scenery FigurePainter::scenery(const State& state) const {
  Scenery scene;
  scene.pose = pose_of(problem_, plane_, state);
  const Mesh& mesh = mesh_of(problem_, state);
  scene.faces = state.split ? FaceTable(mesh, *faces_).surface(state.destroyed)
                            : faces_->surface(state.destroyed);
  scene.visible = visible_faces(mesh, plane_, scene.pose, scene.faces);
  scene.scale = stress_scale(problem_, state);
  scene.arrows = instrument_arrows(plane_, scene.pose, state);
  scene.bounds.add(plane_.outline_min);
  scene.bounds.add(plane_.outline_max);
  for (const VisibleFace& v : scene.visible)
    for (const Vec2& p : v.corners) scene.bounds.add(p);
  for (const Arrow& arrow : scene.arrows)
    for (const Vec2& p : {arrow.from, arrow.to}) scene.bounds.add(p);
  return scene;
}

std::string FigurePainter::draw_body(const State& state, const Scenery& scene,
                                     const Canvas& canvas) const {
  std::string out = undeformed_outline(plane_, canvas);
  out += surface(scene.visible, element_colors(problem_, state, scene.scale), canvas,
                 plane_.edge_length);
  out += fibres(problem_, plane_, scene.pose, state, scene.visible, canvas);
  out += held_edges(problem_, plane_, scene.pose, state, scene.faces, canvas);
  out += crack_paths(problem_, plane_, scene.pose, state, canvas);
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
  const bool gone = state.destroyed_count > 0;
  const Canvas canvas(scene.bounds, gone || state.split ? kTornCaption : kCaption);
  std::string out = canvas.open(problem_.scene().title);
  out += draw_body(state, scene, canvas);
  if (scene.scale) out += color_bar(*scene.scale, canvas);
  out += caption(problem_, scene.pose, state, canvas);
  if (gone)
    out += destroyed_inset(problem_.mesh(), plane_, *faces_, state.destroyed, canvas.inset_corner(),
                           canvas.inset_size());
  out += tip_vector_key(canvas.corner() - Vec2(0, 16), problem_.scene().fracture.sif,
                        !state.growths.empty());
  return out + "</svg>\n";
}

std::string FigurePainter::png(const std::string& svg) { return png_of_svg(svg, kPngZoom); }

}  // namespace sunder::app
