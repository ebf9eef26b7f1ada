// SPDX-License-Identifier: Apache-2.0
// Warped stiffness (Mueller and Gross 2004): the elements' small-strain stiffness in frames that
// turn with them, R K R^T, assembled and factored each iteration; what stays of the forces is
// solved with it until they balance. The line search of all peers saves it where the whole step
// would raise the energy.
#include "bench/finite_peers/cholmod_factor.hpp"
#include "bench/finite_peers/finite_peer.hpp"
#include "bench/finite_peers/tangent_matrix.hpp"
#include "body/deformation.hpp"
#include "material/singular_values.hpp"

namespace sunder::bench {
namespace {

constexpr int kMost = 100;

class WarpedStiffness : public FinitePeer {
 public:
  explicit WarpedStiffness(const FiniteSetting& setting)
      : FinitePeer(setting, kMost),
        stiffness_(problem(), TangentMatrix::Stored::lower, setting.threads) {
    for (Index e = 0; e < problem().tet_count(); ++e) {
      intact_.push_back(fem::element_stiffness(problem(), e));
    }
    factor_.choose_threads(fill(setting.start.u), setting.threads);
  }

 private:
  void turned(Index e, const std::vector<double>& u, fem::ElementMatrix& k) const {
    const Mat3 f = Mat3::Identity() + fem::displacement_gradient(problem(), e, u);
    const Mat3 r = polar(f).rotation;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        k.block<3, 3>(3 * a, 3 * b) =
            r * intact_[static_cast<std::size_t>(e)].block<3, 3>(3 * a, 3 * b) * r.transpose();
      }
    }
  }
  const linear_algebra::SparseMatrix& fill(const std::vector<double>& u) {
    return stiffness_.fill(body(), [&](Index e, fem::ElementMatrix& of) { turned(e, u, of); });
  }
  bool direction(const std::vector<double>& u, const Eigen::VectorXd& r, double,
                 Eigen::VectorXd& du) override {
    ++found_.factors;
    ++found_.back_solves;
    if (!factor_.factor(fill(u))) return false;
    factor_.solve(-r, x_);
    du = x_;
    return true;
  }

  TangentMatrix stiffness_;
  std::vector<fem::ElementMatrix> intact_;
  CholmodFactor factor_;
  Eigen::MatrixXd x_;
};

}  // namespace

FiniteKind warped_stiffness() {
  return {"warped stiffness",
          "R K R^T of all elements, assembled and factored by CHOLMOD each iteration (Mueller and "
          "Gross 2004), with a line search; at most 100 iterations; law corotated only",
          true, [](const FiniteSetting& s) { return std::make_unique<WarpedStiffness>(s); }};
}

}  // namespace sunder::bench
