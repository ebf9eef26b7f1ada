// SPDX-License-Identifier: Apache-2.0
#include "body/triangle_crossing.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace sunder::fem {
namespace {

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

Extent along(const Vec3& axis, std::span<const Vec3> points) {
  Extent range;
  for (const Vec3& p : points) {
    const double at = axis.dot(p);
    range.low = std::min(range.low, at);
    range.high = std::max(range.high, at);
  }
  return range;
}

// A share of the sizes below which two things touch.
constexpr double kTouch = 1e-12;

/// Convex bodies do not meet where some axis sees them side by side. An axis of length 0 sees none.
bool apart(const Vec3& axis, std::span<const Vec3> a, std::span<const Vec3> b) {
  const Extent x = along(axis, a), y = along(axis, b);
  const double size = std::max(x.high - x.low, y.high - y.low), touch = kTouch * size;
  return size > 0 && (x.high <= y.low + touch || y.high <= x.low + touch);
}

}  // namespace

/// Separating axes of two convex bodies: normals of their faces, products of their edges. Places
/// are taken from the triangle's first corner, so that far from the origin no digits are lost.
bool crosses(const std::array<Vec3, 3>& triangle, const std::array<Vec3, 4>& tet) {
  std::array<Vec3, 3> a;
  std::array<Vec3, 4> b;
  std::ranges::transform(triangle, a.begin(), [&](const Vec3& p) { return p - triangle[0]; });
  std::ranges::transform(tet, b.begin(), [&](const Vec3& p) { return p - triangle[0]; });
  const auto finite = [](const Vec3& p) { return p.allFinite(); };
  if (!std::ranges::all_of(a, finite) || !std::ranges::all_of(b, finite)) return false;
  const Vec3 normal = a[1].cross(a[2]);
  if (!(normal.norm() > kTouch * a[1].norm() * a[2].norm())) return false;
  // The triangle is flat: across it a body that lies on both sides meets it.
  const Extent across = along(normal, b);
  if (!(across.low < 0 && across.high > 0)) return false;
  for (int f = 0; f < 4; ++f) {
    const Vec3 &p = b[(f + 1) % 4], &q = b[(f + 2) % 4], &r = b[(f + 3) % 4];
    if (apart((q - p).cross(r - p), a, b)) return false;
  }
  for (int i = 0; i < 3; ++i) {
    const Vec3 edge = a[(i + 1) % 3] - a[i];
    if (apart(normal.cross(edge), a, b)) return false;
    for (int p = 0; p < 4; ++p) {
      for (int q = p + 1; q < 4; ++q) {
        const Vec3 other = b[q] - b[p], axis = edge.cross(other);
        const bool parallel = !(axis.norm() > kTouch * edge.norm() * other.norm());
        if (!parallel && apart(axis, a, b)) return false;
      }
    }
  }
  return true;
}

}  // namespace sunder::fem
