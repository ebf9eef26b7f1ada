// SPDX-License-Identifier: Apache-2.0
#include "material/saint_venant_kirchhoff.hpp"

#include "material/trace_volume.hpp"

namespace sunder {
namespace {

Mat3 green_lagrange(const Mat3& f) { return (f.transpose() * f - Mat3::Identity()) / 2; }

double energy(const SmallStrain& law, const Mat3& f) {
  const Mat3 strain = green_lagrange(f);
  const double trace = strain.trace();
  return law.mu * strain.squaredNorm() + law.lambda / 2 * trace * trace;
}

Mat3 law_stress(const SmallStrain& law, const Mat3& f) {
  const Mat3 strain = green_lagrange(f);
  return f * (2 * law.mu * strain + law.lambda * strain.trace() * Mat3::Identity());
}

/// Of W + p tr E: W_i = s_i (mu (s_i^2 - 1) + lambda t + p), t = tr E: flips
/// mu (s_i^2 + s_i s_j + s_j^2 - 1) + lambda t + p, twists with - s_i s_j.
SpectralTangent tangent_at(const SmallStrain& law, const Mat3& f, double pressure) {
  const SingularValues of = singular_values(f);
  const Eigen::Array3d square = of.s.array().square();
  const double even = law.lambda * (square.sum() - 3) / 2 + pressure - law.mu;
  PrincipalTangent at;
  at.stretch = law.lambda * of.s * of.s.transpose();
  at.stretch.diagonal().array() += even + 3 * law.mu * square;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double both = square[i] + square[j], product = of.s[i] * of.s[j];
    at.flip[i] = even + law.mu * (both + product);
    at.twist[i] = even + law.mu * (both - product);
  }
  return spectral_tangent(of, at);
}

SpectralTangent tangent(const SmallStrain& law, const Mat3& f) { return tangent_at(law, f, 0); }

double ratio(const Mat3& f) { return green_lagrange(f).trace() + 1; }
Mat3 ratio_slope(const Mat3& f) { return f; }

constexpr VolumeSplit kSplit =
    trace_split<FibreTheory::finite, energy, law_stress, tangent_at, ratio, ratio_slope>();

}  // namespace

constinit const Law kSaintVenantKirchhoff =
    law_with_fibres<FibreTheory::finite, energy, law_stress, tangent>("saint-venant-kirchhoff",
                                                                      &kSplit);

}  // namespace sunder
