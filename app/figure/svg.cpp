// SPDX-License-Identifier: Apache-2.0
#include "app/figure/svg.hpp"

#include <cmath>

#include "app/output/text.hpp"

namespace sunder::app::svg {
namespace {

std::string points_of(std::span<const Vec2> points) {
  std::string out;
  for (const Vec2& p : points) {
    if (!out.empty()) out += ' ';
    out += coordinate(p.x()) + "," + coordinate(p.y());
  }
  return out;
}

std::string element(std::string_view name, std::string_view own, std::string_view attributes) {
  std::string out = "<" + std::string(name) + " " + std::string(own);
  if (!attributes.empty()) out += " " + std::string(attributes);
  return out + "/>\n";
}

}  // namespace

std::string coordinate(double value) {
  const double hundredths = std::round(value * 100);
  return number(hundredths == 0 ? 0 : hundredths / 100);  // no "-0"
}

std::string open(double width, double height, std::string_view attributes) {
  const std::string w = coordinate(width), h = coordinate(height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
         "\" viewBox=\"0 0 " + w + " " + h + "\" " + std::string(attributes) + ">\n";
}

std::string rect(const Vec2& corner, const Vec2& size, std::string_view attributes) {
  return element("rect",
                 "x=\"" + coordinate(corner.x()) + "\" y=\"" + coordinate(corner.y()) +
                     "\" width=\"" + coordinate(size.x()) + "\" height=\"" + coordinate(size.y()) +
                     "\"",
                 attributes);
}

std::string line(const Vec2& a, const Vec2& b, std::string_view attributes) {
  return element("line",
                 "x1=\"" + coordinate(a.x()) + "\" y1=\"" + coordinate(a.y()) + "\" x2=\"" +
                     coordinate(b.x()) + "\" y2=\"" + coordinate(b.y()) + "\"",
                 attributes);
}

std::string circle(const Vec2& center, double radius, std::string_view attributes) {
  return element("circle",
                 "cx=\"" + coordinate(center.x()) + "\" cy=\"" + coordinate(center.y()) +
                     "\" r=\"" + coordinate(radius) + "\"",
                 attributes);
}

std::string polyline(std::span<const Vec2> points, std::string_view attributes) {
  return element("polyline", "points=\"" + points_of(points) + "\"", attributes);
}

std::string polygon(std::span<const Vec2> points, std::string_view attributes) {
  return element("polygon", "points=\"" + points_of(points) + "\"", attributes);
}

std::string text(const Vec2& at, std::string_view content, std::string_view attributes) {
  return "<text x=\"" + coordinate(at.x()) + "\" y=\"" + coordinate(at.y()) + "\" " +
         std::string(attributes) + ">" + escaped(content) + "</text>\n";
}

}  // namespace sunder::app::svg
