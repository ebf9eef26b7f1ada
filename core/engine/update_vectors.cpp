// SPDX-License-Identifier: Apache-2.0
#include "engine/update_vectors.hpp"

#include <Eigen/Core>
#include <cmath>
#include <vector>

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

/// W W^T of columns with few entries (an element's twelve unknowns).
Eigen::MatrixXd product_with_transpose(const Eigen::MatrixXd& w) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(w.rows(), w.rows());
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < w.cols(); ++k) {
    rows.clear();
    for (Eigen::Index i = 0; i < w.rows(); ++i) {
      if (w(i, k) != 0) rows.push_back(i);
    }
    for (Eigen::Index j : rows) {
      for (Eigen::Index i : rows) a(i, j) += w(i, k) * w(j, k);
    }
  }
  return a;
}

}  // namespace

fem::EventFactor compressed(fem::EventFactor event) {
  if (event.w.rows() == 0 || event.w.cols() <= 6) return event;
  const Eigen::VectorXd scale = event.w.rowwise().norm();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  Eigen::MatrixXd v = pivoted_cholesky(product_with_transpose(inverse.asDiagonal() * event.w));
  if (v.cols() < event.w.cols()) event.w = scale.asDiagonal() * v;
  return event;
}

}  // namespace sunder::engine
