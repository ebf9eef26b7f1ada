// SPDX-License-Identifier: Apache-2.0
// What a hand may do to a live body, by chance, with what then acts on it.
#pragma once

#include <random>

#include "core/frame/live_world.hpp"
#include "sunder/error.hpp"
#include "support/bring.hpp"

namespace sunder::test {

class LiveHand {
 public:
  LiveHand(LiveRun& run, unsigned seed) : run_(run), s_(run.simulation), random_(seed) {
    const auto& instruments = run.problem->scene().instruments;
    for (std::size_t i = 0; i < instruments.size(); ++i) {
      if (std::holds_alternative<Grip>(instruments[i].action)) own_.push_back(static_cast<int>(i));
    }
  }

  /// Nothing a hand does here may fail but where a piece hangs on nothing.
  void act() {
    const unsigned what = below(24);
    if (marks_.empty()) save();
    const std::size_t undos = static_cast<std::size_t>(s_.undos());
    const Acting before = acting();
    travels_ = false;
    try {
      one_of(what);
    } catch (const NumericalError&) {
      ++failed;
    }
    // What undo() stops before has come.
    if (!travels_ && static_cast<std::size_t>(s_.undos()) > undos) {
      points_.push_back(before);
      undone_.clear();
    }
  }

  int failed = 0, grasped = 0, posed = 0, released = 0, removed = 0, back = 0, own = 0;

 private:
  struct Acting {
    std::optional<Vec3> driven;
    std::map<int, std::pair<std::vector<Index>, Vec3>> pushes;
    std::vector<int> grips, own;
  };
  struct Marked {
    Mark mark;
    Acting acting;
    std::vector<Acting> points;
  };

  void one_of(unsigned what) {
    if (what < 6) s_.step();
    if (what == 6 || what == 7) grasp();
    if (what >= 8 && what < 12) pose();
    if (what == 12) release();
    if (what == 13) push();
    if (what == 14) move();
    if (what == 15) drop();
    if (what == 16 || what == 17) remove();
    if (what == 18 && below(4) == 0) cut();
    if (what == 19 && s_.undos() > 0) undo();
    if (what == 20 && s_.redos() > 0) redo();
    if (what == 21) save();
    if (what == 22) restore();
    if (what == 23) run_.drive(0.3 * vector() - Vec3(0, 1, 0));
  }

  unsigned below(unsigned n) { return static_cast<unsigned>(random_()) % n; }
  double part() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 vector() { return {part(), part(), part()}; }
  /// Nodes that stand beside each other and may be taken.
  std::vector<Index> nodes() {
    std::vector<Index> all;
    const auto gripped = s_.backend().gripped_dofs();
    for (unsigned i = below(5) + 1; i > 0; --i) {
      const auto n = static_cast<Index>(below(static_cast<unsigned>(run_.problem->node_count())));
      const Index d = run_.problem->dof(n, 0);
      if (d == kNone || std::ranges::find(gripped, d) != gripped.end()) continue;
      if (std::ranges::find(all, n) == all.end() && has_element(n)) all.push_back(n);
    }
    return all;
  }
  bool has_element(Index node) const {
    for (Index e = 0; e < run_.problem->tet_count(); ++e) {
      const auto& tet = run_.problem->mesh().tets[static_cast<std::size_t>(e)];
      if (!s_.backend().destroyed()[e] && std::ranges::find(tet, node) != tet.end()) return true;
    }
    return false;
  }

  void grasp() {
    const auto list = nodes();
    if (list.empty() || grips_.size() > 3) return;
    grips_.push_back(s_.grasp(list, below(2) == 1));
    ++grasped;
  }
  void pose() {
    if (grips_.empty()) return;
    const int grip = grips_[below(static_cast<unsigned>(grips_.size()))];
    Pose to{s_.centre_of(grip) + 0.05 * vector()};
    if (below(2) == 1) to.quaternion = {0.1 * part(), 0.1 * part(), 0.1 * part(), 1};
    bring(s_, grip, to);
    ++posed;
  }
  void release() {
    if (!own_.empty() && below(2) == 1) {
      s_.release(own_.back());
      own_.pop_back();
      ++own;
      return;
    }
    if (grips_.empty()) return;
    const auto at = grips_.begin() + below(static_cast<unsigned>(grips_.size()));
    s_.release(*at);
    grips_.erase(at);
    ++released;
  }
  void push() {
    const auto list = nodes();
    if (!list.empty() && run_.pushes.size() < 3) run_.push(list, 0.1 * vector());
  }
  void move() {
    const auto list = nodes();
    if (!list.empty() && !run_.pushes.empty()) {
      run_.move(run_.pushes.begin()->first, list, 0.1 * vector());
    }
  }
  void drop() {
    if (!run_.pushes.empty()) run_.drop(run_.pushes.begin()->first);
  }
  /// So few that the strip stays one piece for the most part.
  void remove() {
    const auto e = static_cast<Index>(below(static_cast<unsigned>(run_.problem->tet_count())));
    if (s_.backend().destroyed()[e] || gone() > 30) return;
    s_.remove(std::vector<Index>{e});
    ++removed;
  }
  void cut() {
    if (gone() > 20) return;
    const double x = 4 * std::abs(part()), y = 7 * std::abs(part());
    const Vec3 a(x, y, -1), b(x, y, 2), c(x + 0.4, y, -1), d(x + 0.4, y, 2);
    removed += s_.cut(std::vector<std::array<Vec3, 3>>{{a, b, c}, {b, d, c}});
  }
  std::ptrdiff_t gone() const { return std::ranges::count(s_.backend().destroyed(), 1); }

  void undo() {
    undone_.push_back(acting());
    take(points_.back());
    points_.pop_back();
    travels_ = true;
    s_.undo();
    ++back;
  }
  void redo() {
    points_.push_back(acting());
    take(undone_.back());
    undone_.pop_back();
    travels_ = true;
    s_.redo();
  }
  void save() { marks_.push_back({s_.save(), acting(), points_}); }
  void restore() {
    const Marked& to = marks_[below(static_cast<unsigned>(marks_.size()))];
    travels_ = true;
    s_.restore(to.mark);
    take(to.acting);
    points_ = to.points;
    undone_.clear();
    ++back;
  }

  [[nodiscard]] Acting acting() const { return {run_.driven, run_.pushes, grips_, own_}; }
  void take(const Acting& of) {
    run_.driven = of.driven;
    run_.pushes = of.pushes;
    grips_ = of.grips;
    own_ = of.own;
  }

  LiveRun& run_;
  Simulation& s_;
  std::mt19937 random_;
  std::vector<int> grips_, own_;  // of a host; of the scene
  bool travels_ = false;
  std::vector<Acting> points_, undone_;
  std::vector<Marked> marks_;
};

}  // namespace sunder::test
