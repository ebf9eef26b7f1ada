// SPDX-License-Identifier: Apache-2.0
#include "material/neo_hookean.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>

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

}  // namespace

constinit const Law kNeoHookean{"neo-hookean", energy, stress, tangent};

}  // namespace sunder
