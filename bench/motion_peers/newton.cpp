// SPDX-License-Identifier: Apache-2.0
// Newton's method with a line search and a new factor of the projected tangent with inertia each
// iteration (Teran et al. 2005).
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
    factor_.choose_threads(fill(u), kThreads);
  }

 private:
  linear_algebra::SparseMatrix fill(const std::vector<double>& u) {
    linear_algebra::SparseMatrix k = tangent_.fill(body(), [&](Index e, fem::ElementMatrix& of) {
      of = fem::element_tangent(body(), e, u, fem::Tangent::projected);
    });
    return k;
  }
  bool direction(const solver::FiniteTarget& target, Eigen::VectorXd& du) override {
    linear_algebra::SparseMatrix k = fill(state().u);
    for (Index d = 0; d < k.cols(); ++d) {
      k.valuePtr()[k.outerIndexPtr()[d]] += target.inertia.of(d);  // the diagonal comes first
    }
    for (Index d : board().problem.gripped_dofs()) k.valuePtr()[k.outerIndexPtr()[d]] *= kHeld;
    ++factors_;
    if (!factor_.factor(k)) return false;
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
          "once, OpenBLAS with the number of threads that is quicker) of the projected tangent "
          "with inertia; at most 50 iterations",
          [](const MotionBoard& board, double tolerance) -> std::unique_ptr<MotionPeer> {
            return std::make_unique<MotionNewton>(board, tolerance);
          }};
}

}  // namespace sunder::bench
