// SPDX-License-Identifier: Apache-2.0
#include "engine/deformation_search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sunder::engine {
namespace {

// Bounds come from stress, whose pressure may hide some of their digits.
constexpr double kRounding = 1e-6;
// Where a large part turns as one, all its elements are as good as the largest.
constexpr double kClose = 1e-3;
// To what principal_strain() is right: where all elements are stretched alike, one is as good as
// all.
constexpr double kAsLarge = 1e-8;

}  // namespace

/// Whether the tangent of a rotation, at most |w| / cosine, may be over that found.
bool DeformationSearch::turns_further(double half_curl_squared, double cosine) const {
  if (!(cosine > 0)) return true;
  const double limit = tangent_ * (1 + kClose) * cosine;
  return half_curl_squared * (1 + kRounding) > limit * limit;
}

/// |E| is at least any principal strain and at least -(e2 + e3)/sqrt(2), so that the rotation is at
/// most atan(|w| / (1 - |E|/sqrt(2))) (fem::deformation_bounds); F is inverted only where |E| >= 1.
bool DeformationSearch::matters(double strain_squared, double curl_squared) const {
  const double squared = strain_squared * (1 + kRounding);
  if (!(squared < 1 && squared <= found_.strain * found_.strain)) return true;
  return turns_further(curl_squared / 4, 1 - std::sqrt(squared / 2));
}

DeformationSearch::Limits DeformationSearch::limits() const {
  const double strain = std::min(found_.strain * found_.strain, 1 - kRounding) / (1 + kRounding);
  const double cosine = 1 - std::sqrt(strain / 2), limit = 2 * tangent_ * cosine;
  return {strain, limit * limit};
}

void DeformationSearch::take(const Mat3& gradient) {
  const double twice = (gradient + gradient.transpose()).squaredNorm();
  const double curl = (gradient - gradient.transpose()).squaredNorm() / 2;
  if (!matters(twice / 4, curl)) return;
  const fem::DeformationBounds bounds = fem::deformation_bounds(gradient);
  raise(gradient, bounds);
  if (!(bounds.compression < 1) && (Mat3::Identity() + gradient).determinant() <= 0) {
    ++found_.inverted;
  }
}

void DeformationSearch::preview(const Mat3& gradient) {
  raise(gradient, fem::deformation_bounds(gradient));
}

void DeformationSearch::raise(const Mat3& gradient, const fem::DeformationBounds& bounds) {
  if (bounds.strain > std::abs(found_.strain) * (1 + kAsLarge)) {
    const double strain = fem::principal_strain(gradient);
    if (std::abs(strain) > std::abs(found_.strain)) found_.strain = strain;
  }
  if (!turns_further(bounds.half_curl_squared, bounds.cosine)) return;
  const double rotation = fem::rotation_deg(gradient);
  if (!(rotation > found_.rotation_deg)) return;
  found_.rotation_deg = rotation;
  constexpr double kRadians = std::numbers::pi / 180;
  tangent_ =
      rotation < 90 ? std::tan(rotation * kRadians) : std::numeric_limits<double>::infinity();
}

}  // namespace sunder::engine
