// SPDX-License-Identifier: Apache-2.0
#include "app/view/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "app/figure/fibre_strokes.hpp"
#include "app/figure/svg.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

using Anchor = Overlay::Text::Anchor;

constexpr double kMargin = 24, kBarTop = 118;  // [px]
// The longest arrow over the body's longest side; below kLeastForce of it none is drawn.
constexpr double kArrow = 0.18, kLeastForce = 0.01;
constexpr double kHead = 11, kHeadWidth = 5, kShaft = 3;  // [px]
constexpr int kBarSteps = 64;
// A force below so much of the largest E times the body's side squared is rounding.
constexpr double kRounding = 1e-9;

double longest_side(const Mesh& mesh) {
  Vec3 low = mesh.nodes.front(), high = low;
  for (const Vec3& x : mesh.nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).maxCoeff();
}

/// From a point along a direction on the picture; a dot where it points at the eye.
void add_arrow(Overlay& out, const Vec2& from, const Vec2& along, Color color) {
  const double length = along.norm();
  if (length < kHead) {
    std::vector<Vec2> dot;
    for (const Vec2& c : {Vec2(1, 0), Vec2(0.7, 0.7), Vec2(0, 1), Vec2(-0.7, 0.7), Vec2(-1, 0),
                          Vec2(-0.7, -0.7), Vec2(0, -1), Vec2(0.7, -0.7)}) {
      dot.push_back(from + kHeadWidth * c);
    }
    out.polygons.push_back({dot, color});
    return;
  }
  const Vec2 d = along / length, side(-d.y(), d.x());
  const Vec2 tip = from + along, neck = tip - kHead * d;
  out.lines.push_back({from, neck, kShaft, color});
  out.polygons.push_back({{tip, neck + kHeadWidth * side, neck - kHeadWidth * side}, color});
}

void add_forces(Overlay& out, const Problem& problem, const Shown& shown, const Camera& camera) {
  const State& state = shown.state;
  double largest = 0;
  for (const InstrumentState& tool : state.instruments) {
    largest = std::max(largest, tool.force.norm());
  }
  double young = 0;
  for (const auto& [name, material] : problem.scene().materials) {
    young = std::max(young, material.young);
  }
  const double side = longest_side(problem.mesh());
  if (!(largest > kRounding * young * side * side)) return;
  for (const InstrumentState& tool : state.instruments) {
    if (tool.nodes.empty() || !(tool.force.norm() > kLeastForce * largest)) continue;
    Vec3 middle = Vec3::Zero();
    for (const Index n : tool.nodes) middle += shown.places[static_cast<std::size_t>(n)];
    middle /= static_cast<double>(tool.nodes.size());
    const Vec2 from = camera.project(middle);
    const Vec2 along = camera.turn(kArrow * side / largest * tool.force).head<2>();
    add_arrow(out, from, along, kForce);
    const bool leftwards = along.x() < 0;
    const PictureSize& size = camera.size();
    const Vec2 beside = from + along + Vec2(leftwards ? -8 : 8, 5);
    out.texts.push_back({{std::clamp(beside.x(), kMargin, size.width - kMargin),
                          std::clamp(beside.y(), kMargin, size.height - kMargin / 2)},
                         rounded(tool.force.norm(), 3) + " N",
                         12,
                         leftwards ? Anchor::right : Anchor::left,
                         false});
  }
}

/// Of the triangles that look at the eye; what a clip cuts away has none.
void add_fibres(Overlay& out, const Problem& problem, const Shown& shown, const Look& look,
                const Camera& camera) {
  if (problem.fibre_families() == 0) return;
  std::vector<DrawnTriangle> drawn;
  for (const SurfaceTriangle& t : shown.triangles) {
    DrawnTriangle triangle;
    triangle.element = t.element;
    bool clipped = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& at = shown.places[static_cast<std::size_t>(t.nodes[i])];
      triangle.corners[i] = camera.project(at);
      triangle.nearness[i] = camera.eye().dot(at);
      clipped = clipped || (look.clip.normal && look.clip.normal->dot(at) > look.clip.offset);
    }
    const Vec2 a = triangle.corners[1] - triangle.corners[0];
    const Vec2 b = triangle.corners[2] - triangle.corners[0];
    // y runs downwards on a picture: what looks at the eye turns clockwise.
    if (!clipped && a.x() * b.y() - a.y() * b.x() < 0) drawn.push_back(triangle);
  }
  const auto flat = [&](const Vec3& direction) -> Vec2 { return camera.turn(direction).head<2>(); };
  for (const FibreStroke& stroke :
       fibre_strokes(problem, shown.state, shown.places, 1, drawn, camera.pixels_per_mm(), flat)) {
    out.lines.push_back(
        {stroke.from, stroke.to, 1.5, kFibrePens[static_cast<std::size_t>(stroke.family)]});
  }
}

/// Where a point of the undeformed body is: as its nearest node has moved.
Vec3 moved(const Problem& problem, const Shown& shown, const Vec3& point) {
  const Mesh& mesh = mesh_of(problem, shown.state);
  std::size_t nearest = 0;
  for (std::size_t n = 1; n < mesh.nodes.size(); ++n) {
    if ((mesh.nodes[n] - point).squaredNorm() < (mesh.nodes[nearest] - point).squaredNorm()) {
      nearest = n;
    }
  }
  return point + shown.places[nearest] - mesh.nodes[nearest];
}

