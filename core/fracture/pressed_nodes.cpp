// SPDX-License-Identifier: Apache-2.0
#include "fracture/pressed_nodes.hpp"

#include <algorithm>
#include <limits>

#include "fracture/crack_path.hpp"

namespace sunder::fracture {
namespace {

/// By the crack's label, else by the side of its path: +1, -1, or 0 on the path itself.
int face_of(const Board& board, const Crack& crack, Index node) {
  constexpr double kOnPath = 1e-9;  // of h: rounding
  const auto label = crack.side.find(node);
  if (label != crack.side.end()) return label->second;
  return path_side(crack, board.node(node), kOnPath * board.h());
}

/// The nearest of the nodes shown to it; ties: the lowest id.
struct Nearest {
  Index node = kNone;
  double distance = std::numeric_limits<double>::infinity();

  void look_at(Index n, double d) {
    if (!(d < distance || (d == distance && n < node))) return;
    node = n;
    distance = d;
  }
};

}  // namespace

PressedNodes pressed_nodes(const Board& board, const Crack& crack, const Press& press,
                           std::span<const std::uint8_t> destroyed) {
  const int face = press.side == CrackSide::upper ? upper_side(crack) : -upper_side(crack);
  const auto held = [&](Index n) {
    const auto around = board.elements_of(n);
    return std::any_of(around.begin(), around.end(), [&](Index e) { return !destroyed[e]; });
  };
  const Vec2 at = board.plane().project(press.at);
  Nearest any, bottom, top;
  for (Index e : crack.elements) {
    for (Index n : board.mesh().tets[e]) {
      if (face_of(board, crack, n) != face || !held(n)) continue;
      any.look_at(n, (board.mesh().nodes[n] - press.at).norm());
      if (board.on_bottom(n)) bottom.look_at(n, (board.node(n) - at).norm());
      if (board.on_top(n)) top.look_at(n, (board.node(n) - at).norm());
    }
  }
  if (bottom.node != kNone && top.node != kNone && bottom.node != top.node)
    return {{bottom.node, top.node}, 2};
  if (any.node == kNone) return {};
  return {{any.node, kNone}, 1};
}

}  // namespace sunder::fracture
