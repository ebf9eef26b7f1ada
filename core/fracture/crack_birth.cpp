// SPDX-License-Identifier: Apache-2.0
#include "fracture/crack_birth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fracture/stress_intensity.hpp"
#include "sunder/error.hpp"

namespace sunder::fracture {
namespace {

void make_edge(const Board& board, const Vec2& mouth, const Vec2& tip, Crack& crack) {
  crack.kind = CrackKind::edge;
  crack.mouth = mouth;
  crack.path = {mouth, tip};
  crack.length = (tip - mouth).norm();
  crack.tips = {{tip, (tip - mouth).normalized(), at_outline(board, tip)}};
}

void make_internal(const Board& board, const Vec2& first, const Vec2& second, Crack& crack) {
  const Vec2 d = (second - first).normalized();
  crack.kind = CrackKind::internal;
  crack.path = {first, second};
  crack.length = (second - first).norm();
  crack.tips = {{first, -d, at_outline(board, first)}, {second, d, at_outline(board, second)}};
}

/// Across n1, towards larger e1 (upright: e2).
Vec2 birth_direction(const InPlane& stress) {
  const Vec2 d = left_of(principal(stress).n1);
  const bool backwards = d.x() < 0 || (d.x() == 0 && d.y() < 0);
  return backwards ? Vec2(-d) : d;
}

Vec2 mean_centroid(std::span<const Board::LateralFace> faces) {
  Vec2 sum = Vec2::Zero();
  for (const auto& face : faces) sum += face.centroid;
  return sum / static_cast<double>(faces.size());
}

/// Extreme projections of an element's nodes on the line through `origin` along d.
struct Extent {
  double least = std::numeric_limits<double>::infinity();
  double largest = -std::numeric_limits<double>::infinity();
};

Extent extent_along(const Board& board, Index element, const Vec2& origin, const Vec2& d) {
  Extent extent;
  for (Index n : board.mesh().tets[element]) {
    const double along = (board.node(n) - origin).dot(d);
    extent.least = std::min(extent.least, along);
    extent.largest = std::max(extent.largest, along);
  }
  return extent;
}

}  // namespace

bool at_outline(const Board& board, const Vec2& tip) {
  constexpr double kMargin = 0.05;  // of h
  return !(board.plane().inside(tip) > kMargin * board.h());
}

Crack preset_crack(const Board& board, const PresetCrack& preset, int id,
                   const std::vector<Index>& elements, std::pmr::memory_resource* lists) {
  const BoardPlane& plane = board.plane();
  const Vec2 first = plane.project(preset.mouth ? *preset.mouth : preset.tips.front());
  const Vec2 last = plane.project(preset.tips.back());
  if (!((last - first).norm() > 0))
    throw InputError(InputFault::out_of_range,
                     "crack " + std::to_string(id) +
                         " has length 0 in the board's plane; its ends must differ there");
  Crack crack(lists);
  crack.id = id;
  preset.mouth ? make_edge(board, first, last, crack) : make_internal(board, first, last, crack);
  crack.elements.assign(elements.begin(), elements.end());
  return crack;
}

Crack born_crack(const Board& board, Index element, const InPlane& stress, int id,
                 std::pmr::memory_resource* lists) {
  const Vec2& centroid = board.centroid(element);
  Vec2 d = birth_direction(stress);
  Crack crack(lists);
  crack.id = id;
  if (const auto faces = board.lateral_faces(element); !faces.empty()) {
    const Vec2 mouth = mean_centroid(faces);
    if ((centroid - mouth).dot(d) < 0) d = -d;
    const double length = extent_along(board, element, mouth, d).largest;
    make_edge(board, mouth, mouth + length * d, crack);
  } else {
    const Extent extent = extent_along(board, element, centroid, d);
    make_internal(board, centroid + extent.least * d, centroid + extent.largest * d, crack);
  }
  crack.elements = {element};
  return crack;
}

}  // namespace sunder::fracture
