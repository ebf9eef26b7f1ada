// SPDX-License-Identifier: Apache-2.0
// Triangular solves with one panel of a supernodal factor: column-major, `height` rows, of which
// the first `width` are the triangle.
#pragma once

#include "sunder/types.hpp"

namespace sunder::fem {

/// x (width) <- L1^-1 x; below (height - width) += L2 x.
void panel_forward(const double* panel, Index width, Index height, double* x, double* below);
/// x (width) <- L1^-T (x - L2^T below).
void panel_backward(const double* panel, Index width, Index height, double* x, const double* below);

}  // namespace sunder::fem
