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

}  // namespace

void add_columns(const Eigen::MatrixXd& x, std::span<const Index> columns,
                 std::span<const double> values, Eigen::VectorXd& y) {
  for (Eigen::Index start = 0; start < x.rows(); start += kRows) {
    const Eigen::Index rows = std::min(kRows, x.rows() - start);
    std::size_t i = 0;
    for (; i + 4 <= columns.size(); i += 4) {
      add_four(x.col(columns[i]).data() + start, x.col(columns[i + 1]).data() + start,
               x.col(columns[i + 2]).data() + start, x.col(columns[i + 3]).data() + start,
               &values[i], rows, y.data() + start);
    }
    for (; i < columns.size(); ++i) {
      add_one(x.col(columns[i]).data() + start, values[i], rows, y.data() + start);
    }
  }
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
