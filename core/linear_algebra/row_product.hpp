// SPDX-License-Identifier: Apache-2.0
// The dense product behind the engine's updates, compiled for the vector width at hand: Eigen's own
// is bound to the width that the whole library is compiled for.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace sunder::linear_algebra {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Entries of a row that is processed in full vectors, wherever its n end.
[[nodiscard]] constexpr Eigen::Index padded(Eigen::Index n) { return (n + 7) / 8 * 8; }

/// At least so large; what it held is lost when it grows.
inline void make_room(RowMajor& a, Eigen::Index rows, Eigen::Index columns) {
  if (a.rows() >= rows && a.cols() >= columns) return;
  a.resize(std::max(rows, a.rows()), std::max(columns, a.cols()));
}

/// A strided view of a left factor; a transpose swaps the strides.
struct LeftFactor {
  const double* data;
  Eigen::Index rows, columns, row_stride, column_stride;
};
[[nodiscard]] inline LeftFactor transposed(const RowMajor& a) {
  return {a.data(), a.cols(), a.rows(), 1, a.outerStride()};
}
[[nodiscard]] inline LeftFactor transposed(const Eigen::MatrixXd& a) {
  return {a.data(), a.cols(), a.rows(), a.outerStride(), 1};
}
[[nodiscard]] inline LeftFactor plain(const Eigen::MatrixXd& a) {
  return {a.data(), a.rows(), a.cols(), 1, a.outerStride()};
}

/// c = A b with b and c row by row at the given strides, `width` columns. Every entry is summed in
/// the order of A's columns, so the bits do not depend on the vector width.
void row_product(const LeftFactor& a, const double* b, Eigen::Index b_stride, Eigen::Index width,
                 double* c, Eigen::Index c_stride);

/// c += A b, each entry summed in the order of A's columns, beginning with c.
void row_product_add(const LeftFactor& a, const double* b, Eigen::Index b_stride,
                     Eigen::Index width, double* c, Eigen::Index c_stride);

/// row_product for large factors of long columns, in the same order: they are copied to where they
/// lie together. `room` is grown as needed.
void packed_product(const LeftFactor& a, const double* b, Eigen::Index b_stride, Eigen::Index width,
                    double* c, Eigen::Index c_stride, std::vector<double>& room);

/// x <- L^-1 x for a lower triangle L by columns, n x n at stride l_stride; x row by row, n x
/// width. `product` is room for n * width values.
void lower_solve(const double* l, Eigen::Index l_stride, Eigen::Index n, double* x,
                 Eigen::Index x_stride, Eigen::Index width, double* product);

/// x <- L^-T x; `product` is room for kBackRows * width values.
inline constexpr Eigen::Index kBackRows = 16;
void upper_solve(const double* l, Eigen::Index l_stride, Eigen::Index n, double* x,
                 Eigen::Index x_stride, Eigen::Index width, double* product);

/// A b for a row-major b.
[[nodiscard]] inline RowMajor row_product(const LeftFactor& a, const RowMajor& b) {
  RowMajor c(a.rows, b.cols());
  row_product(a, b.data(), b.outerStride(), b.cols(), c.data(), c.outerStride());
  return c;
}

}  // namespace sunder::linear_algebra
