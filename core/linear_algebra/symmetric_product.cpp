// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/symmetric_product.hpp"

#include <cstring>

#include "machine/compiler.hpp"

namespace sunder::linear_algebra {
namespace {

using Index = Eigen::Index;
constexpr Index kAtOnce = 8;

/// Some rows in one pass over the columns before them. Of a row, the columns up to the last
/// multiple of eight are taken eight at a time, the rest one by one, and four rows are added up
/// before they join y: the same for any multiple of four.
template <int Rows, class Vector>
SUNDER_FORCE_INLINE void take_rows(const double* s, Index stride, Index first, const double* x,
                                   double* y) {
  constexpr Index kEach = sizeof(Vector) / sizeof(double), kVectors = kAtOnce / kEach;
  constexpr int kSummed = Rows < 4 ? Rows : 4;
  Vector sum[Rows][kVectors] = {};
  const Index full = first / kAtOnce * kAtOnce;
  const double* rows = s + first * stride;
  for (Index j = 0; j < full; j += kAtOnce) {
    for (Index v = 0; v < kVectors; ++v) {
      const Index at = j + v * kEach;
      Vector of_x, of_y;
      std::memcpy(&of_x, x + at, sizeof(Vector));
      std::memcpy(&of_y, y + at, sizeof(Vector));
      for (int r = 0; r < Rows; r += kSummed) {
        Vector share[4] = {};
        for (int t = 0; t < kSummed; ++t) {
          Vector a;
          std::memcpy(&a, rows + (r + t) * stride + at, sizeof(Vector));
          sum[r + t][v] += a * of_x;
          share[t] = a * x[first + r + t];
        }
        of_y += (share[0] + share[1]) + (share[2] + share[3]);
      }
      std::memcpy(y + at, &of_y, sizeof(Vector));
    }
  }
  for (int r = 0; r < Rows; ++r) {
    double part[kAtOnce];
    std::memcpy(part, sum[r], sizeof(part));
    double total =
        ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
    const double* row = rows + r * stride;
    const Index i = first + r;
    for (Index j = full; j < i; ++j) {
      total += row[j] * x[j];
      y[j] += row[j] * x[i];
    }
    y[i] = total + row[i] * x[i];
  }
}

}  // namespace

SUNDER_VECTORISED
void symmetric_product(const double* s, Eigen::Index stride, Eigen::Index n, const double* x,
                       double* y) {
  Index i = 0;
  // Of registers of four numbers, eight rows would need more than there are.
  for (; machine::wide_registers() && i + 8 <= n; i += 8) {
    take_rows<8, machine::Lanes8>(s, stride, i, x, y);
  }
  for (; i + 4 <= n; i += 4) take_rows<4, machine::Lanes4>(s, stride, i, x, y);
  for (; i < n; ++i) take_rows<1, machine::Lanes4>(s, stride, i, x, y);
}

}  // namespace sunder::linear_algebra
