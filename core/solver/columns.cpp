// SPDX-License-Identifier: Apache-2.0
#include "solver/columns.hpp"

#include <algorithm>

#include "machine/compiler.hpp"

namespace sunder::solver {
namespace {

// Rows of y that stay in the first-level cache while the columns pass.
constexpr Eigen::Index kRows = 1024;

SUNDER_VECTORISED
void add_four(const double* a, const double* b, const double* c, const double* d,
              const double* value, Eigen::Index rows, double* y) {
  for (Eigen::Index i = 0; i < rows; ++i) {
    y[i] += (value[0] * a[i] + value[1] * b[i]) + (value[2] * c[i] + value[3] * d[i]);
  }
}

SUNDER_VECTORISED
void add_one(const double* a, double value, Eigen::Index rows, double* y) {
  for (Eigen::Index i = 0; i < rows; ++i) y[i] += value * a[i];
}

/// `column`: where the i-th one begins.
template <class Column>
void add_all(Column&& column, std::size_t count, const double* values, Eigen::Index all_rows,
             double* y) {
  for (Eigen::Index start = 0; start < all_rows; start += kRows) {
    const Eigen::Index rows = std::min(kRows, all_rows - start);
    std::size_t i = 0;
    for (; i + 4 <= count; i += 4) {
      add_four(column(i) + start, column(i + 1) + start, column(i + 2) + start,
               column(i + 3) + start, values + i, rows, y + start);
    }
    for (; i < count; ++i) add_one(column(i) + start, values[i], rows, y + start);
  }
}

}  // namespace

void add_columns(const Eigen::MatrixXd& x, std::span<const Index> columns,
                 std::span<const double> values, Eigen::VectorXd& y) {
  add_all([&](std::size_t i) { return x.col(columns[i]).data(); }, columns.size(), values.data(),
          x.rows(), y.data());
}

void add_columns(std::span<const double* const> columns, std::span<const double> values,
                 Eigen::Index rows, double* y) {
  add_all([&](std::size_t i) { return columns[i]; }, columns.size(), values.data(), rows, y);
}

SUNDER_VECTORISED
void add_product(const double* v, Eigen::Index stride, Eigen::Index rows, const double* c,
                 Eigen::Index columns, double* y) {
  Eigen::Index j = 0;
  for (; j + 4 <= columns; j += 4, v += 4 * stride) {
    const double *a = v, *b = v + stride, *d = v + 2 * stride, *e = v + 3 * stride;
    for (Eigen::Index i = 0; i < rows; ++i) {
      y[i] += (c[j] * a[i] + c[j + 1] * b[i]) + (c[j + 2] * d[i] + c[j + 3] * e[i]);
    }
  }
  for (; j < columns; ++j, v += stride) {
    for (Eigen::Index i = 0; i < rows; ++i) y[i] += c[j] * v[i];
  }
}

}  // namespace sunder::solver
