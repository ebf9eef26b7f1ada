// SPDX-License-Identifier: Apache-2.0
// Newton's method with a line search (Nocedal and Wright 2006, 3.3) and a new factor of the tangent
// each iteration: the exact one, or where it is indefinite the one projected element by element
// (Teran et al. 2005).
#include "bench/finite_peers/cholmod_factor.hpp"
#include "bench/finite_peers/finite_peer.hpp"
#include "bench/finite_peers/tangent_matrix.hpp"

namespace sunder::bench {
namespace {

constexpr int kMost = 50;

class NewtonCholmod : public FinitePeer {
 public:
  explicit NewtonCholmod(const FiniteSetting& setting)
      : FinitePeer(setting, kMost),
        tangent_(problem(), TangentMatrix::Stored::lower, setting.threads) {
    factor_.choose_threads(fill(setting.start.u, fem::Tangent::projected), setting.threads);
  }

 private:
  const linear_algebra::SparseMatrix& fill(const std::vector<double>& u, fem::Tangent kind) {
    return tangent_.fill(body(), [&](Index e, fem::ElementMatrix& k) {
      k = fem::element_tangent(body(), e, u, kind);
    });
  }
  bool factor(const std::vector<double>& u, fem::Tangent kind) {
    ++found_.factors;
    return factor_.factor(fill(u, kind));
  }
  bool direction(const std::vector<double>& u, const Eigen::VectorXd& r, double,
                 Eigen::VectorXd& du) override {
    if (!factor(u, fem::Tangent::exact) && !factor(u, fem::Tangent::projected)) return false;
    ++found_.back_solves;
    factor_.solve(-r, x_);
    du = x_;
    return true;
  }

  TangentMatrix tangent_;
  CholmodFactor factor_;
  Eigen::MatrixXd x_;
};

}  // namespace

FiniteKind newton_cholmod() {
  return {"newton cholmod",
          "Newton with a line search; each iteration a numeric factorisation by CHOLMOD (analysed "
          "once, supernodal or simplicial as it chooses, OpenBLAS with the "
          "number of threads that is quicker) of the exact tangent, or of the "
          "projected one where that is indefinite; at most 50 iterations",
          false, [](const FiniteSetting& s) { return std::make_unique<NewtonCholmod>(s); }};
}

}  // namespace sunder::bench
