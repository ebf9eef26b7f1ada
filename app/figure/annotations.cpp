// SPDX-License-Identifier: Apache-2.0
#include "app/figure/annotations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "app/figure/svg.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

constexpr double kLongestArrow = 0.16, kShortestArrow = 0.05;  // of the body's longest side
constexpr std::size_t kMostDots = 40, kMostHeldEdges = 4000;
constexpr double kBarSteps = 60;
constexpr std::string_view kYellow = "fill=\"#ffd60a\" stroke=\"#5c4700\" stroke-width=\"1\"";

Vec2 rotated(const Vec2& v) { return {-v.y(), v.x()}; }

/// Distinct places where an instrument's nodes are drawn (a column of nodes through the thickness
/// is one dot).
std::vector<Vec2> dots_of(const BoardPlane& plane, const Pose& pose, const InstrumentState& tool) {
  const double near = plane.edge_length * 0.2;
  std::vector<Vec2> dots;
  for (const Index node : tool.nodes) {
    const Vec2 p = plane.project(pose.position[node]);
    const bool known =
        std::any_of(dots.begin(), dots.end(), [&](const Vec2& d) { return (d - p).norm() < near; });
    if (!known && dots.size() < kMostDots) dots.push_back(p);
  }
  return dots;
}

std::string arrow_shape(const Vec2& from, const Vec2& to) {
  constexpr double shaft = 2.8, head = 8.5, head_length = 15;
  const Vec2 along = (to - from).normalized(), across = rotated(along);
  const Vec2 neck = to - along * head_length;
  const std::array<Vec2, 7> points{
      from + across * shaft, neck + across * shaft, neck + across * head, to,
      neck - across * head,  neck - across * shaft, from - across * shaft};
  return svg::polygon(points, std::string(kYellow) + " stroke-linejoin=\"round\"");
}

/// A force along the line of sight: a ring around the dot.
std::string ring(const Vec2& at) {
  return svg::circle(at, 9, "fill=\"none\" stroke=\"#5c4700\" stroke-width=\"3.4\"") +
         svg::circle(at, 9, "fill=\"none\" stroke=\"#ffd60a\" stroke-width=\"2\"");
}

}  // namespace

Vec2 drawn_point(const Problem& problem, const BoardPlane& plane, const Pose& pose,
                 const State& state, const Crack& crack, const Vec2& point) {
  const Mesh& mesh = mesh_of(problem, state);
  double nearest = std::numeric_limits<double>::infinity(), weights = 0;
  std::vector<std::pair<double, Vec2>> shifts;  // squared distance over h^2
  const auto add = [&](std::span<const Index> nodes) {
    Vec3 centroid = Vec3::Zero(), mean = Vec3::Zero();
    for (const Index node : nodes) {
      centroid += mesh.nodes[node] / static_cast<double>(nodes.size());
      mean += pose.shift[node] / static_cast<double>(nodes.size());
    }
    const double distance =
        (plane.project(centroid) - point).squaredNorm() / (plane.edge_length * plane.edge_length);
    nearest = std::min(nearest, distance);
    shifts.emplace_back(distance, plane.project(mean));
  };
  for (const Index e : crack.elements) add(mesh.tets[e]);
  if (state.split) {
    for (const CrackFace& face : state.split->faces) {
      if (face.crack != crack.id) continue;
      add(face.left);
      add(face.right);
    }
  }
  Vec2 sum = Vec2::Zero();
  for (const auto& [distance, shift] : shifts) {
    const double weight = std::exp(nearest - distance);
    sum += weight * shift;
    weights += weight;
  }
  return shifts.empty() ? point : Vec2(point + sum / weights);
}

namespace {

std::string sentence_of_scale(const Pose& pose) {
  std::string text = "Displacement × " + rounded(pose.scale, 3) +
                     (pose.scale == 1  ? ": true scale"
                      : pose.scale > 1 ? ": magnified, to be seen"
                                       : ": reduced, to fit the page");
  if (pose.loose_piece) text += "; what is cut off is drawn near its place";
  return text + ".";
}

}  // namespace

