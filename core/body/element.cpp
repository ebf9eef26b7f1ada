// SPDX-License-Identifier: Apache-2.0
#include "body/element.hpp"

#include <Eigen/LU>
#include <cmath>

namespace sunder::fem {

TetShape tet_shape(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  Mat3 edges;
  edges << x1 - x0, x2 - x0, x3 - x0;
  TetShape shape;
  shape.volume = edges.determinant() / 6;
  // Rows of the inverse are the gradients of corners 1..3; the four sum to zero.
  shape.gradient.rightCols<3>() = edges.inverse().transpose();
  shape.gradient.col(0) = -shape.gradient.rightCols<3>().rowwise().sum();
  return shape;
}

StrainDisplacement strain_displacement(const TetShape& shape) {
  StrainDisplacement b = StrainDisplacement::Zero();
  for (int a = 0; a < 4; ++a) {
    const double gx = shape.gradient(0, a), gy = shape.gradient(1, a), gz = shape.gradient(2, a);
    auto block = b.middleCols<3>(3 * a);
    block(0, 0) = gx;
    block(1, 1) = gy;
    block(2, 2) = gz;
    block(3, 0) = gy;
    block(3, 1) = gx;
    block(4, 1) = gz;
    block(4, 2) = gy;
    block(5, 0) = gz;
    block(5, 2) = gx;
  }
  return b;
}

ElementMatrix element_stiffness(const TetShape& shape, const Matrix6& d) {
  const StrainDisplacement b = strain_displacement(shape);
  return shape.volume * (b.transpose() * d * b);
}

UpdateFactor update_factor(const TetShape& shape, const SmallStrain& law, double alpha) {
  const Matrix6 l = elasticity_factor(law);
  return strain_displacement(shape).transpose() * l * std::sqrt(shape.volume * (1 - alpha));
}

Voigt stress(const TetShape& shape, const SmallStrain& law,
             const Eigen::Matrix<double, 3, 4>& displacement) {
  // Gradient H_ij = du_i/dx_j from differences to corner 0 (the gradients sum to zero).
  const Mat3 h = (displacement.rightCols<3>().colwise() - displacement.col(0)) *
                 shape.gradient.rightCols<3>().transpose();
  return sunder::stress(law, h);
}

Eigen::Matrix<double, 3, 4> corner_displacement(const Mesh& mesh, Index e,
                                                std::span<const double> u) {
  Eigen::Matrix<double, 3, 4> corners;
  for (int a = 0; a < 4; ++a) {
    const Index n = mesh.tets[e][a];
    for (int axis = 0; axis < 3; ++axis) corners(axis, a) = u[3 * n + axis];
  }
  return corners;
}

SmallStrain own_law(const Problem& problem, Index e) {
  const bool pools = problem.pools() && problem.material(e).volume == MaterialVolume::pooled;
  return pools ? without_pressure(problem.small_strain(e)) : problem.small_strain(e);
}

ElementMatrix element_stiffness(const Problem& problem, Index e) {
  return element_stiffness(problem.shape(e), elasticity(own_law(problem, e)));
}

UpdateFactor update_factor(const Problem& problem, Index e) {
  return update_factor(problem.shape(e), own_law(problem, e), problem.scene().fracture.alpha);
}

Voigt stress_by_itself(const Problem& problem, Index e, std::span<const double> u) {
  return stress(problem.shape(e), own_law(problem, e), corner_displacement(problem.mesh(), e, u));
}

}  // namespace sunder::fem
