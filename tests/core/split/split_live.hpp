// SPDX-License-Identifier: Apache-2.0
// Random live actions on a board whose cracks split: every now and then the state is computed anew
// on the mesh with those faces open, and the recording leads another simulation to the same bits.
#pragma once

#include <numeric>
#include <random>

#include "core/frame/run_state.hpp"
#include "cut_board.hpp"
#include "sunder/error.hpp"
#include "support/bring.hpp"

namespace sunder::test {

class SplitHand {
 public:
  SplitHand(const CutCase& c, unsigned seed) : case_(c), random_(seed) {
    marks_.push_back(s_.save());
  }

  void act() {
    const unsigned what = below(16);
    if (what < 4) s_.step();
    if (what == 4 || what == 5) cut();
    if (what == 6 || what == 7) grasp();
    if (what > 7 && what < 11) pose();
    if (what == 11) release();
    if (what == 12 && s_.undos() > 0) undo();
    if (what == 13 && s_.redos() > 0) redo();
    if (what == 14) marks_.push_back(s_.save());
    if (what == 15) restore();
  }
  /// Against the mesh with those faces open; the board is in one piece.
  void check() {
    s_.step();
    expect_as_fresh(run_, case_);
  }
  void tell_another() {
    CutRun other(scene());
    other.simulation.load(s_.store());
    expect_same_bits(RunState(other.simulation), RunState(s_));
  }

  int cuts = 0, grasped = 0, posed = 0, released = 0, back = 0;

 private:
  [[nodiscard]] Scene scene() const {
    Scene scene = scene_of(case_, cut_board());
    scene.steps = 1 << 30;
    return scene;
  }
  unsigned below(unsigned n) { return static_cast<unsigned>(random_()) % n; }
  double part() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 vector() { return {part(), part(), part()}; }

  /// What comes off is put back at once.
  void cut() {
    if (s_.crack_faces().size() > 150) return;
    const Vec2 from{5 + 5 * part(), 4 + 4 * part()}, way{2 * part(), 2 * part()};
    if (s_.cut(through(from, from + way)) == 0) return;
    ++cuts;
    if (pieces() > 1) undo();
  }
  [[nodiscard]] int pieces() const {
    const Mesh mesh = s_.mesh();
    std::vector<Index> above(mesh.nodes.size());
    std::iota(above.begin(), above.end(), 0);
    const auto root = [&](Index n) {
      while (above[static_cast<std::size_t>(n)] != n) n = above[static_cast<std::size_t>(n)];
      return n;
    };
    for (const auto& tet : mesh.tets) {
      for (Index n : tet) above[static_cast<std::size_t>(root(n))] = root(tet[0]);
    }
    int count = 0;
    for (Index n = 0; n < mesh.node_count(); ++n) count += root(n) == n;
    return count;
  }
  /// Those that are there now, whatever was taken back.
  [[nodiscard]] std::vector<int> grips() const {
    std::vector<int> there;
    for (int id = 1; id <= highest_; ++id) {
      try {
        if (!s_.held_nodes(id).empty()) there.push_back(id);
      } catch (const UsageError&) {  // let go, or not there yet
      }
    }
    return there;
  }
  void grasp() {
    if (grips().size() > 2) return;
    try {
      const Vec3 at{5 + 4 * part(), 3 + 2.5 * part(), 1};
      highest_ = std::max(highest_, s_.grasp(at, 1.1, below(2) == 1));
      ++grasped;
    } catch (const UsageError&) {  // all there is held, or by another
    }
  }
  void pose() {
    const auto there = grips();
    if (there.empty()) return;
    const int grip = there[below(static_cast<unsigned>(there.size()))];
    Pose to{s_.centre_of(grip) + 0.02 * vector()};
    if (below(2) == 1) to.quaternion = {0.03 * part(), 0.03 * part(), 0.03 * part(), 1};
    bring(s_, grip, to);
    ++posed;
  }
  void release() {
    const auto there = grips();
    if (there.empty()) return;
    s_.release(there[below(static_cast<unsigned>(there.size()))]);
    ++released;
  }
  void undo() {
    s_.undo();
    ++back;
  }
  void redo() {
    s_.redo();
    if (pieces() > 1) undo();
  }
  void restore() {
    s_.restore(marks_[below(static_cast<unsigned>(marks_.size()))]);
    ++back;
  }

  CutCase case_;
  CutRun run_{scene()};
  Simulation& s_ = run_.simulation;
  std::mt19937 random_;
  int highest_ = 0;
  std::vector<Mark> marks_;
};

/// Checks after so many actions, and the recording after so many checks.
inline void play_split(const CutCase& c, unsigned seed, int actions, int check, int record) {
  SplitHand hand(c, seed);
  for (int i = 1; i <= actions && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(i);
    hand.act();
    if (i % check == 0) hand.check();
    if (i % (check * record) == 0) hand.tell_another();
  }
  EXPECT_GT(hand.cuts, actions / 100);
  EXPECT_GT(hand.grasped, actions / 50);
  EXPECT_GT(hand.posed, actions / 50);
  EXPECT_GT(hand.released, actions / 100);
  EXPECT_GT(hand.back, actions / 50);
}

}  // namespace sunder::test
