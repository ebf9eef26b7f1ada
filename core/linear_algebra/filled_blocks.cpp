// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/filled_blocks.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

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
    std::uint64_t* const row = filled_.data() + i * words_;
    for (int j : rows) row[j / kWord] |= std::uint64_t{1} << (j % kWord / kBlock);
  }
}

void FilledBlocks::find(const RowMajor& s, Eigen::Index n) {
  for (Eigen::Index i = 0; i < n; ++i) {
    std::uint64_t* const row = filled_.data() + i * words_;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (s(i, j) != 0) row[j / kWord] |= std::uint64_t{1} << (j % kWord / kBlock);
    }
  }
}

SUNDER_VECTORISED
void FilledBlocks::multiply(const double* s, Eigen::Index stride, Eigen::Index n, const double* x,
                            double* y) const {
  const Eigen::Index used = (n + kWord - 1) / kWord;
  for (Eigen::Index i = 0; i < n; ++i, s += stride) {
    machine::Lanes8 sum = {};
    for (Eigen::Index w = 0; w < used; ++w) {
      for (std::uint64_t left = filled_[static_cast<std::size_t>(i * words_ + w)]; left != 0;
           left &= left - 1) {
        const Eigen::Index at = w * kWord + kBlock * std::countr_zero(left);
        machine::Lanes8 a, of_x;
        std::memcpy(&a, s + at, sizeof(a));
        std::memcpy(&of_x, x + at, sizeof(of_x));
        sum += a * of_x;
      }
    }
    double part[kBlock];
    std::memcpy(part, &sum, sizeof(part));
    y[i] =
        ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
  }
}

}  // namespace sunder::linear_algebra
