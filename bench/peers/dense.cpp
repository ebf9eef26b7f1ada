// SPDX-License-Identifier: Apache-2.0
// The inverse anew after every event, dense, as the paper does it.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <stdexcept>

#include "bench/peers/eigen_types.hpp"

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

class DensePeer : public MatrixPeer {
 public:
  explicit DensePeer(Dense (*invert)(Dense)) : invert_(invert) {}
  void set_matrix(const LowerTriangle& lower) override { k_ = Dense(copy_of(lower)); }
  void update() override { inverse_ = invert_(std::move(k_)); }
  void solve(std::span<const double> f, std::span<double> u) override {
    vector_of(u) = inverse_.selfadjointView<Eigen::Lower>() * vector_of(f);
  }
  std::size_t bytes() const override {
    return sizeof(double) * static_cast<std::size_t>(inverse_.size());
  }

 private:
  Dense (*invert_)(Dense);
  Dense k_, inverse_;
};

/// The same from a sparse factor: a solution for every column.
class SparseInverse : public MatrixPeer {
 public:
  void set_matrix(const LowerTriangle& lower) override { k_ = copy_of(lower); }
  void update() override {
    const Eigen::SimplicialLDLT<Lower> factor(k_);
    if (factor.info() != Eigen::Success) throw std::runtime_error("SimplicialLDLT failed");
    inverse_ = factor.solve(Dense::Identity(k_.rows(), k_.rows()));
  }
  void solve(std::span<const double> f, std::span<double> u) override {
    vector_of(u) = inverse_ * vector_of(f);
  }
  std::size_t bytes() const override {
    return sizeof(double) * static_cast<std::size_t>(inverse_.size());
  }

 private:
  Lower k_;
  Dense inverse_;
};

MatrixPeerKind kind(const char* name, const char* settings, int most_tets, Dense (*invert)(Dense)) {
  return {name, settings, most_tets, [=] { return std::make_unique<DensePeer>(invert); }};
}

}  // namespace

std::vector<MatrixPeerKind> dense_peers() {
  return {kind("openblas potrf potri",
               "dpotrf and dpotri on the lower triangle, one thread, in place", 8000, by_openblas),
          kind("eigen LLT inverse", "Eigen::LLT in place, solve(Identity); -march=native", 2000,
               by_llt),
          kind("eigen PartialPivLU inverse", "Eigen::PartialPivLU::inverse; -march=native", 2000,
               by_lu),
          {"eigen SimplicialLDLT inverse", "AMD ordering, solve(Identity); -march=native", 2000,
           [] { return std::make_unique<SparseInverse>(); }}};
}

}  // namespace sunder::bench