std::vector<Arrow> instrument_arrows(const BoardPlane& plane, const Pose& pose,
                                     const State& state) {
  const double side = (plane.outline_max - plane.outline_min).maxCoeff();
  double largest = 0;
  for (const InstrumentState& tool : state.instruments)
    largest = std::max(largest, plane.project(tool.force).norm());
  std::vector<Arrow> arrows;
  for (const InstrumentState& tool : state.instruments) {
    if (tool.nodes.empty() || !(tool.force.norm() > 0)) continue;
    Arrow arrow{Vec2::Zero(), Vec2::Zero(), dots_of(plane, pose, tool)};
    for (const Index node : tool.nodes) arrow.from += plane.project(pose.position[node]);
    arrow.from /= static_cast<double>(tool.nodes.size());
    arrow.to = arrow.from;
    const Vec2 force = plane.project(tool.force);
    if (force.norm() > 1e-6 * tool.force.norm())
      arrow.to += force.normalized() * side *
                  std::max(kLongestArrow * force.norm() / largest, kShortestArrow);
    arrows.push_back(std::move(arrow));
  }
  return arrows;
}

std::string draw(const std::vector<Arrow>& arrows, const Canvas& canvas) {
  std::string out;
  for (const Arrow& arrow : arrows) {
    const Vec2 from = canvas.map(arrow.from), to = canvas.map(arrow.to);
    out += (to - from).norm() > 1 ? arrow_shape(from, to) : ring(from);
    for (const Vec2& dot : arrow.dots) out += svg::circle(canvas.map(dot), 5.4, kYellow);
  }
  return out;
}

std::string undeformed_outline(const BoardPlane& plane, const Canvas& canvas) {
  const Vec2 a = canvas.map({plane.outline_min.x(), plane.outline_max.y()});
  const Vec2 b = canvas.map({plane.outline_max.x(), plane.outline_min.y()});
  return svg::rect(a, b - a,
                   "fill=\"none\" stroke=\"#9aa0a6\" stroke-width=\"1\" stroke-dasharray=\"4 4\"");
}

