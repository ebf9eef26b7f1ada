// SPDX-License-Identifier: Apache-2.0
// Newton's method with a line search, its equations solved by preconditioned conjugate gradients as
// far as the residual is worth it (Nocedal and Wright 2006, algorithm 7.1): they end where the
// curvature is negative. Preconditioners: the diagonal, and Eigen's incomplete Cholesky factor (Lin
// and More 1999).
#include <Eigen/IterativeLinearSolvers>
#include <cmath>

#include "bench/finite_peers/finite_peer.hpp"
#include "bench/finite_peers/tangent_matrix.hpp"

namespace sunder::bench {
namespace {

constexpr int kMost = 50, kMostInner = 3000;

/// y = A x, A with both triangles: its columns are its rows.
class Product {
 public:
  explicit Product(int threads) : workers_(std::make_unique<Workers>(threads)) {}
  void operator()(const linear_algebra::SparseMatrix& a, const Eigen::VectorXd& x,
                  Eigen::VectorXd& y) {
    y.resize(x.size());
    workers_->run([&](int worker) {
      const Index count = workers_->count(), n = static_cast<Index>(a.cols());
      for (Index c = worker * n / count; c < (worker + 1) * n / count; ++c) {
        double sum = 0;
        for (Index k = a.outerIndexPtr()[c]; k < a.outerIndexPtr()[c + 1]; ++k) {
          sum += a.valuePtr()[k] * x[a.innerIndexPtr()[k]];
        }
        y[c] = sum;
      }
    });
  }

 private:
  std::unique_ptr<Workers> workers_;
};

template <class Preconditioner>
class NewtonPcg : public FinitePeer {
 public:
  explicit NewtonPcg(const FiniteSetting& setting)
      : FinitePeer(setting, kMost),
        tangent_(problem(), TangentMatrix::Stored::both, setting.threads),
        product_(setting.threads) {
    preconditioner_.analyzePattern(tangent_.matrix());
  }

 private:
  bool direction(const std::vector<double>& u, const Eigen::VectorXd& r, double residual,
                 Eigen::VectorXd& du) override {
    const auto& a = tangent_.fill(body(), [&](Index e, fem::ElementMatrix& k) {
      k = fem::element_tangent(body(), e, u, fem::Tangent::exact);
    });
    ++found_.factors;
    preconditioner_.factorize(a);
    if (preconditioner_.info() != Eigen::Success) return false;
    // Superlinear, but not beyond what the step needs.
    const double forcing =
        std::max(std::min(0.5, std::sqrt(residual)), 0.5 * tolerance() / residual);
    gradients(a, r, forcing * r.norm(), du);
    return true;
  }
  void gradients(const linear_algebra::SparseMatrix& a, const Eigen::VectorXd& r, double end,
                 Eigen::VectorXd& du) {
    left_ = -r;
    du.setZero(r.size());
    z_ = preconditioner_.solve(left_);
    p_ = z_;
    double rz = left_.dot(z_);
    for (int i = 0; i < kMostInner; ++i) {
      ++found_.back_solves;
      product_(a, p_, ap_);
      const double curvature = p_.dot(ap_);
      if (!(curvature > 0)) {
        if (i == 0) du = p_;
        return;
      }
      const double length = rz / curvature;
      du += length * p_;
      left_ -= length * ap_;
      if (left_.norm() <= end) return;
      z_ = preconditioner_.solve(left_);
      const double next = left_.dot(z_);
      p_ = z_ + (next / rz) * p_;
      rz = next;
    }
  }

  TangentMatrix tangent_;
  Product product_;
  Preconditioner preconditioner_;
  Eigen::VectorXd left_, z_, p_, ap_;
};

template <class Preconditioner>
FiniteKind kind(const std::string& name, const std::string& by) {
  return {name,
          "Newton with a line search; each iteration the exact tangent's equations by conjugate "
          "gradients, preconditioned by " +
              by +
              ", to min(.5, sqrt(residual)), ended at negative "
              "curvature; at most 50 iterations of at most 3,000",
          false,
          [](const FiniteSetting& s) { return std::make_unique<NewtonPcg<Preconditioner>>(s); }};
}

}  // namespace

FiniteKind newton_jacobi() {
  return kind<Eigen::DiagonalPreconditioner<double>>("newton pcg jacobi", "its diagonal");
}
FiniteKind newton_incomplete() {
  return kind<Eigen::IncompleteCholesky<double>>(
      "newton pcg ichol", "Eigen's incomplete Cholesky factor (AMD order, made each iteration)");
}

}  // namespace sunder::bench
