// SPDX-License-Identifier: Apache-2.0
#include "material/fibres.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace sunder {
namespace {

// Of k2 E^2: exp(100) k1 is past any strength, and its square is still a number.
constexpr double kLargestExponent = 100;

Mat3 structure(const FibreFamily& of) {
  return of.dispersion * Mat3::Identity() +
         (1 - 3 * of.dispersion) * of.direction * of.direction.transpose();
}

/// E, and W's first and second derivative by it; 0 under compression.
struct Stretched {
  double e = 0, first = 0, second = 0;
};
Stretched stretched(const FibreFamily& of, const Mat3& f) {
  // From the strain, so that rounding at rest is that of the strain.
  const Mat3 h = f - Mat3::Identity();
  const Mat3 twice_strain = h + h.transpose() + h.transpose() * h;  // C - I
  Stretched at;
  at.e = of.dispersion * twice_strain.trace() +
         (1 - 3 * of.dispersion) * of.direction.dot(twice_strain * of.direction);
  if (!(at.e > 0)) return {};
  const double exponent = of.k2 * at.e * at.e, growth = of.k1 * std::exp(exponent);
  at.first = growth * at.e;
  at.second = growth * (1 + 2 * exponent);
  return at;
}

Vector9 as_column(const Mat3& m) { return Eigen::Map<const Vector9>(m.data()); }

/// P of the linear theory by the strain e.
Mat3 linear_stress(const ElementFibres& fibres, const Mat3& e) {
  const AlongFibres& of = fibres.linear;
  const Vec3& a = fibres.family[0].direction;
  const Vec3 ea = e * a;
  const double along = a.dot(ea), trace = e.trace();
  Mat3 s = (of.lambda * trace + of.alpha * along) * Mat3::Identity();
  s += (of.alpha * trace + of.beta * along) * a * a.transpose();
  s += 2 * of.mu * (a * ea.transpose() + ea * a.transpose());
  return s;
}

Mat3 small_strain_of(const Mat3& f) { return (f + f.transpose()) / 2 - Mat3::Identity(); }

}  // namespace

template <>
double fibre_energy<FibreTheory::finite>(const ElementFibres& fibres, const Mat3& f) {
  double sum = 0;
  for (int i = 0; i < fibres.count; ++i) {
    const FibreFamily& of = fibres.family[static_cast<std::size_t>(i)];
    const double e = stretched(of, f).e, exponent = of.k2 * e * e;
    if (!(exponent <= kLargestExponent)) return std::numeric_limits<double>::infinity();
    const double growth = exponent > 0 ? std::expm1(exponent) / exponent : 1;  // k2 = 0: 1
    sum += of.k1 / 2 * e * e * growth;
  }
  return sum;
}

template <>
Mat3 fibre_stress<FibreTheory::finite>(const ElementFibres& fibres, const Mat3& f) {
  Mat3 p = Mat3::Zero();
  for (int i = 0; i < fibres.count; ++i) {
    const FibreFamily& of = fibres.family[static_cast<std::size_t>(i)];
    const Stretched at = stretched(of, f);
    if (at.e > 0) p += 2 * at.first * f * structure(of);
  }
  return p;
}

/// d(2 W' F A) = W'' (2 F A)(2 F A : dF) + 2 W' dF A.
template <>
Matrix9 fibre_tangent<FibreTheory::finite>(const ElementFibres& fibres, const Mat3& f) {
  Matrix9 sum = Matrix9::Zero();
  for (int i = 0; i < fibres.count; ++i) {
    const FibreFamily& of = fibres.family[static_cast<std::size_t>(i)];
    const Stretched at = stretched(of, f);
    if (!(at.e > 0)) continue;
    const Mat3 a = structure(of);
    const Vector9 slope = as_column(2 * f * a);
    sum += at.second * slope * slope.transpose();
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        for (int axis = 0; axis < 3; ++axis)
          sum(axis + 3 * j, axis + 3 * k) += 2 * at.first * a(k, j);
      }
    }
  }
  return sum;
}

template <>
double fibre_energy<FibreTheory::linear>(const ElementFibres& fibres, const Mat3& f) {
  const Mat3 e = small_strain_of(f);
  return linear_stress(fibres, e).cwiseProduct(e).sum() / 2;
}

template <>
Mat3 fibre_stress<FibreTheory::linear>(const ElementFibres& fibres, const Mat3& f) {
  return linear_stress(fibres, small_strain_of(f));
}

template <>
Matrix9 fibre_tangent<FibreTheory::linear>(const ElementFibres& fibres, const Mat3&) {
  Matrix9 tangent;
  for (int k = 0; k < 9; ++k) {
    Mat3 unit = Mat3::Zero();
    unit(k % 3, k / 3) = 1;
    tangent.col(k) = as_column(linear_stress(fibres, (unit + unit.transpose()) / 2));
  }
  return tangent;
}

double shear_scale(const SmallStrain& of) {
  if (!of.fibres) return of.mu;
  const AlongFibres& l = of.fibres->linear;
  double along = std::abs(l.lambda) + 2 * std::abs(l.alpha) + std::abs(l.beta) + 4 * std::abs(l.mu);
  for (const FibreFamily& f : of.fibres->family) along += 4 * f.k1;  // P = 2 k1 E F a a^T
  return of.mu + along / 3;
}

SpectralTangent with_fibres(const SpectralTangent& without, const Matrix9& fibres) {
  if (fibres.isZero(0)) return without;  // slack
  const Eigen::SelfAdjointEigenSolver<Matrix9> sum(without.matrix() + fibres);
  return {sum.eigenvalues(), sum.eigenvectors()};
}

}  // namespace sunder
