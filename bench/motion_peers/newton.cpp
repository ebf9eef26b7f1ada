// SPDX-License-Identifier: Apache-2.0
// Newton's method with a line search and a new factor of the tangent with inertia each iteration:
// the exact one, or where it is indefinite the one projected element by element (Teran et al.
// 2005).
#include "bench/finite_peers/cholmod_factor.hpp"
#include "bench/finite_peers/tangent_matrix.hpp"
#include "bench/motion_peers/motion_peer.hpp"

namespace sunder::bench {
namespace {

constexpr int kMost = 50, kThreads = 2;
constexpr double kHeld = 1e12;  // of a gripped unknown's diagonal: it stays

class MotionNewton : public MotionPeer {
 public:
  MotionNewton(const MotionBoard& board, double tolerance)
      : MotionPeer(board, tolerance, kMost),
        tangent_(board.problem, TangentMatrix::Stored::lower, kThreads) {
    const std::vector<double> u(board.problem.dofs().size(), 0.0);
    factor_.choose_threads(fill(u, fem::Tangent::exact), kThreads);
  }

 private:
  linear_algebra::SparseMatrix fill(const std::vector<double>& u, fem::Tangent kind) {
    return tangent_.fill(body(), [&](Index e, fem::ElementMatrix& of) {
      of = fem::element_tangent(body(), e, u, kind);
    });
  }
  bool factor(const solver::FiniteTarget& target, fem::Tangent kind) {
    linear_algebra::SparseMatrix k = fill(state().u, kind);
    for (Index d = 0; d < k.cols(); ++d) {
      k.valuePtr()[k.outerIndexPtr()[d]] += target.inertia.of(d);  // the diagonal comes first
    }
    for (Index d : board().problem.gripped_dofs()) k.valuePtr()[k.outerIndexPtr()[d]] *= kHeld;
    ++factors_;
    return factor_.factor(k);
  }
  bool direction(const solver::FiniteTarget& target, Eigen::VectorXd& du) override {
    if (!factor(target, fem::Tangent::exact) && !factor(target, fem::Tangent::projected)) {
      return false;
    }
    factor_.solve(-state().r, x_);
    du = x_;
    return true;
  }

  TangentMatrix tangent_;
  CholmodFactor factor_;
  Eigen::MatrixXd x_;
};

}  // namespace

MotionKind motion_newton() {
  return {"newton cholmod",
          "Newton with a line search; each iteration a numeric factorisation by CHOLMOD (analysed "
          "once, OpenBLAS with the number of threads that is quicker) of the exact tangent with "
          "inertia, or of the projected one where that is indefinite; at most 50 iterations",
          [](const MotionBoard& board, double tolerance) -> std::unique_ptr<MotionPeer> {
            return std::make_unique<MotionNewton>(board, tolerance);
          }};
}

}  // namespace sunder::bench
