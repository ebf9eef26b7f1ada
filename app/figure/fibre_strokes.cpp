// SPDX-License-Identifier: Apache-2.0
#include "app/figure/fibre_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace sunder::app {
namespace {

constexpr double kSpacing = 16, kLength = 11;  // [px]

using Cell = std::pair<int, int>;

struct Nearest {
  Index element = kNone;
  double nearness = 0;
};

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Barycentric coordinates of a point; outside: none is said.
bool covers(const std::array<Vec2, 3>& t, const Vec2& at, Vec3& shares) {
  const double area = cross(t[1] - t[0], t[2] - t[0]);
  if (area == 0) return false;
  shares.y() = cross(at - t[0], t[2] - t[0]) / area;
  shares.z() = cross(t[1] - t[0], at - t[0]) / area;
  shares.x() = 1 - shares.y() - shares.z();
  return shares.minCoeff() >= 0;
}

Vec2 middle_of(const Cell& cell) { return kSpacing * Vec2(cell.first + 0.5, cell.second + 0.5); }

/// The nearest element at each point of the grid, by rows.
std::map<Cell, Nearest> seen(std::span<const DrawnTriangle> drawn) {
  std::map<Cell, Nearest> grid;
  for (const DrawnTriangle& t : drawn) {
    Vec2 low = t.corners[0], high = low;
    for (const Vec2& c : t.corners) {
      low = low.cwiseMin(c);
      high = high.cwiseMax(c);
    }
    if (!low.allFinite() || !high.allFinite()) continue;
    const auto first = [](double at) { return static_cast<int>(std::ceil(at / kSpacing - 0.5)); };
    for (int x = first(low.x()); kSpacing * (x + 0.5) <= high.x(); ++x) {
      for (int y = first(low.y()); kSpacing * (y + 0.5) <= high.y(); ++y) {
        Vec3 shares;
        if (!covers(t.corners, middle_of({x, y}), shares)) continue;
        const double nearness = shares.dot(Vec3(t.nearness.data()));
        Nearest& there = grid[{x, y}];
        if (there.element == kNone || nearness > there.nearness) there = {t.element, nearness};
      }
    }
  }
  return grid;
}

/// F of an element as it is drawn, by its displacement; where that is beyond what tissue does, as
/// of a piece that nothing holds by law linear, by its places, which are moved near its own there.
Mat3 drawn_gradient(const Mesh& mesh, const State& state, std::span<const Vec3> places,
                    double scale, Index element) {
  constexpr double kOfTissue = 2;
  const Mat3 gradient = scale * nodal_gradient(mesh, element, state.displacement);
  if (gradient.norm() < kOfTissue) return Mat3::Identity() + gradient;
  return nodal_gradient(mesh, element, places);
}

}  // namespace

std::vector<FibreStroke> fibre_strokes(const Problem& problem, const State& state,
                                       std::span<const Vec3> places, double scale,
                                       std::span<const DrawnTriangle> drawn, double pixels_per_mm,
                                       const std::function<Vec2(const Vec3&)>& flat) {
  std::vector<FibreStroke> strokes;
  const int families = problem.fibre_families();
  if (families == 0) return strokes;
  const Mesh& mesh = mesh_of(problem, state);
  for (const auto& [cell, nearest] : seen(drawn)) {
    const Mat3 f = drawn_gradient(mesh, state, places, scale, nearest.element);
    for (int family = 0; family < families; ++family) {
      const Vec3 along = f * problem.fibre_direction(nearest.element, family);
      const double length = along.norm();
      if (!(length > 0) || !std::isfinite(length)) continue;
      const Vec2 half = kLength / 2 / (length * pixels_per_mm) * flat(along);
      const Vec2 at = middle_of(cell);
      strokes.push_back({at - half, at + half, family});
    }
  }
  return strokes;
}

}  // namespace sunder::app
