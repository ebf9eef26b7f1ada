// SPDX-License-Identifier: Apache-2.0
// How the lips of split cracks lie to each other (method.md "Split cracks"): node by node, across
// the ideal path. What keeps them apart is a spring between a new node and its parent, there as
// long as it presses.
#pragma once

#include <map>
#include <set>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/criterion.hpp"

namespace sunder::fracture {

class SplitLips {
 public:
  /// Both must outlive it.
  SplitLips(const Problem& problem, const Board& board) : problem_(problem), board_(board) {}

  /// Of the faces that cracks have opened; springs that come or go count as carried out.
  [[nodiscard]] LipState look(std::span<const CrackFace> faces, std::span<const Crack> cracks,
                              const FractureState& state);
  /// Whether some of a crack's lips press on each other within `radius` of a place [mm].
  [[nodiscard]] bool pressed_near(int crack, const Vec2& place, double radius) const;
  /// A new node hangs on its parent alone from now on: where it lies has no meaning, and a spring
  /// there is gone.
  void loosen(Index node);

  /// Two nodes at the same place of the mesh, one on each lip.
  struct Pair {
    int crack = 0;
    Index left = 0, right = 0;
    Vec2 place, across;  ///< across: unit, to the left of the ideal path
    double area = 0;     ///< of a lip [mm^2]
  };
  /// What a look goes on from, to go back to.
  struct State {
    std::map<Index, Pair> pressed;
    std::set<Index> loose;
  };
  [[nodiscard]] State state() const { return {pressed_, loose_}; }
  void restore(const State& state) {
    pressed_ = state.pressed;
    loose_ = state.loose;
  }

 private:
  void find_pairs(std::span<const CrackFace> faces, std::span<const Crack> cracks);
  void press(const Pair& pair, double gap, fem::Change& change);
  [[nodiscard]] Vec3 spring_of(const Pair& pair) const;

  const Problem& problem_;
  const Board& board_;
  std::vector<Pair> pairs_;
  std::map<Index, Pair> pressed_;  // by the new node
  std::set<Index> loose_;
};

}  // namespace sunder::fracture