void add_tips(Overlay& out, const Problem& problem, const Shown& shown, const Camera& camera) {
  constexpr double kRadius = 6;
  for (const TipState& tip : shown.tips) {
    const Vec2 at = camera.project(moved(problem, shown, tip.position));
    for (const double turned : {1.0, -1.0}) {
      const Vec2 arm(kRadius, turned * kRadius);
      out.lines.push_back({at - arm, at + arm, 2, kTip});
    }
    std::string words = "crack " + std::to_string(tip.crack);
    if (tip.ended) {
      words += ", ended";
    } else if (tip.k) {
      words += ", K " + rounded(*tip.k, 3);
    } else if (tip.j) {
      words += ", J " + rounded(*tip.j, 3);
    }
    out.texts.push_back({at + Vec2(10, -6), words, 12, Anchor::left, false});
  }
}

void add_colour_bar(Overlay& out, const Paint& paint, const PictureSize& size) {
  if (paint.label.empty()) return;
  // In whole pixels, so that no seam shows.
  const double step = std::clamp(std::floor(size.height / 2.8 / kBarSteps), 1.0, 4.0), width = 16;
  const double height = step * kBarSteps;
  const double right = size.width - kMargin, left = right - width;
  const double bottom = kBarTop + height;
  for (int i = 0; i < kBarSteps; ++i) {
    const double y = bottom - i * step;
    out.polygons.push_back(
        {{{left, y}, {right, y}, {right, y - step}, {left, y - step}}, red((i + 0.5) / kBarSteps)});
  }
  for (const double share : {0.0, 0.5, 1.0}) {
    const double y = bottom - share * height;
    out.lines.push_back({{left - 5, y}, {left, y}, 1, kInk});
    out.texts.push_back(
        {{left - 9, y + 4}, rounded(share * paint.maximum, 3), 12, Anchor::right, false});
  }
  out.texts.push_back({{right, bottom - height - 14}, paint.label, 12, Anchor::right, false});
}

/// 1, 2 or 5 times a power of ten, at most a fifth of the picture long.
void add_length_bar(Overlay& out, const Camera& camera) {
  const PictureSize& size = camera.size();
  const double most = size.width / 5.0 / camera.pixels_per_mm();
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  const double mm = most >= 5 * power ? 5 * power : most >= 2 * power ? 2 * power : power;
  const double y = size.height - kMargin, right = kMargin + mm * camera.pixels_per_mm();
  out.lines.push_back({{kMargin, y}, {right, y}, 2, kInk});
  for (const double x : {kMargin, right}) out.lines.push_back({{x, y - 4}, {x, y + 4}, 2, kInk});
  out.texts.push_back(
      {{(kMargin + right) / 2, y - 8}, rounded(mm, 3) + " mm", 12, Anchor::middle, false});
}

void add_words(Overlay& out, const FrameWords& words, const PictureSize& size) {
  const auto size_of = [&](const std::string& text, double wide, double most) {
    const double fits = (size.width - 2 * kMargin) / (wide * static_cast<double>(text.size() + 1));
    return std::clamp(fits, 9.0, most);
  };
  constexpr double kBold = 0.66, kPlain = 0.56;  // widths of letters over their size
  double y = kMargin + 10;
  out.texts.push_back(
      {{kMargin, y}, words.title, size_of(words.title, kBold, 17), Anchor::left, true});
  for (const std::string& line : words.lines) {
    y += 19;
    out.texts.push_back({{kMargin, y}, line, size_of(line, kPlain, 13), Anchor::left, false});
  }
}

std::string fill(Color color) { return "fill=\"" + hex(color) + "\""; }

}  // namespace

Overlay overlay(const Problem& problem, const Shown& shown, const Paint& paint, const Look& look,
                const Camera& camera) {
  Overlay out;
  if (look.fibres) add_fibres(out, problem, shown, look, camera);
  if (look.arrows) add_forces(out, problem, shown, camera);
  if (look.tips) add_tips(out, problem, shown, camera);
  if (!look.text) return out;
  add_colour_bar(out, paint, camera.size());
  add_length_bar(out, camera);
  add_words(out, shown.words, camera.size());
  return out;
}

std::string svg_of(const Overlay& overlay, const PictureSize& size) {
  std::string svg =
      svg::open(size.width, size.height, "font-family=\"DejaVu Sans, Verdana, sans-serif\"");
  for (const Overlay::Polygon& p : overlay.polygons) svg += svg::polygon(p.corners, fill(p.fill));
  for (const Overlay::Line& l : overlay.lines) {
    svg += svg::line(
        l.from, l.to,
        "stroke=\"" + hex(l.color) + "\" stroke-width=\"" + svg::coordinate(l.width) + "\"");
  }
  for (const Overlay::Text& t : overlay.texts) {
    const char* anchor = t.anchor == Anchor::left     ? "start"
                         : t.anchor == Anchor::middle ? "middle"
                                                      : "end";
    svg += svg::text(t.at, t.words,
                     fill(kInk) + " stroke=\"" + hex(kBackground) +
                         "\" stroke-width=\"3\" paint-order=\"stroke\" font-size=\"" +
                         svg::coordinate(t.size) + "\" text-anchor=\"" + anchor + "\"" +
                         (t.bold ? " font-weight=\"bold\"" : ""));
  }
  return svg + "</svg>\n";
}

}  // namespace sunder::app
