// SPDX-License-Identifier: Apache-2.0
#include "app/figure/tip_vectors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "app/figure/annotations.hpp"
#include "app/figure/svg.hpp"

namespace sunder::app {
namespace {

constexpr double kLongest = 0.14;  // of the body's longest side

struct Style {
  TipVector::Kind kind;
  const char* color;
  const char* name;
  double width;  // of the shaft [px]
};

constexpr std::array<Style, 5> kStyles = {{
    {TipVector::Kind::expansion, "#1a7f37", "K_a e_a", 2},
    {TipVector::Kind::balanced, "#8250df", "K_b d", 2},
    {TipVector::Kind::one_sided, "#d9730d", "K_c e_c", 2},
    {TipVector::Kind::sum, "#111", "v, their sum", 5},
    {TipVector::Kind::field, "#111", "K of the field, along the growth", 3},
}};

const Style& style_of(TipVector::Kind kind) {
  return *std::find_if(kStyles.begin(), kStyles.end(),
                       [&](const Style& style) { return style.kind == kind; });
}

std::string shape(const Vec2& from, const Vec2& to, const Style& style) {
  const Vec2 along = (to - from).normalized(), across(-along.y(), along.x());
  const double head = std::min(9.0, 0.6 * (to - from).norm());
  const Vec2 neck = to - along * head;
  const std::array<Vec2, 3> tip{to, neck + across * head * 0.42, neck - across * head * 0.42};
  const std::string color = style.color;
  // A white rim: the arrows lie on dark red.
  return svg::line(from, to,
                   "stroke=\"#fff\" stroke-opacity=\"0.8\" stroke-width=\"" +
                       svg::coordinate(style.width + 1) + "\"") +
         svg::line(
             from, neck,
             "stroke=\"" + color + "\" stroke-width=\"" + svg::coordinate(style.width) + "\"") +
         svg::polygon(tip, "fill=\"" + color + "\" stroke=\"#fff\" stroke-width=\"0.6\"");
}

Vec2 turned(const Vec2& d, double degrees) {
  return Eigen::Rotation2Dd(degrees * EIGEN_PI / 180) * d;
}

}  // namespace

std::vector<TipVector> tip_vectors(const SifTerms& terms, SifSource drives) {
  using Kind = TipVector::Kind;
  std::vector<TipVector> vectors;
  const auto add = [&](Kind kind, const Vec2& k) {
    if (k.norm() > 0) vectors.push_back({kind, terms.at, k});
  };
  if (drives == SifSource::field) {
    add(Kind::field, terms.k * turned(terms.d, terms.theta));
    return vectors;
  }
  const Vec2 expansion = terms.k_a * terms.e_a, balanced = terms.k_b * terms.d,
             one_sided = terms.k_c * terms.e_c;
  add(Kind::expansion, expansion);
  add(Kind::balanced, balanced);
  add(Kind::one_sided, one_sided);
  add(Kind::sum, expansion + balanced + one_sided);
  return vectors;
}

std::string draw_tip_vectors(const Problem& problem, const BoardPlane& plane, const Pose& pose,
                             const State& state, const Canvas& canvas) {
  const SifSource drives = problem.scene().fracture.sif;
  double longest = 0;
  for (const LastGrowth& growth : state.growths)
    for (const TipVector& v : tip_vectors(growth.terms, drives))
      longest = std::max(longest, v.k.norm());
  const double side = (plane.outline_max - plane.outline_min).maxCoeff();
  std::string out;
  for (const LastGrowth& growth : state.growths) {
    const Crack& crack = state.cracks[static_cast<std::size_t>(growth.crack)];
    const Vec2 root = drawn_point(problem, plane, pose, state, crack, growth.terms.at);
    // The sum lies under its parts: without pressure it is K_a e_a.
    std::vector<TipVector> vectors = tip_vectors(growth.terms, drives);
    std::reverse(vectors.begin(), vectors.end());
    for (const TipVector& v : vectors)
      out += shape(canvas.map(root), canvas.map(root + v.k * (kLongest * side / longest)),
                   style_of(v.kind));
  }
  return out;
}

std::string tip_vector_key(const Vec2& at, SifSource drives, bool any) {
  if (!any) return {};
  constexpr double kArrow = 26, kOfALetter = 7, kGap = 14;
  std::string out = svg::text({at.x(), at.y() + 4.5}, "last growth:", "fill=\"#666\"");
  double x = at.x() + 84;
  for (const Style& style : kStyles) {
    if ((style.kind == TipVector::Kind::field) != (drives == SifSource::field)) continue;
    const std::string name = style.name;
    out += shape({x, at.y()}, {x + kArrow, at.y()}, style);
    out += svg::text({x + kArrow + 5, at.y() + 4.5}, name, "fill=\"#333\"");
    x += kArrow + 5 + kOfALetter * static_cast<double>(name.size()) + kGap;
  }
  return out;
}

}  // namespace sunder::app