std::string held_edges(const Problem& problem, const BoardPlane& plane, const Pose& pose,
                       const State& state, const std::vector<BodyFace>& faces,
                       const Canvas& canvas) {
  const auto held = [&](Index at) {
    const Index node = state.split ? state.split->in_file[at] : at;
    return problem.dof(node, 0) == kNone || problem.dof(node, 1) == kNone ||
           problem.dof(node, 2) == kNone;
  };
  std::vector<std::pair<Index, Index>> edges;
  for (const BodyFace& face : faces)
    for (int i = 0; i < 3; ++i) {
      const Index a = face.nodes[i], b = face.nodes[(i + 1) % 3];
      if (a < b && held(a) && held(b)) edges.emplace_back(a, b);
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (edges.size() > kMostHeldEdges) return {};
  std::string out = "<g stroke=\"#2b2f33\" stroke-width=\"4\" stroke-linecap=\"round\">\n";
  for (const auto& [a, b] : edges) {
    const Vec2 from = canvas.map(plane.project(pose.position[a]));
    const Vec2 to = canvas.map(plane.project(pose.position[b]));
    if ((to - from).norm() > 0.01) out += svg::line(from, to, "");
  }
  return out + "</g>\n";
}

std::string crack_paths(const Problem& problem, const BoardPlane& plane, const Pose& pose,
                        const State& state, const Canvas& canvas) {
  std::string out;
  for (const Crack& crack : state.cracks) {
    if (state.split) {  // its lips show the path, and where they are far apart it lies nowhere
      for (const CrackTip& tip : crack.tips) {
        if (tip.ended) continue;
        const Vec2 at = canvas.map(drawn_point(problem, plane, pose, state, crack, tip.position));
        out += svg::circle(at, 3.6, "fill=\"#fff\" stroke=\"#0a84ff\" stroke-width=\"1.8\"");
      }
      continue;
    }
    std::vector<Vec2> points;
    for (const Vec2& p : crack.path)
      points.push_back(canvas.map(drawn_point(problem, plane, pose, state, crack, p)));
    out += svg::polyline(points,
                         "fill=\"none\" stroke=\"#fff\" stroke-opacity=\"0.75\" stroke-width=\"4\" "
                         "stroke-linejoin=\"round\" stroke-linecap=\"round\"");
    out += svg::polyline(points,
                         "fill=\"none\" stroke=\"#0a84ff\" stroke-width=\"2\" "
                         "stroke-linejoin=\"round\" stroke-linecap=\"round\"");
    for (const CrackTip& tip : crack.tips)
      out += svg::circle(canvas.map(drawn_point(problem, plane, pose, state, crack, tip.position)),
                         3.6,
                         tip.ended ? "fill=\"#0a84ff\" stroke=\"#fff\" stroke-width=\"1\""
                                   : "fill=\"#fff\" stroke=\"#0a84ff\" stroke-width=\"1.8\"");
  }
  return out;
}

std::string color_bar(const StressScale& scale, const Canvas& canvas) {
  const double height = std::min(canvas.size().y() - 20, 300.0), width = 16;
  const Vec2 corner(canvas.corner().x() + canvas.size().x() + 28,
                    canvas.corner().y() + (canvas.size().y() - height) / 2 + 10);
  std::string out;
  for (int i = 0; i < kBarSteps; ++i) {
    const double share = (i + 0.5) / kBarSteps;
    const double y = corner.y() + height * (1 - (i + 1) / kBarSteps);
    out += svg::rect({corner.x(), y}, {width, height / kBarSteps + 0.5},
                     "fill=\"" + hex(red(share)) + "\"");
  }
  out += svg::rect(corner, {width, height}, "fill=\"none\" stroke=\"#555\" stroke-width=\"0.8\"");
  constexpr int ticks = 5;
  for (int i = 0; i <= ticks; ++i) {
    const double y = corner.y() + height * (1 - static_cast<double>(i) / ticks);
    out += svg::line({corner.x() + width, y}, {corner.x() + width + 4, y}, "stroke=\"#555\"");
    out += svg::text({corner.x() + width + 8, y + 4.5}, rounded(scale.maximum * i / ticks, 3),
                     "fill=\"#333\"");
  }
  return out + svg::text({corner.x() - 22, corner.y() - 14}, scale.label, "fill=\"#333\"");
}

namespace {

std::string what_happened(const Problem& problem, const State& state) {
  const std::string destroyed = counted(state.destroyed_count, "element") + " of " +
                                grouped(problem.tet_count()) + " destroyed";
  if (!state.split) return destroyed + ".";
  const double area = crack_area(*state.split);
  const std::string open = counted(static_cast<long long>(state.cracks.size()), "crack") + ", " +
                           rounded(area, 3) + " mm² split open";
  return state.destroyed_count > 0 ? destroyed + "; " + open + "." : open + ".";
}

}  // namespace

std::string caption(const Problem& problem, const Pose& pose, const State& state,
                    const Canvas& canvas) {
  const Scene& scene = problem.scene();
  const std::string what = "Step " + std::to_string(state.step + 1) + " of " +
                           std::to_string(scene.steps) + ", load factor " +
                           rounded(state.load_factor, 4) + ": " + what_happened(problem, state);
  std::string legend = "Dashed: undeformed";
  if (shows_frame(problem)) legend += "; grey: unbreakable";
  if (!state.cracks.empty()) {
    legend += state.split ? "; blue circle: crack tip" : "; blue line: crack path";
  }
  if (!state.instruments.empty()) legend += "; yellow: instruments";
  legend += "; thick line: held.";
  const double left = canvas.corner().x();
  double y = canvas.corner().y() + canvas.size().y() + 34;
  std::string out;
  const auto add = [&](const std::string& text, const char* attributes) {
    out += svg::text({left, y}, text, attributes);
    y += 21;
  };
  add(what, "fill=\"#222\"");
  add(sentence_of_scale(pose), "fill=\"#222\"");
  if (state.split)
    add(std::string("Lips, outlined and shaded, lie on the ideal path") +
            (state.destroyed_count > 0 ? "; small picture: destroyed elements." : "."),
        "fill=\"#666\"");
  else if (state.destroyed_count > 0)
    add("A tear is a gap, its lips outlined and shaded; the small picture shows the destroyed "
        "elements.",
        "fill=\"#666\"");
  add(legend, "fill=\"#666\"");
  return out;
}

}  // namespace sunder::app
