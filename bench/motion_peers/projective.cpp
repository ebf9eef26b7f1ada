// SPDX-License-Identifier: Apache-2.0
// Quasi-Newton on the constant matrix of projective dynamics with inertia (Liu, Bouaziz and Kavan
// 2017): L-BFGS of 5 pairs, a factor for one axis, anew after ruptures and where the scheme
// changes.
#include "bench/finite_peers/cholmod_factor.hpp"
#include "bench/motion_peers/motion_peer.hpp"
#include "solver/lbfgs.hpp"

namespace sunder::bench {
namespace {

constexpr int kMost = 500, kPairs = 5;

class MotionProjective : public MotionPeer {
 public:
  MotionProjective(const MotionBoard& board, double tolerance)
      : MotionPeer(board, tolerance, kMost), hessian_(kPairs) {
    const Problem& problem = board.problem;
    rows_.assign(problem.mesh().nodes.size(), kNone);
    for (Index n = 0; n < problem.node_count(); ++n) {
      const bool gripped = std::ranges::binary_search(problem.gripped_dofs(), problem.dof(n, 0));
      if (problem.dof(n, 0) != kNone && !gripped) rows_[n] = count_++;
    }
  }

 private:
  void factor(double inertia) {
    const Problem& problem = board().problem;
    std::vector<Eigen::Triplet<double, Index>> entries;
    for (Index n = 0; n < problem.node_count(); ++n) {
      if (rows_[n] != kNone) {
        entries.emplace_back(rows_[n], rows_[n], inertia * board().node_mass[n]);
      }
    }
    for (Index e = 0; e < problem.tet_count(); ++e) {
      const auto& law = problem.small_strain(e);
      const double weight =
          body().live(e) ? problem.shape(e).volume * (2 * law.mu + law.lambda) : 0;
      const Eigen::Matrix4d k =
          weight * problem.shape(e).gradient.transpose() * problem.shape(e).gradient;
      const auto& corners = problem.mesh().tets[e];
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 4; ++i) {
          const Index row = rows_[corners[i]], column = rows_[corners[j]];
          if (column != kNone && row >= column) entries.emplace_back(row, column, k(i, j));
        }
      }
    }
    linear_algebra::SparseMatrix lower(count_, count_);
    lower.setFromTriplets(entries.begin(), entries.end());
    factor_.factor(lower);
    inertia_ = inertia;
    ++factors_;
  }
  void body_changed() override { inertia_ = 0; }
  void begin() override { hessian_.clear(); }
  void moved(const Eigen::VectorXd& s, const Eigen::VectorXd& y) override { hessian_.learn(s, y); }
  bool direction(const solver::FiniteTarget& target, Eigen::VectorXd& du) override {
    if (inertia_ != target.inertia.factor) factor(target.inertia.factor);
    const Problem& problem = board().problem;
    hessian_.direction(
        state().r,
        [&](const Eigen::VectorXd& q, Eigen::VectorXd& x) {
          b_.setZero(count_, 3);
          for (Index n = 0; n < problem.node_count(); ++n) {
            if (rows_[n] == kNone) continue;
            for (int axis = 0; axis < 3; ++axis) b_(rows_[n], axis) = q[problem.dof(n, axis)];
          }
          factor_.solve(b_, x_);
          x.setZero(q.size());
          for (Index n = 0; n < problem.node_count(); ++n) {
            if (rows_[n] == kNone) continue;
            for (int axis = 0; axis < 3; ++axis) x[problem.dof(n, axis)] = x_(rows_[n], axis);
          }
        },
        du);
    return true;
  }

  std::vector<Index> rows_;  // of each node; kNone: held
  Index count_ = 0;
  double inertia_ = 0;  // of the factor; 0: none
  CholmodFactor factor_;
  solver::Lbfgs hessian_;
  Eigen::MatrixXd b_, x_;
};

}  // namespace

MotionKind motion_projective() {
  return {"projective lbfgs",
          "L-BFGS of 5 pairs with a line search on the constant matrix of projective dynamics with "
          "inertia (weights 2 mu + lambda, Liu, Bouaziz and Kavan 2017), factored by CHOLMOD for "
          "one axis, anew after ruptures; at most 500 iterations",
          [](const MotionBoard& board, double tolerance) -> std::unique_ptr<MotionPeer> {
            return std::make_unique<MotionProjective>(board, tolerance);
          }};
}

}  // namespace sunder::bench
