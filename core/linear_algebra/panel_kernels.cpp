// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/panel_kernels.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "machine/compiler.hpp"

namespace sunder::linear_algebra {
namespace {

using Lanes = machine::Lanes8;
static_assert(sizeof(Lanes) == kPanelLanes * sizeof(double));
constexpr int kTogether = 8;  // columns

SUNDER_FORCE_INLINE void load(const double* p, Lanes& v) { std::memcpy(&v, p, sizeof(v)); }

/// What is to be read next, line by line of the cache: backward, panels are read from the last one
/// on, and the processor's own prefetching goes the other way.
struct Ahead {
  const double *at, *end;
  SUNDER_FORCE_INLINE void ask() {
    if (at < end) machine::prefetch(at);
    at += kPanelLanes;
  }
};

/// sums[c] = column c . v over whole vectors, for columns that begin `stride` apart. The order of
/// each sum is fixed: lanes, then (((0+4)+(2+6)) + ((1+5)+(3+7))).
template <int Columns>
SUNDER_FORCE_INLINE void dots(const double* columns, std::ptrdiff_t stride, Index vectors,
                              const double* v, double* sums, Ahead& ahead) {
  Lanes sum[Columns] = {};
  for (Index i = 0; i < vectors; ++i) {
    Lanes right, left;
    load(v + i * kPanelLanes, right);
    for (int c = 0; c < Columns; ++c) {
      ahead.ask();
      load(columns + c * stride + i * kPanelLanes, left);
      sum[c] += left * right;
    }
  }
  for (int c = 0; c < Columns; ++c) {
    const Lanes& s = sum[c];
    sums[c] = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
  }
}

/// The same for any number of columns up to kTogether.
SUNDER_FORCE_INLINE void some_dots(const double* columns, std::ptrdiff_t stride, Index count,
                                   Index vectors, const double* v, double* sums, Ahead& ahead) {
  if (count == kTogether) {
    dots<kTogether>(columns, stride, vectors, v, sums, ahead);
    return;
  }
  Index c = 0;
  for (; c + 4 <= count; c += 4) {
    dots<4>(columns + c * stride, stride, vectors, v, sums + c, ahead);
  }
  for (; c + 2 <= count; c += 2) {
    dots<2>(columns + c * stride, stride, vectors, v, sums + c, ahead);
  }
  for (; c < count; ++c) dots<1>(columns + c * stride, stride, vectors, v, sums + c, ahead);
}

Index vectors_of(Index n) { return (n + kPanelLanes - 1) / kPanelLanes; }

/// t_c += L x_c for some right sides c, in the order of L's columns; whole vectors of rows.
template <int Few>
SUNDER_FORCE_INLINE void add_columns(const double* l, std::ptrdiff_t l_stride, Index columns,
                                     Index vectors, const double* x, double* t,
                                     std::ptrdiff_t stride) {
  constexpr int kAtOnce = 4;
  Index k = 0;
  for (; k + kAtOnce <= columns; k += kAtOnce, l += kAtOnce * l_stride) {
    for (Index i = 0; i < vectors * kPanelLanes; i += kPanelLanes) {
      Lanes left[kAtOnce], sum;
      for (int a = 0; a < kAtOnce; ++a) load(l + a * l_stride + i, left[a]);
      for (int c = 0; c < Few; ++c) {
        load(t + c * stride + i, sum);
        for (int a = 0; a < kAtOnce; ++a) sum += left[a] * x[c * stride + k + a];
        std::memcpy(t + c * stride + i, &sum, sizeof(sum));
      }
    }
  }
  for (; k < columns; ++k, l += l_stride) {
    for (Index i = 0; i < vectors * kPanelLanes; i += kPanelLanes) {
      Lanes left, sum;
      load(l + i, left);
      for (int c = 0; c < Few; ++c) {
        load(t + c * stride + i, sum);
        sum += left * x[c * stride + k];
        std::memcpy(t + c * stride + i, &sum, sizeof(sum));
      }
    }
  }
}

template <int Few>
SUNDER_FORCE_INLINE void forward_few(const double* panel, Index width, Index height, double* x,
                                     double* below, double* product, std::ptrdiff_t stride) {
  constexpr Index kColumns = 16;  // as in lower_solve()
  const std::ptrdiff_t tall = height;
  for (Index begin = 0; begin < width; begin += kColumns) {
    const Index end = std::min<Index>(begin + kColumns, width);
    for (Index j = begin; j < end; ++j) {
      const double* column = panel + j * tall;
      for (int c = 0; c < Few; ++c) {
        double* of = x + c * stride;
        of[j] /= column[j];
        for (Index i = j + 1; i < end; ++i) of[i] -= column[i] * of[j];
      }
    }
    if (end == width) break;
    const Index vectors = vectors_of(width - end);
    for (int c = 0; c < Few; ++c) std::fill_n(product + c * stride, vectors * kPanelLanes, 0.0);
    add_columns<Few>(panel + begin * tall + end, tall, end - begin, vectors, x + begin, product,
                     stride);
    for (int c = 0; c < Few; ++c) {
      for (Index i = end; i < width; ++i) x[c * stride + i] -= product[c * stride + i - end];
    }
  }
  const Index under = vectors_of(height - width);
  for (int c = 0; c < Few; ++c) std::fill_n(below + c * stride, under * kPanelLanes, 0.0);
  add_columns<Few>(panel + width, tall, width, under, x, below, stride);
}

}  // namespace

SUNDER_VECTORISED
void panel_forward_few(const double* panel, Index width, Index height, Index columns, double* x,
                       double* below, double* product, Index stride) {
  switch (columns) {
    case 1:
      return forward_few<1>(panel, width, height, x, below, product, stride);
    case 2:
      return forward_few<2>(panel, width, height, x, below, product, stride);
    case 3:
      return forward_few<3>(panel, width, height, x, below, product, stride);
    default:
      return forward_few<kFewColumns>(panel, width, height, x, below, product, stride);
  }
}

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
void panel_backward(const double* panel, Index width, Index height, double* x, const double* below,
                    double* solved, const double* ahead, const double* ahead_end) {
  const std::ptrdiff_t stride = height;
  Ahead next{ahead, ahead_end};
  double sums[kTogether];
  const Index under = vectors_of(height - width);
  for (Index begin = 0; begin < width; begin += kTogether) {
    const Index count = std::min<Index>(kTogether, width - begin);
    some_dots(panel + begin * stride + width, stride, count, under, below, sums, next);
    for (Index j = 0; j < count; ++j) x[begin + j] -= sums[j];
  }
  std::fill_n(solved + width, kPanelLanes, 0.0);
  for (Index end = width; end > 0;) {
    const Index begin = (end - 1) / kTogether * kTogether, count = end - begin;
    const double* columns = panel + begin * stride + begin;
    double b[kTogether], inverse[kTogether];
    for (Index j = 0; j < count; ++j) inverse[j] = 1 / columns[j * stride + j];
    some_dots(columns + count, stride, count, vectors_of(width - end), solved + end, sums, next);
    for (Index j = 0; j < count; ++j) b[j] = x[begin + j] - sums[j];
    for (Index j = count - 1; j >= 0; --j) {
      const double xj = b[j] * inverse[j];
      x[begin + j] = solved[begin + j] = xj;
      for (Index i = 0; i < j; ++i) b[i] -= columns[i * stride + j] * xj;
    }
    end = begin;
  }
}

}  // namespace sunder::linear_algebra
