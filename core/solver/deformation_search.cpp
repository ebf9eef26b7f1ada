// SPDX-License-Identifier: Apache-2.0
#include "solver/deformation_search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sunder::solver {
namespace {

// Of bounds that are computed twice, in another order.
constexpr double kRounding = 1e-6;
// Where a large part turns as one, all its elements are as good as the largest.
constexpr double kClose = 1e-3;
// To what principal_strain() is right: where all elements are stretched alike, one is as good as
// all.
constexpr double kAsLarge = 1e-8;
// Of elements whose grad u differs by so much beside the largest: their rotations do too.
constexpr double kAlike = 1e-9;
// What rounding leaves of a rotation in a strained element that does not turn, beside its strain.
constexpr double kNoRotation = 1e-14;

}  // namespace

/// Up to which the tangent of a rotation changes nothing.
double DeformationSearch::tangent() const {
  return std::max(tangent_ * (1 + kClose), kNoRotation * std::abs(found_.strain));
}

/// F is inverted only where something is shortened by all its length.
DeformationSearch::Limits DeformationSearch::limits(double rounding) const {
  Limits limits;
  limits.strain = std::abs(found_.strain) * (1 + kAsLarge / 2 - rounding);
  limits.compression = std::min(limits.strain, 1 - kRounding);
  limits.tangent =
      std::min(tangent() * (1 - kRounding), 1e150);  // its square is finite or infinite
  limits.turned = turned_;
  limits.alike_squared = kAlike * kAlike * turned_.squaredNorm();
  return limits;
}

void DeformationSearch::take(const Mat3& gradient) {
  const fem::DeformationBounds bounds = fem::deformation_bounds(gradient);
  if (bounds.strain > std::abs(found_.strain) * (1 + kAsLarge) && gradient != strained_) {
    preview_strain(gradient);
  }
  const double sine = tangent() * bounds.cosine;
  const bool may_turn_further =
      !(bounds.cosine > 0) || bounds.half_curl_squared * (1 + kRounding) > sine * sine;
  if (may_turn_further && gradient != turned_) preview_rotation(gradient);
  if (!(bounds.compression < 1) && (Mat3::Identity() + gradient).determinant() <= 0) {
    ++found_.inverted;
  }
}

void DeformationSearch::preview_strain(const Mat3& gradient) {
  const double strain = fem::principal_strain(gradient);
  if (!(std::abs(strain) > std::abs(found_.strain))) return;
  found_.strain = strain;
  strained_ = gradient;
}

void DeformationSearch::preview_rotation(const Mat3& gradient) {
  const double rotation = fem::rotation_deg(gradient, half_tangent_);
  if (!(rotation > found_.rotation_deg)) return;
  found_.rotation_deg = rotation;
  turned_ = gradient;
  constexpr double kRadians = std::numbers::pi / 180;
  half_tangent_ = std::tan(rotation * kRadians / 2);
  tangent_ =
      rotation < 90 ? std::tan(rotation * kRadians) : std::numeric_limits<double>::infinity();
}

}  // namespace sunder::solver
