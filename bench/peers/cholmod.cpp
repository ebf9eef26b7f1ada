// SPDX-License-Identifier: Apache-2.0
// SuiteSparse: refactorisation, low-rank modification (Davis and Hager 2009), and conjugate
// gradients preconditioned by the factor of the intact body.
#include <stdexcept>

#include "bench/cholmod_data.hpp"
#include "bench/peers/peer.hpp"

namespace sunder::bench {
namespace {

/// Factor of the intact body and the load; memory is CHOLMOD's own count.
class CholmodPeer : public Peer {
 public:
  CholmodPeer(const TearingBoard& board, int supernodal) : board_(board) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.supernodal = supernodal;
    assemble({});
    l_ = cholmod_analyze(a_, &common_);
    cholmod_factorize(a_, l_, &common_);
    b_ = cholmod_zeros(a_->nrow, 1, CHOLMOD_REAL, &common_);
    Eigen::Map<Eigen::VectorXd>(values(b_), static_cast<Eigen::Index>(b_->nrow)) =
        load_vector(board);
    require();
  }
  ~CholmodPeer() override {
    for (cholmod_dense** d : {&b_, &u_, &y_, &e_}) cholmod_free_dense(d, &common_);
    cholmod_free_factor(&l_, &common_);
    cholmod_free_sparse(&a_, &common_);
    cholmod_finish(&common_);
  }
  CholmodPeer(const CholmodPeer&) = delete;
  CholmodPeer& operator=(const CholmodPeer&) = delete;

  std::size_t bytes() const override { return common_.memory_inuse; }

 protected:
  static double* values(cholmod_dense* d) { return static_cast<double*>(d->x); }
  static Eigen::VectorXd vector(cholmod_dense* d) {
    return Eigen::Map<Eigen::VectorXd>(values(d), static_cast<Eigen::Index>(d->nrow));
  }
  void require() const {
    if (common_.status != CHOLMOD_OK) throw std::runtime_error("CHOLMOD failed");
  }
  void destroy(std::span<const Index> elements) {
    destroyed_.insert(destroyed_.end(), elements.begin(), elements.end());
  }
  void assemble(std::span<const Index> destroyed) {
    cholmod_free_sparse(&a_, &common_);
    a_ = to_cholmod(damaged_stiffness(*board_.problem, destroyed), -1, common_);
  }
  /// u_ = A^-1 rhs; work space is kept.
  void back_substitute(int system, cholmod_dense* rhs) {
    cholmod_solve2(system, l_, rhs, nullptr, &u_, nullptr, &y_, &e_, &common_);
    require();
  }

  const TearingBoard& board_;
  cholmod_common common_{};
  cholmod_sparse* a_ = nullptr;
  cholmod_factor* l_ = nullptr;
  cholmod_dense *b_ = nullptr, *u_ = nullptr, *y_ = nullptr, *e_ = nullptr;
  std::vector<Index> destroyed_;
};

class Refactor : public CholmodPeer {
 public:
  using CholmodPeer::CholmodPeer;
  void prepare(std::span<const Index> elements) override {
    destroy(elements);
    assemble(destroyed_);
  }
  void update() override {
    cholmod_factorize(a_, l_, &common_);
    require();
  }
  void solve(std::span<double> u) override {
    back_substitute(CHOLMOD_A, b_);
    copy(vector(u_), u);
  }
};

class Updown : public CholmodPeer {
 public:
  Updown(const TearingBoard& board, bool with_solve)
      : CholmodPeer(board, CHOLMOD_AUTO), with_solve_(with_solve) {
    // Low-rank modification wants LDL^T by columns.
    cholmod_change_factor(CHOLMOD_REAL, 0, 0, 0, 1, l_, &common_);
    cholmod_dense* permuted = cholmod_solve(CHOLMOD_P, l_, b_, &common_);
    forward_ = cholmod_solve(CHOLMOD_L, l_, permuted, &common_);
    cholmod_free_dense(&permuted, &common_);
    unchanged_ = cholmod_zeros(a_->nrow, 1, CHOLMOD_REAL, &common_);
  }
  ~Updown() override {
    cholmod_free_sparse(&c_, &common_);
    for (cholmod_dense** d : {&forward_, &unchanged_, &permuted_}) {
      cholmod_free_dense(d, &common_);
    }
  }
  void prepare(std::span<const Index> elements) override {
    cholmod_free_sparse(&c_, &common_);
    c_ = to_cholmod(update_columns(*board_.problem, elements, order_of(*l_)), 0, common_);
  }
  void update() override {
    if (with_solve_) {
      cholmod_updown_solve(0, c_, l_, forward_, unchanged_, &common_);
    } else {
      cholmod_updown(0, c_, l_, &common_);
    }
    require();
  }
  void solve(std::span<double> u) override {
    if (!with_solve_) {
      back_substitute(CHOLMOD_A, b_);
      copy(vector(u_), u);
      return;
    }
    back_substitute(CHOLMOD_DLt, forward_);
    cholmod_free_dense(&permuted_, &common_);
    permuted_ = cholmod_solve(CHOLMOD_Pt, l_, u_, &common_);
    copy(vector(permuted_), u);
  }

