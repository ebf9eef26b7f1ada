// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "cpu_reference/plain/finite.hpp"

namespace sunder::plain {
namespace {

using D = Law::D;
using Real3 = Eigen::Matrix<Real, 3, 1>;
const Real3x3 kOne = Real3x3::Identity();

Real3x3 hooke(const D& d, const Real3x3& e) { return 2 * d(3, 3) * e + d(0, 1) * e.trace() * kOne; }
Real half_product(const Real3x3& a, const Real3x3& b) { return a.cwiseProduct(b).sum() / 2; }

Real3x3 infinitesimal(const Real3x3& f) { return (f + f.transpose()) / 2 - kOne; }
Real linear_energy(const D& d, const Real3x3& f) {
  return half_product(hooke(d, infinitesimal(f)), infinitesimal(f));
}
Real3x3 linear_stress(const D& d, const Real3x3& f) { return hooke(d, infinitesimal(f)); }
Real3x3 linear_change(const D& d, const Real3x3&, const Real3x3& df) {
  return hooke(d, (df + df.transpose()) / 2);
}

Real corotated_energy(const D& d, const Real3x3& f) {
  const Real3x3 e = rotation(f).transpose() * f - kOne;
  return half_product(hooke(d, e), e);
}
Real3x3 corotated_stress(const D& d, const Real3x3& f) {
  const Real3x3 r = rotation(f);
  return r * hooke(d, r.transpose() * f - kOne);
}
/// dR = R [w], with (tr S - S) w the axial vector of R^T dF - dF^T R.
Real3x3 corotated_change(const D& d, const Real3x3& f, const Real3x3& df) {
  const Real3x3 r = rotation(f), s = r.transpose() * f, a = r.transpose() * df;
  const Real3 axial(a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1));
  const Real3 w = (s.trace() * kOne - s).inverse() * axial;
  Real3x3 turn;
  turn << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return r * (turn * hooke(d, s - kOne) + hooke(d, a - turn * s));
}

Real neo_hookean_energy(const D& d, const Real3x3& f) {
  const Real j = f.determinant(), ln = std::log(j);
  return j > 0 ? d(3, 3) * ((f.squaredNorm() - 3) / 2 - ln) + d(0, 1) / 2 * ln * ln : INFINITY;
}
Real3x3 neo_hookean_stress(const D& d, const Real3x3& f) {
  return d(3, 3) * f + (d(0, 1) * std::log(f.determinant()) - d(3, 3)) * f.inverse().transpose();
}
Real3x3 neo_hookean_change(const D& d, const Real3x3& f, const Real3x3& df) {
  const Real3x3 g = f.inverse().transpose();
  return d(3, 3) * df + d(0, 1) * g.cwiseProduct(df).sum() * g -
         (d(0, 1) * std::log(f.determinant()) - d(3, 3)) * g * df.transpose() * g;
}

Real3x3 green(const Real3x3& f) { return (f.transpose() * f - kOne) / 2; }
Real svk_energy(const D& d, const Real3x3& f) { return half_product(hooke(d, green(f)), green(f)); }
Real3x3 svk_stress(const D& d, const Real3x3& f) { return f * hooke(d, green(f)); }
Real3x3 svk_change(const D& d, const Real3x3& f, const Real3x3& df) {
  return df * hooke(d, green(f)) + f * hooke(d, (f.transpose() * df + df.transpose() * f) / 2);
}

}  // namespace

Real3x3 rotation(const Real3x3& f) {
  const Eigen::JacobiSVD<Real3x3> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Real sign = svd.matrixU().determinant() * svd.matrixV().determinant();
  return svd.matrixU() * Real3(1, 1, sign < 0 ? -1 : 1).asDiagonal() * svd.matrixV().transpose();
}

constinit const Law kLinear{linear_energy, linear_stress, linear_change};
constinit const Law kCorotated{corotated_energy, corotated_stress, corotated_change};
constinit const Law kNeoHookean{neo_hookean_energy, neo_hookean_stress, neo_hookean_change};
constinit const Law kSaintVenantKirchhoff{svk_energy, svk_stress, svk_change};

}  // namespace sunder::plain
