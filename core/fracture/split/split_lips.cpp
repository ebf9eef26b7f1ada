// SPDX-License-Identifier: Apache-2.0
#include "fracture/split/split_lips.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

// Of a layer of tissue as thick as an edge is long: at a compression by a tenth, lips overlap by a
// ten-thousandth of that.
constexpr double kStiffness = 1000;
constexpr double kTouch = 1e-9;     // of h: an overlap that rounding leaves
constexpr double kToldFrom = 1e-3;  // of h: an overlap that is told of

/// Unit, to the left of the nearest piece of a path.
Vec2 across(const Crack& crack, const Vec2& p) {
  Vec2 along = Vec2::UnitX();
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < crack.path.size(); ++k) {
    const Vec2 piece = crack.path[k] - crack.path[k - 1];
    const double size = piece.squaredNorm();
    if (!(size > 0)) continue;
    const double share = std::clamp((p - crack.path[k - 1]).dot(piece) / size, 0.0, 1.0);
    const double distance = (p - crack.path[k - 1] - share * piece).norm();
    if (!(distance < nearest)) continue;
    nearest = distance;
    along = piece / std::sqrt(size);
  }
  return left_of(along);
}

}  // namespace

/// By crack and left node, those of faces at whose nodes elements have parted.
void SplitLips::find_pairs(std::span<const CrackFace> faces, std::span<const Crack> cracks) {
  pairs_.clear();
  std::map<std::pair<Index, Index>, std::size_t> known;
  const auto& nodes = problem_.mesh().nodes;
  for (const CrackFace& face : faces) {
    std::array<Index, 3> in_mesh{};  // the one of both that came first lies there
    for (std::size_t i = 0; i < 3; ++i) in_mesh[i] = std::min(face.left[i], face.right[i]);
    for (std::size_t i = 0; i < 3; ++i) {
      if (face.left[i] == face.right[i] || in_mesh[i] >= problem_.node_count()) continue;
      const auto [at, is_new] = known.try_emplace({face.left[i], face.right[i]}, pairs_.size());
      if (is_new) {
        const Vec2 place = board_.node(in_mesh[i]);
        pairs_.push_back({face.crack, face.left[i], face.right[i], place,
                          across(cracks[static_cast<std::size_t>(face.crack)], place), 0});
      }
      if (std::ranges::any_of(in_mesh, [&](Index n) { return n >= problem_.node_count(); })) {
        continue;  // at a corner of three lips: the area of its other faces is enough
      }
      const auto& x = [&](std::size_t a) -> const Vec3& {
        return nodes[static_cast<std::size_t>(in_mesh[a])];
      };
      pairs_[at->second].area += (x(1) - x(0)).cross(x(2) - x(0)).norm() / 6;
    }
  }
}

/// The stiffest tissue there decides.
Vec3 SplitLips::spring_of(const Pair& pair) const {
  double young = 0;
  for (Index e : board_.elements_of(std::min(pair.left, pair.right))) {
    young = std::max(young, problem_.small_strain(e).young);
  }
  const double area = std::max(pair.area, board_.h() * board_.h() / 100);
  return std::sqrt(kStiffness * young * area / board_.h()) *
         board_.plane().lift_direction(pair.across);
}

/// A spring comes where lips overlap and goes where it would pull.
void SplitLips::press(const Pair& pair, double gap, fem::Change& change) {
  const Index node = std::max(pair.left, pair.right);
  const bool there = pressed_.contains(node);
  if (there ? gap <= 0 : gap >= -kTouch * board_.h()) return;
  if (there) {
    pressed_.erase(node);
    change.ties.push_back({node, 0, Vec3::Zero()});
  } else {
    pressed_.emplace(node, pair);
    change.ties.push_back({node, 0, spring_of(pair)});
  }
}

LipState SplitLips::look(std::span<const CrackFace> faces, std::span<const Crack> cracks,
                         const FractureState& state) {
  LipState lips;
  lips.change.held = true;
  find_pairs(faces, cracks);
  std::vector<Index> nodes;
  for (const Pair& pair : pairs_) nodes.insert(nodes.end(), {pair.left, pair.right});
  std::vector<Vec3> u(nodes.size());
  if (!nodes.empty()) state.displacement(nodes, u);
  const bool apart = problem_.scene().fracture.contact;
  std::map<int, double> overlap;  // by crack
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_[i];
    if (loose_.contains(std::max(pair.left, pair.right))) continue;
    const double gap = (u[2 * i] - u[2 * i + 1]).dot(board_.plane().lift_direction(pair.across));
    if (apart) press(pair, gap, lips.change);
    double& most = overlap[pair.crack];
    most = std::max(most, -gap);
  }
  for (const auto& [crack, most] : overlap) {
    lips.overlap = std::max(lips.overlap, most);
    if (!apart && most > kToldFrom * board_.h()) {
      lips.findings.push_back({Finding::Kind::lips_overlap, crack});
    }
  }
  return lips;
}

bool SplitLips::pressed_near(int crack, const Vec2& place, double radius) const {
  return std::ranges::any_of(pressed_, [&](const auto& spring) {
    const Pair& pair = spring.second;
    return pair.crack == crack && (pair.place - place).norm() <= radius;
  });
}

void SplitLips::loosen(Index node) {
  loose_.insert(node);
  pressed_.erase(node);
}

}  // namespace sunder::fracture
