// SPDX-License-Identifier: Apache-2.0
// Quasi-Newton on the constant matrix of projective dynamics (Liu, Bouaziz and Kavan 2017): L-BFGS
// of 5 pairs on A = sum of V w G^T G with w = 2 mu + lambda, the same for each axis, so that its
// factor has a third of the unknowns and three right sides.
#include <utility>

#include "bench/finite_peers/cholmod_factor.hpp"
#include "bench/finite_peers/finite_peer.hpp"
#include "solver/lbfgs.hpp"

namespace sunder::bench {
namespace {

constexpr int kMost = 500, kPairs = 5;

class ProjectiveLbfgs : public FinitePeer {
 public:
  explicit ProjectiveLbfgs(const FiniteSetting& setting)
      : FinitePeer(setting, kMost), hessian_(kPairs) {
    rows_.assign(problem().mesh().nodes.size(), kNone);
    for (Index n = 0; n < problem().node_count(); ++n) {
      if (problem().dof(n, 0) != kNone) rows_[n] = count_++;
    }
    ProjectiveLbfgs::body_changed();
  }

 private:
  /// Weights of what has left go too: the pattern and its analysis stay.
  void body_changed() override {
    std::vector<Eigen::Triplet<double, Index>> entries;
    for (Index e = 0; e < problem().tet_count(); ++e) {
      const auto& law = problem().small_strain(e);
      const double weight =
          body().live(e) ? problem().shape(e).volume * (2 * law.mu + law.lambda) : 0;
      const Eigen::Matrix4d k =
          weight * problem().shape(e).gradient.transpose() * problem().shape(e).gradient;
      const auto& corners = problem().mesh().tets[e];
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 4; ++i) {
          const Index row = rows_[corners[i]], column = rows_[corners[j]];
          if (column != kNone && row >= column) entries.emplace_back(row, column, k(i, j));
        }
      }
    }
    linear_algebra::SparseMatrix lower(count_, count_);
    lower.setFromTriplets(entries.begin(), entries.end());
    for (Index d = 0; d < count_; ++d) {
      if (lower.coeff(d, d) == 0) lower.coeffRef(d, d) = 1;
    }
    factor_.factor(lower);
    ++new_factors_;
  }
  void begin() override {
    hessian_.clear();
    learnt_ = false;
    found_.factors = std::exchange(new_factors_, 0);
  }
  void moved(const Eigen::VectorXd& s, const Eigen::VectorXd& y) override {
    hessian_.learn(s, y);
    learnt_ = true;
  }
  /// What it has learnt may be misleading.
  bool give_way() override {
    hessian_.clear();
    return std::exchange(learnt_, false);
  }
  bool direction(const std::vector<double>&, const Eigen::VectorXd& r, double,
                 Eigen::VectorXd& du) override {
    ++found_.back_solves;
    hessian_.direction(
        r, [&](const Eigen::VectorXd& q, Eigen::VectorXd& x) { solve_each_axis(q, x); }, du);
    return true;
  }
  void solve_each_axis(const Eigen::VectorXd& q, Eigen::VectorXd& x) {
    b_.resize(count_, 3);
    for (Index n = 0; n < problem().node_count(); ++n) {
      if (rows_[n] == kNone) continue;
      for (int axis = 0; axis < 3; ++axis) b_(rows_[n], axis) = q[problem().dof(n, axis)];
    }
    factor_.solve(b_, x_);
    x.resize(q.size());
    for (Index n = 0; n < problem().node_count(); ++n) {
      if (rows_[n] == kNone) continue;
      for (int axis = 0; axis < 3; ++axis) x[problem().dof(n, axis)] = x_(rows_[n], axis);
    }
  }

  std::vector<Index> rows_;  // of each node; kNone: held
  Index count_ = 0;
  CholmodFactor factor_;
  solver::Lbfgs hessian_;
  Eigen::MatrixXd b_, x_;
  int new_factors_ = 0;
  bool learnt_ = false;
};

}  // namespace

FiniteKind projective_lbfgs() {
  return {"projective lbfgs",
          "L-BFGS of 5 pairs with a line search on the constant matrix of projective dynamics "
          "(weights 2 mu + lambda, Liu, Bouaziz and Kavan 2017), factored once by CHOLMOD for one "
          "axis, anew after each event; at most 500 iterations",
          false, [](const FiniteSetting& s) { return std::make_unique<ProjectiveLbfgs>(s); }};
}

}  // namespace sunder::bench
