// SPDX-License-Identifier: Apache-2.0
// Singular values of a deformation gradient with their signs, and its polar decomposition.
#pragma once

#include "sunder/types.hpp"

namespace sunder {

/// F = U diag(s) V^T with rotations U and V (det +1) and s0 >= s1 >= |s2|: s2 < 0 where F is
/// inverted, so that the least stretch is the one that turns inside out (Irving, Teran and Fedkiw
/// 2004).
struct SingularValues {
  Mat3 u;
  Vec3 s;
  Mat3 v;
};

/// One-sided Jacobi rotations (Hestenes 1958): a fixed number, so that elements can share a vector
/// register; small singular values keep their digits, as they do not where F^T F is taken.
/// Where F has rank 1 or 0, its null directions are turned as columns of V say; F = 0 gives U = V.
[[nodiscard]] SingularValues singular_values(const Mat3& f);

/// F = R S: R = U V^T, S = V diag(s) V^T. R is the rotation nearest to F, whatever its sign: where
/// F is inverted S has one negative eigenvalue, the least in magnitude. R is unique as long as
/// s1 + s2 > 0.
struct Polar {
  Mat3 rotation, stretch;
};
[[nodiscard]] Polar polar(const Mat3& f);
/// polar(f).rotation to rounding, quicker where F is far from flat and from inverted: Newton's
/// iteration X <- (X + X^-T)/2 (Higham 1986).
[[nodiscard]] Mat3 nearest_rotation(const Mat3& f);

}  // namespace sunder
