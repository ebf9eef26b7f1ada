// SPDX-License-Identifier: Apache-2.0
// How far an element is deformed, from its displacement gradient H = grad u: principal strain and
// the rotation of F = I + H (docs/method.md "Elasticity", Deformation).
#pragma once

#include <span>

#include "sunder/problem.hpp"

namespace sunder::fem {

/// H of element e from the displacement at all nodes (3 * nodes).
[[nodiscard]] Mat3 displacement_gradient(const Problem& problem, Index e,
                                         std::span<const double> u);

/// Principal value of sym H largest in magnitude; of two as large the positive one.
[[nodiscard]] double principal_strain(const Mat3& h);

/// Angle of the rotation nearest to F [deg], 0 to 180: that of its polar decomposition where
/// det F > 0. Where the tangent of its half is at most `least`, any angle from it to that one.
[[nodiscard]] double rotation_deg(const Mat3& h, double least = 0);

/// What needs no eigenvalues and is never under the exact values but by rounding.
struct DeformationBounds {
  double strain = 0;       ///< of the principal strain's magnitude
  double compression = 0;  ///< of the largest shortening; F cannot be inverted under 1
  /// Of the rotation's tangent, squared: half_curl_squared / cosine^2 where cosine > 0; else the
  /// rotation has no bound.
  double half_curl_squared = 0, cosine = 1;
  [[nodiscard]] double rotation_deg() const;
};
[[nodiscard]] DeformationBounds deformation_bounds(const Mat3& h);

}  // namespace sunder::fem
