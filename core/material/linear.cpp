// SPDX-License-Identifier: Apache-2.0
#include "material/linear.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "material/trace_volume.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder {
namespace {

Mat3 strain(const Mat3& f) { return (f + f.transpose()) / 2 - Mat3::Identity(); }

double law_energy(const SmallStrain& law, const Mat3& f) {
  const Mat3 e = strain(f);
  const double trace = e.trace();
  return law.mu * e.squaredNorm() + law.lambda / 2 * trace * trace;
}

Mat3 law_stress(const SmallStrain& law, const Mat3& f) {
  return tensor(stress(law, f - Mat3::Identity()));
}

/// Flips are shear strains, twists are rotations, which meet nothing.
SpectralTangent law_tangent(const SmallStrain& law, const Mat3&) {
  PrincipalTangent at;
  at.stretch = Mat3::Constant(law.lambda);
  at.stretch.diagonal().array() += 2 * law.mu;
  at.flip.setConstant(2 * law.mu);
  at.twist.setZero();
  return spectral_tangent({Mat3::Identity(), Vec3::Ones(), Mat3::Identity()}, at);
}

SpectralTangent tangent_at(const SmallStrain& law, const Mat3& f, double) {
  return law_tangent(law, f);
}

double ratio(const Mat3& f) { return strain(f).trace() + 1; }
Mat3 ratio_slope(const Mat3&) { return Mat3::Identity(); }

constexpr VolumeSplit kSplit =
    trace_split<FibreTheory::linear, law_energy, law_stress, tangent_at, ratio, ratio_slope>();

}  // namespace

constinit const Law kLinear =
    law_with_fibres<FibreTheory::linear, law_energy, law_stress, law_tangent>("linear", &kSplit);

SmallStrain small_strain(const Material& material) {
  const double e = material.young, nu = material.poisson;
  return {.young = e,
          .poisson = nu,
          .lambda = e * nu / ((1 + nu) * (1 - 2 * nu)),
          .mu = e / (2 * (1 + nu)),
          .triple_bulk = e / (1 - 2 * nu),
          .double_shear = e / (1 + nu)};
}

Matrix6 elasticity(const SmallStrain& law) {
  Matrix6 d = Matrix6::Zero();
  d.topLeftCorner<3, 3>().setConstant(law.lambda);
  d.diagonal().head<3>().array() += 2 * law.mu;
  d.diagonal().tail<3>().setConstant(law.mu);
  return d;
}

SmallStrain without_pressure(const SmallStrain& law) {
  SmallStrain deviatoric = law;
  deviatoric.lambda = -law.double_shear / 3;
  deviatoric.triple_bulk = 0;
  return deviatoric;
}

Matrix6 elasticity_factor(const SmallStrain& law) {
  if (law.triple_bulk != 0 || !(law.lambda < 0)) return elasticity(law).llt().matrixL();
  Matrix6 l = Matrix6::Zero();
  l.col(0).head<3>() = std::sqrt(law.mu) * Vec3(1, -1, 0);
  l.col(1).head<3>() = std::sqrt(law.mu / 3) * Vec3(1, 1, -2);
  l.diagonal().tail<3>().setConstant(std::sqrt(law.mu));
  return l;
}

}  // namespace sunder
