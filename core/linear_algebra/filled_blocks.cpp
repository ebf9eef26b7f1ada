// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/filled_blocks.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "machine/compiler.hpp"

namespace sunder::linear_algebra {

void FilledBlocks::reserve(Eigen::Index size) {
  const Eigen::Index words = (size + kWord - 1) / kWord;
  const Eigen::Index rows = words_ == 0 ? 0 : static_cast<Eigen::Index>(filled_.size()) / words_;
  if (size <= rows) return;
  std::vector<std::uint64_t> filled(static_cast<std::size_t>(size * words), 0);
  for (Eigen::Index i = 0; i < rows; ++i) {
    std::copy_n(filled_.begin() + i * words_, words_, filled.begin() + i * words);
  }
  filled_ = std::move(filled);
  words_ = words;
}

void FilledBlocks::clear() { std::fill(filled_.begin(), filled_.end(), 0); }

void FilledBlocks::add(std::span<const int> rows) {
  for (int i : rows) {
    for (int j : rows) fill(i, j);
  }
}

void FilledBlocks::find(const RowMajor& s, Eigen::Index n) {
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      if (s(i, j) != 0) fill(i, j);
    }
  }
}

/// Some rows in one pass over the blocks that any of them fills: of zeros no sum knows.
template <int Rows, class Vector>
SUNDER_FORCE_INLINE void FilledBlocks::take_rows(Eigen::Index first, const double* s,
                                                 Eigen::Index stride, Eigen::Index words,
                                                 const double* x, double* y) const {
  constexpr Eigen::Index kEach = sizeof(Vector) / sizeof(double), kVectors = kBlock / kEach;
  Vector sum[Rows][kVectors] = {};
  const std::uint64_t* filled = filled_.data() + first * words_;
  for (Eigen::Index w = 0; w < words; ++w, ++filled) {
    std::uint64_t any = 0;
    for (int r = 0; r < Rows; ++r) any |= filled[r * words_];
    for (; any != 0; any &= any - 1) {
      const Eigen::Index at = w * kWord + kBlock * std::countr_zero(any);
      for (Eigen::Index v = 0; v < kVectors; ++v) {
        Vector of_x;
        std::memcpy(&of_x, x + at + v * kEach, sizeof(Vector));
        for (int r = 0; r < Rows; ++r) {
          Vector a;
          std::memcpy(&a, s + r * stride + at + v * kEach, sizeof(Vector));
          sum[r][v] += a * of_x;
        }
      }
    }
  }
  for (int r = 0; r < Rows; ++r) {
    double part[kBlock];
    std::memcpy(part, sum[r], sizeof(part));
    y[r] =
        ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
  }
}

SUNDER_VECTORISED
void FilledBlocks::multiply(const double* s, Eigen::Index stride, Eigen::Index n, const double* x,
                            double* y) const {
  const Eigen::Index words = (n + kWord - 1) / kWord;
  Eigen::Index i = 0;
  for (; machine::wide_registers() && i + 4 <= n; i += 4) {
    take_rows<4, machine::Lanes8>(i, s + i * stride, stride, words, x, y + i);
  }
  for (; i + 4 <= n; i += 4) {
    take_rows<4, machine::Lanes4>(i, s + i * stride, stride, words, x, y + i);
  }
  for (; i < n; ++i) take_rows<1, machine::Lanes4>(i, s + i * stride, stride, words, x, y + i);
}

}  // namespace sunder::linear_algebra
