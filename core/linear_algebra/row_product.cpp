// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/row_product.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "machine/compiler.hpp"

namespace sunder::linear_algebra {
namespace {

using Index = Eigen::Index;
constexpr Index kLanes = 8;
using Lanes = machine::Lanes8;
using HalfLanes = machine::Lanes4;

template <class Vector>
SUNDER_FORCE_INLINE void load(const double* p, Vector& v) {
  std::memcpy(&v, p, sizeof(v));
}
template <class Vector>
SUNDER_FORCE_INLINE void store(double* p, const Vector& v) {
  std::memcpy(p, &v, sizeof(v));
}

/// Whether a processor keeps four rows of sixteen sums in registers of eight numbers each. Another
/// keeps four rows of eight in registers of four; more would go through memory (on a processor with
/// AVX2: .8 instead of 3 Gflop/s and more). Every sum is the same by both.
SUNDER_FORCE_INLINE bool wide_registers() { return machine::wide_registers(); }

/// Rows x (some vectors) entries of c, kept in registers.
template <bool Add, int Rows, class Vector, int kVectors = 2>
SUNDER_FORCE_INLINE void tile(const LeftFactor& a, Index row, const double* b, Index b_stride,
                              double* c, Index c_stride) {
  constexpr Index kEach = sizeof(Vector) / sizeof(double);
  Vector sum[Rows][kVectors] = {};
  for (int r = 0; Add && r < Rows; ++r) {
    for (int v = 0; v < kVectors; ++v) load(c + r * c_stride + v * kEach, sum[r][v]);
  }
  const double* left = a.data + row * a.row_stride;
  for (Index k = 0; k < a.columns; ++k, left += a.column_stride, b += b_stride) {
    Vector right[kVectors];
    for (int v = 0; v < kVectors; ++v) load(b + v * kEach, right[v]);
    for (int r = 0; r < Rows; ++r) {
      const double l = left[r * a.row_stride];
      for (int v = 0; v < kVectors; ++v) sum[r][v] += l * right[v];
    }
  }
  for (int r = 0; r < Rows; ++r) {
    for (int v = 0; v < kVectors; ++v) store(c + r * c_stride + v * kEach, sum[r][v]);
  }
}

template <bool Add, class Vector, int kRows = 4, int kVectors = 2>
SUNDER_FORCE_INLINE void strip(const LeftFactor& a, const double* b, Index b_stride, double* c,
                               Index c_stride) {
  Index i = 0;
  for (; i + kRows <= a.rows; i += kRows) {
    tile<Add, kRows, Vector, kVectors>(a, i, b, b_stride, c + i * c_stride, c_stride);
  }
  for (; kRows > 4 && i + 4 <= a.rows; i += 4) {
    tile<Add, 4, Vector, kVectors>(a, i, b, b_stride, c + i * c_stride, c_stride);
  }
  for (; i < a.rows; ++i) {
    tile<Add, 1, Vector, kVectors>(a, i, b, b_stride, c + i * c_stride, c_stride);
  }
}

template <bool Add>
SUNDER_FORCE_INLINE void product(const LeftFactor& a, const double* b, Index b_stride, Index width,
                                 double* c, Index c_stride) {
  Index j = 0;
  for (; wide_registers() && j + 2 * kLanes <= width; j += 2 * kLanes) {
    strip<Add, Lanes>(a, b + j, b_stride, c + j, c_stride);
  }
  for (; wide_registers() && j + kLanes <= width; j += kLanes) {
    strip<Add, Lanes, 8, 1>(a, b + j, b_stride, c + j, c_stride);
  }
  for (; j + kLanes <= width; j += kLanes) {
    strip<Add, HalfLanes>(a, b + j, b_stride, c + j, c_stride);
  }
  if (j == width) return;
  // The last columns, padded with zeros to a full vector.
  const Index rest = width - j;
  std::vector<double> padded(static_cast<std::size_t>((a.columns + a.rows) * kLanes), 0.0);
  for (Index k = 0; k < a.columns; ++k) {
    std::copy_n(b + k * b_stride + j, rest, &padded[static_cast<std::size_t>(k * kLanes)]);
  }
  double* result = padded.data() + a.columns * kLanes;
  for (Index i = 0; Add && i < a.rows; ++i) {
    std::copy_n(c + i * c_stride + j, rest, result + i * kLanes);
  }
  strip<Add, HalfLanes>(a, padded.data(), kLanes, result, kLanes);
  for (Index i = 0; i < a.rows; ++i) {
    std::copy_n(result + i * kLanes, rest, c + i * c_stride + j);
  }
}

constexpr Index kTile = 4;

/// Of a strip of b whose rows lie together, and tiles of A that do.
template <class Vector>
SUNDER_FORCE_INLINE void packed_strip(const LeftFactor& a, const std::vector<double>& tiles_room,
                                      const double* b, double* c, Index c_stride) {
  constexpr Index kStrip = 2 * sizeof(Vector) / sizeof(double);
  const Index tiles = a.rows / kTile, packed = kTile * a.columns;
  for (Index t = 0; t < tiles; ++t) {
    tile<false, kTile, Vector>({tiles_room.data() + t * packed, kTile, a.columns, 1, kTile}, 0, b,
                               kStrip, c + kTile * t * c_stride, c_stride);
  }
  for (Index i = kTile * tiles; i < a.rows; ++i) {
    tile<false, 1, Vector>(a, i, b, kStrip, c + i * c_stride, c_stride);
  }
}

}  // namespace

SUNDER_VECTORISED
void row_product(const LeftFactor& a, const double* b, Index b_stride, Index width, double* c,
                 Index c_stride) {
  product<false>(a, b, b_stride, width, c, c_stride);
}

SUNDER_VECTORISED
void row_product_add(const LeftFactor& a, const double* b, Index b_stride, Index width, double* c,
                     Index c_stride) {
  product<true>(a, b, b_stride, width, c, c_stride);
}

SUNDER_VECTORISED
void packed_product(const LeftFactor& a, const double* b, Index b_stride, Index width, double* c,
                    Index c_stride, std::vector<double>& room) {
  const bool wide = wide_registers();
  const Index strip_width = wide ? 2 * kLanes : kLanes;
  const Index tiles = a.rows / kTile, strips = width / strip_width;
  if (tiles < 2 || strips < 2) {
    product<false>(a, b, b_stride, width, c, c_stride);
    return;
  }
  const Index packed = kTile * a.columns, left = tiles * packed;
  room.resize(std::max(room.size(), static_cast<std::size_t>(left + strip_width * a.columns)));
  for (Index t = 0; t < tiles; ++t) {
    for (Index k = 0; k < a.columns; ++k) {
      const double* from = a.data + kTile * t * a.row_stride + k * a.column_stride;
      double* to = room.data() + t * packed + kTile * k;
      for (Index r = 0; r < kTile; ++r) to[r] = from[r * a.row_stride];
    }
  }
  double* strip_room = room.data() + left;
  for (Index j = 0; j < strips * strip_width; j += strip_width) {
    for (Index k = 0; k < a.columns; ++k) {
      std::memcpy(strip_room + k * strip_width, b + k * b_stride + j, strip_width * sizeof(double));
    }
    wide ? packed_strip<Lanes>(a, room, strip_room, c + j, c_stride)
         : packed_strip<HalfLanes>(a, room, strip_room, c + j, c_stride);
  }
  const Index done = strips * strip_width;
  if (done < width) product<false>(a, b + done, b_stride, width - done, c + done, c_stride);
}

// Blocks of columns: their own triangle row by row, the rest by a product.
SUNDER_VECTORISED
void lower_solve(const double* l, Index l_stride, Index n, double* x, Index x_stride, Index width,
                 double* product_room) {
  constexpr Index kColumns = 16;
  for (Index begin = 0; begin < n; begin += kColumns) {
    const Index end = std::min(begin + kColumns, n);
    for (Index j = begin; j < end; ++j) {
      const double* column = l + j * l_stride;
      double* solved = x + j * x_stride;
      for (Index c = 0; c < width; ++c) solved[c] /= column[j];
      for (Index i = j + 1; i < end; ++i) {
        double* row = x + i * x_stride;
        for (Index c = 0; c < width; ++c) row[c] -= column[i] * solved[c];
      }
    }
    if (end == n) return;
    product<false>({l + begin * l_stride + end, n - end, end - begin, 1, l_stride},
                   x + begin * x_stride, x_stride, width, product_room, width);
    for (Index i = end; i < n; ++i) {
      const double* from = product_room + (i - end) * width;
      for (Index c = 0; c < width; ++c) x[i * x_stride + c] -= from[c];
    }
  }
}

SUNDER_VECTORISED
void upper_solve(const double* l, Index l_stride, Index n, double* x, Index x_stride, Index width,
                 double* product_room) {
  for (Index end = n; end > 0;) {
    const Index begin = (end - 1) / kBackRows * kBackRows;
    if (end < n) {
      product<false>({l + begin * l_stride + end, end - begin, n - end, l_stride, 1},
                     x + end * x_stride, x_stride, width, product_room, width);
      for (Index i = begin; i < end; ++i) {
        const double* from = product_room + (i - begin) * width;
        for (Index c = 0; c < width; ++c) x[i * x_stride + c] -= from[c];
      }
    }
    for (Index j = end; j-- > begin;) {
      const double* column = l + j * l_stride;
      double* row = x + j * x_stride;
      for (Index i = j + 1; i < end; ++i) {
        const double* solved = x + i * x_stride;
        for (Index c = 0; c < width; ++c) row[c] -= column[i] * solved[c];
      }
      for (Index c = 0; c < width; ++c) row[c] /= column[j];
    }
    end = begin;
  }
}

}  // namespace sunder::linear_algebra
