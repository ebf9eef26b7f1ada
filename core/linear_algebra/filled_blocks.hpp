// SPDX-License-Identifier: Apache-2.0
// Which blocks of eight columns hold anything in each row of a sparse matrix that is stored
// densely, and its product with a vector, which reads no others.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "linear_algebra/row_product.hpp"

namespace sunder::linear_algebra {

class FilledBlocks {
 public:
  /// Room for a matrix of so many rows and columns; what is known stays.
  void reserve(Eigen::Index size);
  /// Nothing holds anything.
  void clear();
  /// All entries in these rows and columns may hold something.
  void add(std::span<const int> rows);
  /// Adds what a matrix holds, so many of its rows and columns.
  void find(const RowMajor& s, Eigen::Index n);

  /// y = S x, n x n. S lies row by row, `stride` apart; of it, x and the room that was reserved a
  /// product reads padded(n) columns, which must be numbers. The order of all sums is fixed, and a
  /// block of zeros changes none.
  void multiply(const double* s, Eigen::Index stride, Eigen::Index n, const double* x,
                double* y) const;

 private:
  template <int Rows, class Vector>
  void take_rows(Eigen::Index first, const double* s, Eigen::Index stride, Eigen::Index words,
                 const double* x, double* y) const;

  void fill(Eigen::Index row, Eigen::Index column) {
    filled_[static_cast<std::size_t>(row * words_ + column / kWord)] |=
        std::uint64_t{1} << (column % kWord / kBlock);
  }

  static constexpr Eigen::Index kBlock = 8, kWord = 64 * kBlock;  // columns
  Eigen::Index words_ = 0;                                        // of a row
  std::vector<std::uint64_t> filled_;                             // a bit for each block
};

}  // namespace sunder::linear_algebra
