// SPDX-License-Identifier: Apache-2.0
// The inverse anew after every event, dense, as the paper does it.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <stdexcept>

#include "bench/cholmod_data.hpp"
#include "bench/peers/peer.hpp"

extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}

namespace sunder::bench {
namespace {

using Dense = Eigen::MatrixXd;

Dense by_openblas(Dense a) {
  const int n = static_cast<int>(a.rows());
  int info = 0;
  dpotrf_("L", &n, a.data(), &n, &info);
  if (info == 0) dpotri_("L", &n, a.data(), &n, &info);
  if (info != 0) throw std::runtime_error("potrf or potri failed");
  return a;
}

Dense by_llt(Dense a) {
  const Eigen::Index n = a.rows();
  const Eigen::LLT<Eigen::Ref<Dense>> llt(a);
  if (llt.info() != Eigen::Success) throw std::runtime_error("Eigen::LLT failed");
  return llt.solve(Dense::Identity(n, n));
}

Dense by_lu(Dense a) {
  a.triangularView<Eigen::StrictlyUpper>() = a.transpose();
  return Eigen::PartialPivLU<Dense>(std::move(a)).inverse();
}

class DensePeer : public Peer {
 public:
  DensePeer(const TearingBoard& board, Dense (*invert)(Dense))
      : board_(board), invert_(invert), f_(load_vector(board)) {
    prepare({});
    update();
  }
  void prepare(std::span<const Index> elements) override {
    destroyed_.insert(destroyed_.end(), elements.begin(), elements.end());
    k_ = Dense(damaged_stiffness(*board_.problem, destroyed_));
  }
  void update() override { inverse_ = invert_(std::move(k_)); }
  void solve(Eigen::VectorXd& u) override { u = inverse_.selfadjointView<Eigen::Lower>() * f_; }
  std::size_t bytes() const override {
    return sizeof(double) * static_cast<std::size_t>(inverse_.size());
  }

 private:
  const TearingBoard& board_;
  Dense (*invert_)(Dense);
  Eigen::VectorXd f_;
  std::vector<Index> destroyed_;
  Dense k_, inverse_;
};

PeerKind kind(const char* name, const char* settings, Index most_tets, Dense (*invert)(Dense)) {
  return {name, settings, most_tets,
          [=](const TearingBoard& board) { return std::make_unique<DensePeer>(board, invert); }};
}

}  // namespace

std::vector<PeerKind> dense_peers() {
  return {kind("openblas potrf potri",
               "dpotrf and dpotri on the lower triangle, one thread, in place", 8000, by_openblas),
          kind("eigen LLT inverse", "Eigen::LLT in place, solve(Identity), -march as the library",
               2000, by_llt),
          kind("eigen PartialPivLU inverse", "Eigen::PartialPivLU::inverse, -march as the library",
               2000, by_lu)};
}

}  // namespace sunder::bench
