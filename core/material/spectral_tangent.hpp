// SPDX-License-Identifier: Apache-2.0
// The tangent dP/dF of a law by its eigenvalues and modes: what its projection to positive
// semidefinite and its low-rank factor are made of.
#pragma once

#include "material/singular_values.hpp"

namespace sunder {

using Vector9 = Eigen::Matrix<double, 9, 1>;  ///< entry (i, j) of a 3 x 3 at i + 3 j
using Matrix9 = Eigen::Matrix<double, 9, 9>;

/// dP/dF = modes diag(values) modes^T, modes orthonormal.
struct SpectralTangent {
  Vector9 values;  ///< [MPa]
  Matrix9 modes;   ///< columns

  [[nodiscard]] Matrix9 matrix() const { return modes * values.asDiagonal() * modes.transpose(); }
  /// The nearest positive semidefinite one: negative eigenvalues are 0 (Teran et al. 2005).
  [[nodiscard]] Matrix9 projected() const {
    return modes * values.cwiseMax(0).asDiagonal() * modes.transpose();
  }
};

/// Of an isotropic law W(s0, s1, s2) in the principal frame of F (Holzapfel 2000, 6.2; Smith, de
/// Goes and Kim 2019, "Analytic eigensystems for isotropic distortion energies"). A change of F
/// that is symmetric there in axes i and j ("flip") meets (W_i - W_j)/(s_i - s_j), a skew one
/// ("twist") (W_i + W_j)/(s_i + s_j).
struct PrincipalTangent {
  Mat3 stretch;      ///< W_ij, second derivatives by the singular values
  Vec3 flip, twist;  ///< of the pairs (0, 1), (1, 2), (2, 0)
};
[[nodiscard]] SpectralTangent spectral_tangent(const SingularValues& of,
                                               const PrincipalTangent& principal);

}  // namespace sunder
