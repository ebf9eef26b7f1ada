// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/plain/fibres.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace sunder::plain {
namespace {

using Real6x6 = Eigen::Matrix<Real, 6, 6>;

Real6 strain_voigt(const Real3x3& e) {
  return Real6{e(0, 0), e(1, 1), e(2, 2), 2 * e(0, 1), 2 * e(1, 2), 2 * e(2, 0)};
}
Real3x3 stress_tensor(const Real6& s) {
  Real3x3 of;
  of << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return of;
}

Real6x6 elasticity_along(const Material& m, const sunder::Fibres& f) {
  const Real along = *f.young_along, across = m.young, nu = m.poisson, nu_along = *f.poisson_along;
  Real6x6 compliance = Real6x6::Zero();
  compliance.topLeftCorner<3, 3>() << 1 / along, -nu_along / along, -nu_along / along,  //
      -nu_along / along, 1 / across, -nu / across,                                      //
      -nu_along / along, -nu / across, 1 / across;
  compliance(3, 3) = compliance(5, 5) = 1 / Real(*f.shear_along);
  compliance(4, 4) = 2 * (1 + nu) / across;
  return compliance.inverse();
}

}  // namespace

Fibres::Fibres(const Problem& problem, Index e, const Element& element) {
  const Material& m = problem.material(e);
  linear_ = m.law == MaterialLaw::linear && !m.fibres.empty();
  if (linear_) {
    const Eigen::Matrix<Real, 3, 1> along = problem.fibre_direction(e, 0).cast<Real>().normalized();
    const Eigen::Matrix<Real, 3, 1> across = along.unitOrthogonal();
    axes_ << along, across, along.cross(across);
    d_ = elasticity_along(m, m.fibres.front());
    less_ = element.d;
    return;
  }
  for (std::size_t i = 0; i < m.fibres.size(); ++i) {
    const sunder::Fibres& f = m.fibres[i];
    const Eigen::Matrix<Real, 3, 1> a =
        problem.fibre_direction(e, static_cast<int>(i)).cast<Real>().normalized();
    const Real kappa = f.dispersion;
    const Real3x3 structure = kappa * Real3x3::Identity() + (1 - 3 * kappa) * a * a.transpose();
    families_.push_back({*f.k1, *f.k2, structure});
  }
}

/// E = kappa I1 + (1 - 3 kappa) I4 - 1.
Real Fibres::Family::stretched(const Real3x3& f) const {
  return (f * structure * f.transpose()).trace() - structure.trace();
}

Real3x3 Fibres::linear_stress(const Real3x3& strain) const {
  const Real3x3 own = axes_.transpose() * strain * axes_;
  return axes_ * stress_tensor(d_ * strain_voigt(own)) * axes_.transpose() -
         stress_tensor(less_ * strain_voigt(strain));
}

Real Fibres::energy(const Real3x3& f) const {
  if (linear_) {
    const Real3x3 strain = (f + f.transpose()) / 2 - Real3x3::Identity();
    return linear_stress(strain).cwiseProduct(strain).sum() / 2;
  }
  Real sum = 0;
  for (const Family& of : families_) {
    const Real e = of.stretched(f);
    if (e <= 0) continue;
    sum += of.k2 > 0 ? of.k1 / (2 * of.k2) * std::expm1(of.k2 * e * e) : of.k1 * e * e / 2;
  }
  return sum;
}

Real3x3 Fibres::stress(const Real3x3& f) const {
  if (linear_) return linear_stress((f + f.transpose()) / 2 - Real3x3::Identity());
  Real3x3 p = Real3x3::Zero();
  for (const Family& of : families_) {
    const Real e = of.stretched(f);
    if (e > 0) p += 2 * of.k1 * e * std::exp(of.k2 * e * e) * f * of.structure;
  }
  return p;
}

Real3x3 Fibres::change(const Real3x3& f, const Real3x3& df) const {
  if (linear_) return linear_stress((df + df.transpose()) / 2);
  Real3x3 dp = Real3x3::Zero();
  for (const Family& of : families_) {
    const Real e = of.stretched(f);
    if (e <= 0) continue;
    const Real growth = of.k1 * std::exp(of.k2 * e * e);
    const Real de = 2 * (df * of.structure).cwiseProduct(f).sum();
    dp += 2 * growth * e * df * of.structure +
          2 * growth * (1 + 2 * of.k2 * e * e) * de * f * of.structure;
  }
  return dp;
}

}  // namespace sunder::plain
