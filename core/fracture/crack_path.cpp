// SPDX-License-Identifier: Apache-2.0
#include "fracture/crack_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

/// Distance from p to the segment from a, and where its foot lies: 0 at a, 1 at b.
struct Foot {
  double distance;
  double share;
};

Foot foot_on_segment(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 along = b - a;
  const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return {(p - a - share * along).norm(), share};
}

}  // namespace

double crack_length(const Crack& crack) {
  return crack.kind == CrackKind::internal ? crack.length / 2 : crack.length;
}

PathPoint crack_origin(const Crack& crack) {
  const auto& path = crack.path;
  double left = crack.kind == CrackKind::internal ? crack.length / 2 : 0.0;
  for (std::size_t k = 0; k + 2 < path.size(); ++k) {
    const Vec2 step = path[k + 1] - path[k];
    if (left < step.norm()) return {path[k] + left * step.normalized(), step.normalized()};
    left -= step.norm();
  }
  const Vec2& last = path[path.size() - 2];
  const Vec2 d = (path.back() - last).normalized();
  return {last + left * d, d};
}

int path_side(std::span<const Vec2> path, const Vec2& p, double tolerance) {
  std::size_t nearest = 0;
  Foot best{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const Foot foot = foot_on_segment(path[k], path[k + 1], p);
    if (foot.distance < best.distance) {
      best = foot;
      nearest = k;
    }
  }
  Vec2 d = (path[nearest + 1] - path[nearest]).normalized();
  Vec2 origin = path[nearest];
  // At a kink the side follows the bisector: one segment's line alone would misjudge its lee.
  if (best.share == 1 && nearest + 2 < path.size()) {
    d = (d + (path[nearest + 2] - path[nearest + 1]).normalized()).normalized();
    origin = path[nearest + 1];
  }
  const double offset = (p - origin).dot(left_of(d));
  return offset > tolerance ? 1 : offset < -tolerance ? -1 : 0;
}

Vec2 upward_normal(const Crack& crack) {
  constexpr double kUpright = 0.1;
  const Vec2 n = left_of(crack_origin(crack).direction);
  const double sense = std::abs(n.y()) < kUpright ? n.x() : n.y();
  return sense < 0 ? Vec2(-n) : n;
}

int upper_side(const Crack& crack) {
  return upward_normal(crack).dot(left_of(crack_origin(crack).direction)) > 0 ? 1 : -1;
}

void advance_tip(Crack& crack, std::size_t tip, const Vec2& g, double advance) {
  CrackTip& t = crack.tips[tip];
  t.position += advance * g;
  t.direction = g;
  crack.length += advance;
  const bool at_front = orientation(crack, tip) < 0;
  crack.path.insert(at_front ? crack.path.begin() : crack.path.end(), t.position);
}

}  // namespace sunder::fracture
