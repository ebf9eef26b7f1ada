// SPDX-License-Identifier: Apache-2.0
#include "fem/panel_kernels.hpp"

#include <cstddef>

#include "engine/vectorised.hpp"

namespace sunder::fem {
namespace {

// Dot products are kept in this many partial sums, so that their bits do not depend on the width
// of the processor's vectors.
constexpr int kLanes = 16;

// The panels are read from their end on, each column from its beginning: the processor's own
// prefetching sees a new start at every column. Entries this far ahead are asked for.
constexpr int kAhead = 1024;
constexpr int kLine = 8;  // entries of a line of the cache

/// sums[c] = column c . below for some columns that begin `stride` apart; each in the same order.
template <int Columns>
inline __attribute__((always_inline)) void dots(const double* columns, Index stride, Index count,
                                                const double* below, double* sums) {
  double lanes[Columns][kLanes] = {};
  Index i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (int c = 0; c < Columns; ++c) {
      const double* column = columns + c * static_cast<std::ptrdiff_t>(stride) + i;
      for (int l = 0; l < kLanes; l += kLine) __builtin_prefetch(column + l - kAhead);
      for (int l = 0; l < kLanes; ++l) lanes[c][l] += column[l] * below[i + l];
    }
  }
  for (int l = 0; i < count; ++i, ++l) {
    for (int c = 0; c < Columns; ++c) {
      lanes[c][l] += columns[c * static_cast<std::ptrdiff_t>(stride) + i] * below[i];
    }
  }
  for (int c = 0; c < Columns; ++c) {
    sums[c] = 0;
    for (int l = 0; l < kLanes; ++l) sums[c] += lanes[c][l];
  }
}

}  // namespace

SUNDER_VECTORISED
void panel_forward(const double* panel, Index width, Index height, double* x, double* below) {
  const Index under = height - width;
  for (Index j = 0; j < width; ++j) {
    const double* column = panel + static_cast<std::size_t>(j) * static_cast<std::size_t>(height);
    const double xj = x[j] / column[j];
    x[j] = xj;
    for (Index i = j + 1; i < width; ++i) x[i] -= column[i] * xj;
    const double* lower = column + width;
    for (Index i = 0; i < under; ++i) below[i] += lower[i] * xj;
  }
}

SUNDER_VECTORISED
void panel_backward(const double* panel, Index width, Index height, double* x,
                    const double* below) {
  constexpr Index kTogether = 4;
  const Index under = height - width;
  double sums[kTogether];
  for (Index end = width; end > 0;) {
    const Index begin = end >= kTogether ? end - kTogether : end - 1;
    const double* columns =
        panel + static_cast<std::size_t>(begin) * static_cast<std::size_t>(height);
    if (end - begin == kTogether) {
      dots<kTogether>(columns + width, height, under, below, sums);
    } else {
      dots<1>(columns + width, height, under, below, sums);
    }
    for (Index j = end - 1; j >= begin; --j) {
      const double* column =
          columns + static_cast<std::size_t>(j - begin) * static_cast<std::size_t>(height);
      double sum = sums[j - begin];
      for (Index r = j + 1; r < width; ++r) sum += column[r] * x[r];
      x[j] = (x[j] - sum) / column[j];
    }
    end = begin;
  }
}

}  // namespace sunder::fem
