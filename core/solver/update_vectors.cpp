// SPDX-License-Identifier: Apache-2.0
#include "solver/update_vectors.hpp"

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace sunder::solver {
namespace {

// A remainder below this share of a dof's own destroyed stiffness is rounding of the products.
constexpr double kRankTolerance = 1e-14;

using Matrix = Eigen::Map<Eigen::MatrixXd>;
using Vector = Eigen::Map<Eigen::VectorXd>;

Matrix matrix(std::vector<double>& values, Eigen::Index rows, Eigen::Index columns) {
  values.resize(static_cast<std::size_t>(rows * columns));
  return {values.data(), rows, columns};
}

Vector vector(std::vector<double>& values, Eigen::Index size) {
  values.resize(static_cast<std::size_t>(size));
  return {values.data(), size};
}

/// A = V V^T by Cholesky with diagonal pivoting, A with unit diagonal; V keeps A's row order.
/// Returns the rank: V's columns.
Eigen::Index pivoted_cholesky(const Matrix& a, Vector left, Matrix v) {
  const Eigen::Index m = a.rows();
  left = a.diagonal();
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
  return rank;
}

/// A = W W^T of columns with few entries (an element's twelve unknowns).
void multiply_with_transpose(const Matrix& w, std::vector<Eigen::Index>& rows, Matrix a) {
  a.setZero();
  for (Eigen::Index k = 0; k < w.cols(); ++k) {
    rows.clear();
    for (Eigen::Index i = 0; i < w.rows(); ++i) {
      if (w(i, k) != 0) rows.push_back(i);
    }
    for (Eigen::Index j : rows) {
      for (Eigen::Index i : rows) a(i, j) += w(i, k) * w(j, k);
    }
  }
}

}  // namespace

void CompressRoom::reserve(std::size_t rows) {
  product.reserve(rows * rows);
  v.reserve(rows * rows);
  scaled.reserve(4 * rows * rows);
  scale.reserve(rows);
  left.reserve(rows);
  entries.reserve(rows);
}

Eigen::Index compress(Eigen::Index rows, Eigen::Index columns, std::vector<double>& w,
                      CompressRoom& room) {
  if (rows == 0 || columns <= 6) return columns;
  Vector scale = vector(room.scale, rows);
  Matrix scaled = matrix(room.scaled, rows, columns);
  scale = matrix(w, rows, columns).rowwise().norm();
  scaled = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; }).asDiagonal() *
           matrix(w, rows, columns);
  Matrix product = matrix(room.product, rows, rows), v = matrix(room.v, rows, rows);
  multiply_with_transpose(scaled, room.entries, product);
  const Eigen::Index rank = pivoted_cholesky(product, vector(room.left, rows), v);
  if (rank >= columns) return columns;
  matrix(w, rows, rank) = scale.asDiagonal() * v.leftCols(rank);
  return rank;
}

fem::EventFactor compressed(fem::EventFactor event) {
  CompressRoom room;
  std::vector<double> w(event.w.data(), event.w.data() + event.w.size());
  const Eigen::Index columns = compress(event.w.rows(), event.w.cols(), w, room);
  if (columns < event.w.cols()) event.w = matrix(w, event.w.rows(), columns);
  return event;
}

}  // namespace sunder::solver
