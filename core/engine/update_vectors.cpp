// SPDX-License-Identifier: Apache-2.0
#include "engine/update_vectors.hpp"

#include <Eigen/Core>
#include <cmath>

namespace sunder::engine {
namespace {

// A remainder below this share of a dof's own destroyed stiffness is rounding of the products.
constexpr double kRankTolerance = 1e-14;

/// A = V V^T by Cholesky with diagonal pivoting, A with unit diagonal; V keeps A's row order.
Eigen::MatrixXd pivoted_cholesky(const Eigen::MatrixXd& a) {
  const Eigen::Index m = a.rows();
  Eigen::MatrixXd v(m, m);
  Eigen::VectorXd left = a.diagonal();
  Eigen::Index rank = 0;
  for (; rank < m; ++rank) {
    Eigen::Index pivot = 0;
    if (!(left.maxCoeff(&pivot) > kRankTolerance * static_cast<double>(m))) break;
    auto column = v.col(rank);
    column = a.col(pivot);
    column.noalias() -= v.leftCols(rank) * v.row(pivot).head(rank).transpose();
    column /= std::sqrt(left[pivot]);
    left -= column.cwiseAbs2();
    left[pivot] = 0;
  }
  v.conservativeResize(Eigen::NoChange, rank);
  return v;
}

}  // namespace

fem::EventFactor compressed(fem::EventFactor event) {
  if (event.w.rows() == 0 || event.w.cols() <= 6) return event;
  const Eigen::VectorXd scale = event.w.rowwise().norm();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  const Eigen::MatrixXd w = inverse.asDiagonal() * event.w;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(w.rows(), w.rows());
  a.selfadjointView<Eigen::Lower>().rankUpdate(w);
  a.triangularView<Eigen::StrictlyUpper>() = a.transpose();
  Eigen::MatrixXd v = pivoted_cholesky(a);
  if (v.cols() < event.w.cols()) event.w = scale.asDiagonal() * v;
  return event;
}

}  // namespace sunder::engine
