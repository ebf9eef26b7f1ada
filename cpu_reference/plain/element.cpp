// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/plain/element.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>

namespace sunder::plain {

Element::Element(const Mesh& mesh, Index e, const Material& material) {
  Eigen::Matrix<Real, 4, 4> corners;
  for (int a = 0; a < 4; ++a) {
    const Index node = mesh.tets[e][a];
    corners.row(a) << 1, mesh.nodes[node].transpose().cast<Real>();
    for (int axis = 0; axis < 3; ++axis) places[3 * a + axis] = 3 * node + axis;
  }
  volume = corners.determinant() / 6;
  const Eigen::Matrix<Real, 4, 4> shape = corners.inverse();  // column a: N_a over [1 x y z]
  for (int a = 0; a < 4; ++a) {
    const Real x = shape(1, a), y = shape(2, a), z = shape(3, a);
    b.col(3 * a) << x, 0, 0, y, 0, z;
    b.col(3 * a + 1) << 0, y, 0, x, z, 0;
    b.col(3 * a + 2) << 0, 0, z, 0, y, x;
  }
  const Real young = material.young, nu = material.poisson;
  Eigen::Matrix<Real, 6, 6> compliance = Eigen::Matrix<Real, 6, 6>::Zero();
  compliance.topLeftCorner<3, 3>().setConstant(-nu / young);
  compliance.diagonal().head<3>().setConstant(1 / young);
  compliance.diagonal().tail<3>().setConstant(2 * (1 + nu) / young);
  d = compliance.inverse();
}

Real3x3 Element::gradient(const Real12& u) const {
  Real3x3 h = Real3x3::Zero();
  for (int a = 0; a < 4; ++a) h += u.segment<3>(3 * a) * slope(a);
  return h;
}

Eigen::Matrix<Real, 3, 1> principal_values(const Real3x3& tensor) {
  return Eigen::SelfAdjointEigenSolver<Real3x3>(tensor, Eigen::EigenvaluesOnly).eigenvalues();
}

Real rotation_deg(const Real3x3& gradient) {
  const Eigen::JacobiSVD<Real3x3> svd(Real3x3::Identity() + gradient,
                                      Eigen::ComputeFullU | Eigen::ComputeFullV);
  Real3x3 u = svd.matrixU();
  if (u.determinant() * svd.matrixV().determinant() < 0) u.col(2) *= -1;  // no mirror
  const Real3x3 r = u * svd.matrixV().transpose();
  const Real twice_sine = std::sqrt((r - r.transpose()).squaredNorm() / 2);
  return std::atan2(twice_sine, r.trace() - 1) * 180 / std::numbers::pi_v<Real>;
}

}  // namespace sunder::plain
