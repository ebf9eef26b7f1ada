// SPDX-License-Identifier: Apache-2.0
#include "material/corotated.hpp"

#include <algorithm>

#include "material/trace_volume.hpp"

namespace sunder {
namespace {

// Least sum of two singular values that a twist is divided by: keeps the ridge's tangent finite.
constexpr double kLeastSum = 1e-8;

double energy(const SmallStrain& law, const Mat3& f) {
  const Vec3 stretch = singular_values(f).s - Vec3::Ones();
  const double trace = stretch.sum();
  return law.mu * stretch.squaredNorm() + law.lambda / 2 * trace * trace;
}

Mat3 law_stress(const SmallStrain& law, const Mat3& f) {
  const SingularValues of = singular_values(f);
  const Mat3 r = of.u * of.v.transpose();
  return 2 * law.mu * (f - r) + law.lambda * (of.s.sum() - 3) * r;
}

/// Of W + p tr S: a twist has (W_i + W_j)/(s_i + s_j) = 2 mu + 2 (lambda tr(S - I) + p - 2 mu) over
/// s_i + s_j.
SpectralTangent tangent_at(const SmallStrain& law, const Mat3& f, double pressure) {
  const SingularValues of = singular_values(f);
  PrincipalTangent at;
  at.stretch = Mat3::Constant(law.lambda);
  at.stretch.diagonal().array() += 2 * law.mu;
  at.flip.setConstant(2 * law.mu);
  const double turning = 2 * (law.lambda * (of.s.sum() - 3) + pressure - 2 * law.mu);
  for (int i = 0; i < 3; ++i) {
    at.twist[i] = 2 * law.mu + turning / std::max(of.s[i] + of.s[(i + 1) % 3], kLeastSum);
  }
  return spectral_tangent(of, at);
}

SpectralTangent tangent(const SmallStrain& law, const Mat3& f) { return tangent_at(law, f, 0); }

double ratio(const Mat3& f) { return singular_values(f).s.sum() - 2; }

Mat3 ratio_slope(const Mat3& f) {
  const SingularValues of = singular_values(f);
  return of.u * of.v.transpose();
}

constexpr VolumeSplit kSplit =
    trace_split<FibreTheory::finite, energy, law_stress, tangent_at, ratio, ratio_slope>();

}  // namespace

constinit const Law kCorotated =
    law_with_fibres<FibreTheory::finite, energy, law_stress, tangent>("corotated", &kSplit);

}  // namespace sunder
