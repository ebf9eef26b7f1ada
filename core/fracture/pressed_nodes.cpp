// SPDX-License-Identifier: Apache-2.0
#include "fracture/pressed_nodes.hpp"

#include <algorithm>
#include <limits>

#include "fracture/crack_path.hpp"

namespace sunder::fracture {
namespace {

/// Nodes of the crack's elements, ascending, each once.
std::vector<Index> crack_nodes(const Board& board, const Crack& crack) {
  std::vector<Index> nodes;
  for (Index e : crack.elements)
    nodes.insert(nodes.end(), board.mesh().tets[e].begin(), board.mesh().tets[e].end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// By the crack's label, else by the side of its path: +1, -1, or 0 on the path itself.
int face_of(const Board& board, const Crack& crack, Index node) {
  constexpr double kOnPath = 1e-9;  // of h: rounding
  const auto label = crack.side.find(node);
  if (label != crack.side.end()) return label->second;
  return path_side(crack, board.node(node), kOnPath * board.h());
}

/// First node of the list with the least distance; kNone for an empty list.
template <typename Distance>
Index nearest(const std::vector<Index>& nodes, Distance distance) {
  Index best = kNone;
  double least = std::numeric_limits<double>::infinity();
  for (Index n : nodes) {
    if (!(distance(n) < least)) continue;
    least = distance(n);
    best = n;
  }
  return best;
}

}  // namespace

std::vector<Index> pressed_nodes(const Board& board, const Crack& crack, const Press& press,
                                 std::span<const std::uint8_t> destroyed) {
  const int face = press.side == CrackSide::upper ? upper_side(crack) : -upper_side(crack);
  const auto held = [&](Index n) {
    const auto around = board.elements_of(n);
    return std::any_of(around.begin(), around.end(), [&](Index e) { return !destroyed[e]; });
  };
  std::vector<Index> all, bottom, top;
  for (Index n : crack_nodes(board, crack)) {
    if (face_of(board, crack, n) != face || !held(n)) continue;
    all.push_back(n);
    if (board.on_bottom(n)) bottom.push_back(n);
    if (board.on_top(n)) top.push_back(n);
  }
  const Vec2 at = board.plane().project(press.at);
  const auto in_plane = [&](Index n) { return (board.node(n) - at).norm(); };
  const Index low = nearest(bottom, in_plane), high = nearest(top, in_plane);
  if (low != kNone && high != kNone && low != high) return {low, high};
  const Index any =
      nearest(all, [&](Index n) { return (board.mesh().nodes[n] - press.at).norm(); });
  return any == kNone ? std::vector<Index>{} : std::vector<Index>{any};
}

}  // namespace sunder::fracture