 private:
  bool with_solve_;
  cholmod_sparse* c_ = nullptr;
  cholmod_dense *forward_ = nullptr, *unchanged_ = nullptr, *permuted_ = nullptr;
};

/// Conjugate gradients on the damaged matrix, from the last displacement to |r|/|f| = 1e-6.
class StaleFactor : public CholmodPeer {
 public:
  explicit StaleFactor(const TearingBoard& board)
      : CholmodPeer(board, CHOLMOD_AUTO), f_(load_vector(board)) {
    prepare({});
    back_substitute(CHOLMOD_A, b_);
    x_ = vector(u_);
    rhs_ = cholmod_copy_dense(b_, &common_);
  }
  ~StaleFactor() override { cholmod_free_dense(&rhs_, &common_); }
  void prepare(std::span<const Index> elements) override {
    destroy(elements);
    k_ = damaged_stiffness(*board_.problem, destroyed_).selfadjointView<Eigen::Lower>();
  }
  void update() override {}
  void solve(std::span<double> u) override {
    Eigen::VectorXd r = f_ - k_ * x_, z = precondition(r), p = z;
    double rz = r.dot(z);
    for (int i = 0; !(r.norm() <= 1e-6 * f_.norm()); ++i) {
      if (i == 2000) throw std::runtime_error("stale-factor PCG does not converge");
      const Eigen::VectorXd q = k_ * p;
      const double step = rz / p.dot(q);
      x_ += step * p;
      r -= step * q;
      z = precondition(r);
      const double next = r.dot(z);
      p = z + next / rz * p;
      rz = next;
    }
    copy(x_, u);
  }

 private:
  Eigen::VectorXd precondition(const Eigen::VectorXd& r) {
    Eigen::Map<Eigen::VectorXd>(values(rhs_), r.size()) = r;
    back_substitute(CHOLMOD_A, rhs_);
    return vector(u_);
  }

  Eigen::SparseMatrix<double, Eigen::RowMajor, Index> k_;
  Eigen::VectorXd f_, x_;
  cholmod_dense* rhs_ = nullptr;
};

template <class P, class Setting>
std::function<std::unique_ptr<Peer>(const TearingBoard&)> creator(Setting setting) {
  return [=](const TearingBoard& board) { return std::make_unique<P>(board, setting); };
}

}  // namespace

std::vector<PeerKind> cholmod_peers() {
  constexpr Index kMost = 130000;
  return {{"cholmod simplicial refactor",
           "cholmod_factorize, CHOLMOD_SIMPLICIAL; ordering: AMD, or METIS where AMD fills much "
           "(its default); the assembled matrix given",
           kMost, creator<Refactor>(int{CHOLMOD_SIMPLICIAL})},
          {"cholmod supernodal refactor",
           "cholmod_factorize, CHOLMOD_SUPERNODAL with OpenBLAS, one thread; ordering and matrix "
           "as above",
           kMost, creator<Refactor>(int{CHOLMOD_SUPERNODAL})},
          {"cholmod updown",
           "cholmod_updown on LDL^T by columns, update vectors given permuted, then cholmod_solve2",
           kMost, creator<Updown>(false)},
          {"cholmod updown_solve",
           "cholmod_updown_solve carries L x = P b along; then only the backward half; good for an "
           "unchanged load only",
           kMost, creator<Updown>(true)},
          {"stale-factor PCG",
           "conjugate gradients preconditioned by CHOLMOD's factor of the intact body, from the "
           "last displacement to |r|/|f| = 1e-6; the assembled matrix given",
           kMost, [](const TearingBoard& board) { return std::make_unique<StaleFactor>(board); }}};
}

}  // namespace sunder::bench
