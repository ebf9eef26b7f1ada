// SPDX-License-Identifier: Apache-2.0
// Eigen's sparse solvers: a factorisation anew with the analysis kept, and conjugate gradients.
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <stdexcept>

#include "bench/peers/eigen_types.hpp"

namespace sunder::bench {
namespace {

constexpr double kTolerance = 1e-6;  // |r| / |f|

class Ldlt : public MatrixPeer {
 public:
  void set_matrix(const LowerTriangle& lower) override {
    k_ = copy_of(lower);
    if (!analyzed_) factor_.analyzePattern(k_);
    analyzed_ = true;
  }
  void update() override {
    factor_.factorize(k_);
    if (factor_.info() != Eigen::Success) throw std::runtime_error("SimplicialLDLT failed");
  }
  void solve(std::span<const double> f, std::span<double> u) override {
    vector_of(u) = factor_.solve(vector_of(f));
  }
  std::size_t bytes() const override {
    return static_cast<std::size_t>(factor_.matrixL().nestedExpression().nonZeros()) *
           (sizeof(double) + sizeof(int));
  }

 private:
  Lower k_;
  bool analyzed_ = false;
  Eigen::SimplicialLDLT<Lower> factor_;
};

class Jacobi : public MatrixPeer {
 public:
  Jacobi() { cg_.setTolerance(kTolerance); }
  void set_matrix(const LowerTriangle& lower) override {
    k_ = copy_of(lower).selfadjointView<Eigen::Lower>();
  }
  void update() override { cg_.compute(k_); }
  void solve(std::span<const double> f, std::span<double> u) override {
    if (u_.size() == 0) u_.setZero(k_.rows());
    u_ = cg_.solveWithGuess(vector_of(f), u_).eval();
    if (cg_.info() != Eigen::Success) throw std::runtime_error("Jacobi PCG does not converge");
    vector_of(u) = u_;
  }
  std::size_t bytes() const override {
    return static_cast<std::size_t>(k_.nonZeros()) * (sizeof(double) + sizeof(int)) +
           5 * sizeof(double) * static_cast<std::size_t>(k_.rows());
  }

 private:
  using RowMajor = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  Eigen::VectorXd u_;
  RowMajor k_;
  Eigen::ConjugateGradient<RowMajor, Eigen::Lower | Eigen::Upper> cg_;
};

}  // namespace

std::vector<MatrixPeerKind> sparse_peers() {
  return {{"eigen SimplicialLDLT refactor",
           "AMD ordering, analysis kept, the assembled matrix given; -march=native", 35000,
           [] { return std::make_unique<Ldlt>(); }},
          {"Jacobi PCG",
           "Eigen::ConjugateGradient, row-major full matrix (given assembled), from the last "
           "displacement to |r|/|f| = 1e-6; -march=native",
           130000, [] { return std::make_unique<Jacobi>(); }}};
}

}  // namespace sunder::bench
