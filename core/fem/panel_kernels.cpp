// SPDX-License-Identifier: Apache-2.0
#include "fem/panel_kernels.hpp"

#include "engine/vectorised.hpp"

namespace sunder::fem {
namespace {

// Dot products are kept in this many partial sums, so that their bits do not depend on the width
// of the processor's vectors.
constexpr int kLanes = 16;

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
  const Index under = height - width;
  for (Index j = width - 1; j >= 0; --j) {
    const double* column = panel + static_cast<std::size_t>(j) * static_cast<std::size_t>(height);
    const double* lower = column + width;
    double lanes[kLanes] = {};
    Index i = 0;
    for (; i + kLanes <= under; i += kLanes) {
      for (int l = 0; l < kLanes; ++l) lanes[l] += lower[i + l] * below[i + l];
    }
    for (int l = 0; i < under; ++i, ++l) lanes[l] += lower[i] * below[i];
    double sum = 0;
    for (int l = 0; l < kLanes; ++l) sum += lanes[l];
    for (Index r = j + 1; r < width; ++r) sum += column[r] * x[r];
    x[j] = (x[j] - sum) / column[j];
  }
}

}  // namespace sunder::fem
