// SPDX-License-Identifier: Apache-2.0
#include "solver/lbfgs.hpp"

namespace sunder::solver {

void Lbfgs::learn(const Eigen::VectorXd& s, const Eigen::VectorXd& y) {
  const double sy = s.dot(y);
  if (pairs_.empty() || !(sy > 1e-12 * s.norm() * y.norm())) return;
  if (count_ == pairs_.size()) {
    begin_ = (begin_ + 1) % pairs_.size();
    --count_;
  }
  Pair& p = pair(count_++);
  p.s = s;
  p.y = y;
  p.sy = sy;
}

}  // namespace sunder::solver
