// SPDX-License-Identifier: Apache-2.0
// The inverse of a Hessian by a base and the last few steps (Nocedal 1980, two loops).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sunder::solver {

/// Keeps its vectors from one minimisation to the next.
class Lbfgs {
 public:
  explicit Lbfgs(int pairs) : pairs_(static_cast<std::size_t>(pairs)), a_(pairs_.size()) {}

  /// Forgets all pairs: those of another base or another function tell nothing.
  void clear() { begin_ = count_ = 0; }
  /// du = -H r. `base(q, du)` writes what the base makes of q, positive definite.
  template <class Base>
  void direction(const Eigen::VectorXd& r, Base&& base, Eigen::VectorXd& du) {
    q_ = -r;
    for (std::size_t i = count_; i-- > 0;) {
      const Pair& p = pair(i);
      a_[i] = p.s.dot(q_) / p.sy;
      q_ -= a_[i] * p.y;
    }
    base(q_, du);
    for (std::size_t i = 0; i < count_; ++i) {
      const Pair& p = pair(i);
      du += (a_[i] - p.y.dot(du) / p.sy) * p.s;
    }
  }
  /// Of a step s the gradient's change y. A pair without curvature would make the Hessian
  /// indefinite: it is left out.
  void learn(const Eigen::VectorXd& s, const Eigen::VectorXd& y);

 private:
  struct Pair {
    Eigen::VectorXd s, y;
    double sy = 0;
  };
  [[nodiscard]] Pair& pair(std::size_t i) { return pairs_[(begin_ + i) % pairs_.size()]; }

  std::vector<Pair> pairs_;  // a ring
  std::vector<double> a_;
  std::size_t begin_ = 0, count_ = 0;
  Eigen::VectorXd q_;
};

}  // namespace sunder::solver
