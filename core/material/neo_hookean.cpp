// SPDX-License-Identifier: Apache-2.0
#include "material/neo_hookean.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include "material/lanes.hpp"

namespace sunder {
namespace {

double energy(const SmallStrain& law, const Mat3& f) {
  const double j = f.determinant();
  if (!(j > 0)) return std::numeric_limits<double>::infinity();
  const double dilation = std::log(j);
  return law.mu / 2 * (f.squaredNorm() - 3) - law.mu * dilation +
         law.lambda / 2 * dilation * dilation;
}

Mat3 stress(const SmallStrain& law, const Mat3& f) {
  const Mat3 cofactor = f.inverse().transpose();
  return law.mu * f + (law.lambda * std::log(f.determinant()) - law.mu) * cofactor;
}

/// With m = mu - lambda ln J: W_i = mu s_i - m/s_i, hence flips mu + m/(s_i s_j), twists
/// mu - m/(s_i s_j).
SpectralTangent tangent(const SmallStrain& law, const Mat3& f) {
  const SingularValues of = singular_values(f);
  const Vec3 inverse = of.s.cwiseInverse();
  const double m = law.mu - law.lambda * std::log(of.s.prod());
  PrincipalTangent at;
  at.stretch = law.lambda * inverse * inverse.transpose();
  at.stretch.diagonal().array() += law.mu + m * inverse.array().square();
  for (int i = 0; i < 3; ++i) {
    const double share = m * inverse[i] * inverse[(i + 1) % 3];
    at.flip[i] = law.mu + share;
    at.twist[i] = law.mu - share;
  }
  return spectral_tangent(of, at);
}

double shape_energy(const SmallStrain& law, const Mat3& f) {
  const double j = f.determinant();
  if (!(j >= lanes::kLeastVolume)) return std::numeric_limits<double>::infinity();
  const double side = lanes::cube_root(j);
  return law.mu / 2 * (f.squaredNorm() - 3 * side * side);
}

Mat3 shape_stress(const SmallStrain& law, const Mat3& f) {
  const double side = lanes::cube_root(f.determinant());
  return law.mu * (f - side * side * f.inverse().transpose());
}

/// With q = p - mu J^(-1/3) and c = mu/3 J^(-4/3): W_ii = mu + c (J/s_i)^2,
/// W_ij = c J^2/(s_i s_j) + q s_k; flips mu - q s_k, twists mu + q s_k.
SpectralTangent shape_tangent(const SmallStrain& law, const Mat3& f, double pressure) {
  const SingularValues of = singular_values(f);
  const double j = of.s.prod(), side = lanes::cube_root(j), q = pressure - law.mu / side;
  const Vec3 faces(of.s[1] * of.s[2], of.s[2] * of.s[0], of.s[0] * of.s[1]);
  PrincipalTangent at;
  at.stretch = law.mu / (3 * j * side) * faces * faces.transpose();
  at.stretch.diagonal().array() += law.mu;
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const double share = q * of.s[(i + 2) % 3];
    at.stretch(i, k) += share;
    at.stretch(k, i) += share;
    at.flip[i] = law.mu - share;
    at.twist[i] = law.mu + share;
  }
  return spectral_tangent(of, at);
}

double determinant(const Mat3& f) { return f.determinant(); }

Mat3 cofactor(const Mat3& f) {
  Mat3 of;
  of << f.col(1).cross(f.col(2)), f.col(2).cross(f.col(0)), f.col(0).cross(f.col(1));
  return of;
}

/// U' = (lambda ln J + mu (J^(2/3) - 1))/J.
VolumeSplit::Volume volume(const SmallStrain& law, double j) {
  if (!(j >= lanes::kLeastVolume)) return {std::numeric_limits<double>::infinity(), 0, 0};
  const double side = lanes::cube_root(j), face = law.mu * side * side, dilation = lanes::log(j);
  const double pressure = (law.lambda * dilation + (face - law.mu)) / j;
  return {1.5 * (face - law.mu) + dilation * (law.lambda / 2 * dilation - law.mu), pressure,
          (law.lambda + 2.0 / 3 * face) / (j * j) - pressure / j};
}

constexpr VolumeSplit kSplit = split_with_fibres<FibreTheory::finite, shape_energy, shape_stress,
                                                 shape_tangent, determinant, cofactor, volume>();

}  // namespace

constinit const Law kNeoHookean =
    law_with_fibres<FibreTheory::finite, energy, stress, tangent>("neo-hookean", &kSplit);

}  // namespace sunder
