// SPDX-License-Identifier: Apache-2.0
#include "fem/element.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

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

Matrix6 elasticity(double young, double poisson) {
  const double mu = young / (2 * (1 + poisson));
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  Matrix6 d = Matrix6::Zero();
  d.topLeftCorner<3, 3>().setConstant(lambda);
  d.diagonal().head<3>().array() += 2 * mu;
  d.diagonal().tail<3>().setConstant(mu);
  return d;
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

UpdateFactor update_factor(const TetShape& shape, const Matrix6& d, double alpha) {
  const Matrix6 l = d.llt().matrixL();
  return strain_displacement(shape).transpose() * l * std::sqrt(shape.volume * (1 - alpha));
}

Voigt stress(const TetShape& shape, const Material& material,
             const Eigen::Matrix<double, 3, 4>& displacement) {
  // Gradient H_ij = du_i/dx_j from differences to corner 0 (the gradients sum to zero).
  const Mat3 h = (displacement.rightCols<3>().colwise() - displacement.col(0)) *
                 shape.gradient.rightCols<3>().transpose();
  const double mu = material.young / (2 * (1 + material.poisson));
  const double lambda =
      material.young * material.poisson / ((1 + material.poisson) * (1 - 2 * material.poisson));
  const double pressure = lambda * h.trace();
  Voigt s;
  s << pressure + 2 * mu * h(0, 0), pressure + 2 * mu * h(1, 1), pressure + 2 * mu * h(2, 2),
      mu * (h(0, 1) + h(1, 0)), mu * (h(1, 2) + h(2, 1)), mu * (h(2, 0) + h(0, 2));
  return s;
}

Mat3 tensor(const Voigt& s) {
  Mat3 t;
  t << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return t;
}

Vec3 principal_stresses(const Voigt& s) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.compute(tensor(s), Eigen::EigenvaluesOnly);
  return solver.eigenvalues().reverse();
}

double max_shear(const Voigt& s) {
  const Vec3 p = principal_stresses(s);
  return (p[0] - p[2]) / 2;
}

double yield_measure(const Voigt& s, YieldMeasure measure) {
  return measure == YieldMeasure::max_shear ? max_shear(s) : 2 * max_shear(s);
}

double stress_of_rounding(const Problem& problem, double largest_u) {
  double largest = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Material& m = problem.material(e);
    largest =
        std::max(largest, elasticity(m.young, m.poisson).norm() * problem.shape(e).gradient.norm());
  }
  return std::numeric_limits<double>::epsilon() / 2 * largest_u * largest;
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

}  // namespace sunder::fem
