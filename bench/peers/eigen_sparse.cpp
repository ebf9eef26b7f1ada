// SPDX-License-Identifier: Apache-2.0
// Eigen's sparse solvers: a factorisation anew with the analysis kept, and conjugate gradients.
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <stdexcept>

#include "bench/cholmod_data.hpp"
#include "bench/peers/peer.hpp"

namespace sunder::bench {
namespace {

constexpr double kTolerance = 1e-6;  // |r| / |f|

class Ldlt : public Peer {
 public:
  explicit Ldlt(const TearingBoard& board) : board_(board), f_(load_vector(board)) {
    prepare({});
    factor_.analyzePattern(k_);
    update();
  }
  void prepare(std::span<const Index> elements) override {
    destroyed_.insert(destroyed_.end(), elements.begin(), elements.end());
    k_ = damaged_stiffness(*board_.problem, destroyed_);
  }
  void update() override {
    factor_.factorize(k_);
    if (factor_.info() != Eigen::Success) throw std::runtime_error("SimplicialLDLT failed");
  }
  void solve(Eigen::VectorXd& u) override { u = factor_.solve(f_); }
  std::size_t bytes() const override {
    return static_cast<std::size_t>(factor_.matrixL().nestedExpression().nonZeros()) *
           (sizeof(double) + sizeof(Index));
  }

 private:
  const TearingBoard& board_;
  Eigen::VectorXd f_;
  std::vector<Index> destroyed_;
  fem::SparseMatrix k_;
  Eigen::SimplicialLDLT<fem::SparseMatrix> factor_;
};

class Jacobi : public Peer {
 public:
  explicit Jacobi(const TearingBoard& board) : board_(board), f_(load_vector(board)) {
    cg_.setTolerance(kTolerance);
    prepare({});
    update();
    u_ = cg_.solve(f_);
  }
  void prepare(std::span<const Index> elements) override {
    destroyed_.insert(destroyed_.end(), elements.begin(), elements.end());
    k_ = damaged_stiffness(*board_.problem, destroyed_).selfadjointView<Eigen::Lower>();
  }
  void update() override { cg_.compute(k_); }
  void solve(Eigen::VectorXd& u) override {
    u_ = cg_.solveWithGuess(f_, u_);
    if (cg_.info() != Eigen::Success) throw std::runtime_error("Jacobi PCG does not converge");
    u = u_;
  }
  std::size_t bytes() const override {
    return static_cast<std::size_t>(k_.nonZeros()) * (sizeof(double) + sizeof(Index)) +
           5 * sizeof(double) * static_cast<std::size_t>(f_.size());
  }

 private:
  using RowMajor = Eigen::SparseMatrix<double, Eigen::RowMajor, Index>;
  const TearingBoard& board_;
  Eigen::VectorXd f_, u_;
  std::vector<Index> destroyed_;
  RowMajor k_;
  Eigen::ConjugateGradient<RowMajor, Eigen::Lower | Eigen::Upper> cg_;
};

}  // namespace

std::vector<PeerKind> eigen_peers() {
  return {
      {"eigen SimplicialLDLT refactor", "AMD ordering, analysis kept, the assembled matrix given",
       35000, [](const TearingBoard& b) { return std::make_unique<Ldlt>(b); }},
      {"Jacobi PCG",
       "Eigen::ConjugateGradient, row-major full matrix (given assembled), from the last "
       "displacement to |r|/|f| = 1e-6",
       130000, [](const TearingBoard& b) { return std::make_unique<Jacobi>(b); }}};
}

}  // namespace sunder::bench
