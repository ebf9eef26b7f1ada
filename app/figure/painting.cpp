// SPDX-License-Identifier: Apache-2.0
#include "app/figure/painting.hpp"

#include <algorithm>

#include "app/figure/shading.hpp"
#include "app/figure/svg.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

/// Above this number of triangles the surface goes into the figure as an image, where this build
/// makes images: a picture of a million elements stays a small file.
constexpr std::size_t kMostVectorTriangles = 12000;
/// Mesh lines help the eye on a coarse mesh and darken a fine one.
constexpr std::size_t kMostOutlined = 3000;
constexpr double kImageZoom = 2.0;
/// A lip's outline: a share of an element's edge, within bounds in px, so that it hides no element.
constexpr double kRimShare = 0.12, kThinnest = 0.8, kThickest = 1.8;

std::string point(const Vec2& p) { return svg::coordinate(p.x()) + " " + svg::coordinate(p.y()); }

std::string triangle_path(const std::array<Vec2, 3>& p) {
  return "M" + point(p[0]) + " " + point(p[1]) + " " + point(p[2]) + "z";
}

bool has_rim(const PaintedTriangle& triangle) {
  return triangle.rim[0] || triangle.rim[1] || triangle.rim[2];
}

/// Over its own triangle and under those in front of it.
std::string rim_path(const PaintedTriangle& triangle, double width) {
  std::string d;
  for (int i = 0; i < 3; ++i)
    if (triangle.rim[i])
      d += "M" + point(triangle.corners[i]) + "L" + point(triangle.corners[(i + 1) % 3]);
  return "<path class=\"lip\" fill=\"none\" stroke=\"" + hex(kRimColor) +
         "\" stroke-opacity=\"1\" stroke-linecap=\"round\" stroke-width=\"" +
         svg::coordinate(width) + "\" d=\"" + d + "\"/>\n";
}

/// Runs of one colour share a path.
std::string vector_surface(const std::vector<PaintedTriangle>& triangles, double rim_width) {
  const bool outlined = triangles.size() <= kMostOutlined;
  std::string out =
      "<g stroke-linejoin=\"round\" stroke-width=\"" +
      std::string(outlined ? "0.6\" stroke=\"#000\" stroke-opacity=\"0.22\"" : "0.4\"") + ">\n";
  for (std::size_t i = 0; i < triangles.size();) {
    const Color fill = triangles[i].fill;
    out += "<path fill=\"" + hex(fill) + "\"";
    if (!outlined) out += " stroke=\"" + hex(fill) + "\"";
    out += " d=\"";
    bool rim = false;
    for (; i < triangles.size() && triangles[i].fill == fill && !rim; ++i) {
      out += triangle_path(triangles[i].corners);
      rim = has_rim(triangles[i]);
    }
    out += "\"/>\n";
    if (rim) out += rim_path(triangles[i - 1], rim_width);
  }
  return out + "</g>\n";
}

std::string image_surface(const std::vector<PaintedTriangle>& triangles, const Canvas& canvas,
                          double rim_width) {
  const Vec2 corner = canvas.corner(), size = canvas.size();
  return "<image x=\"" + svg::coordinate(corner.x()) + "\" y=\"" + svg::coordinate(corner.y()) +
         "\" width=\"" + svg::coordinate(size.x()) + "\" height=\"" + svg::coordinate(size.y()) +
         "\" href=\"data:image/png;base64," +
         base64(png_of_triangles(triangles, corner, size, kImageZoom, rim_width)) + "\"/>\n";
}

}  // namespace

std::string painted(const std::vector<PaintedTriangle>& triangles, const Canvas& canvas,
                    double edge_length) {
  const double rim_width = std::clamp(kRimShare * edge_length, kThinnest, kThickest);
  return triangles.size() <= kMostVectorTriangles || !draws_pixels()
             ? vector_surface(triangles, rim_width)
             : image_surface(triangles, canvas, rim_width);
}

}  // namespace sunder::app
