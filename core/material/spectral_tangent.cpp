// SPDX-License-Identifier: Apache-2.0
#include "material/spectral_tangent.hpp"

#include <Eigen/Eigenvalues>
#include <numbers>

namespace sunder {
namespace {

Vector9 as_vector(const Mat3& m) { return Eigen::Map<const Vector9>(m.data()); }

}  // namespace

SpectralTangent spectral_tangent(const SingularValues& of, const PrincipalTangent& principal) {
  const Eigen::SelfAdjointEigenSolver<Mat3> stretch(principal.stretch);
  SpectralTangent tangent;
  tangent.values << stretch.eigenvalues(), principal.flip, principal.twist;
  for (int k = 0; k < 3; ++k) {
    const Vec3 along = stretch.eigenvectors().col(k);
    tangent.modes.col(k) = as_vector(of.u * along.asDiagonal() * of.v.transpose());
    const int i = k, j = (k + 1) % 3;
    const Mat3 ij = of.u.col(i) * of.v.col(j).transpose() / std::numbers::sqrt2;
    const Mat3 ji = of.u.col(j) * of.v.col(i).transpose() / std::numbers::sqrt2;
    tangent.modes.col(3 + k) = as_vector(ij + ji);
    tangent.modes.col(6 + k) = as_vector(ij - ji);
  }
  return tangent;
}

}  // namespace sunder
