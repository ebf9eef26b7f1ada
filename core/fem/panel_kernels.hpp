// SPDX-License-Identifier: Apache-2.0
// Triangular solves with one panel of a supernodal factor: column-major, `height` rows, of which
// the first `width` are the triangle.
#pragma once

#include "sunder/types.hpp"

namespace sunder::fem {

/// Columns are read in vectors of so many entries: up to so many less one after a panel's end.
constexpr Index kPanelLanes = 8;

/// x (width) <- L1^-1 x; below (height - width) += L2 x.
void panel_forward(const double* panel, Index width, Index height, double* x, double* below);
/// x (width) <- L1^-T (x - L2^T below), with zeros after the end of `below` up to a full vector.
/// `solved` is room for width + kPanelLanes values. From `ahead` on is what will be read next.
void panel_backward(const double* panel, Index width, Index height, double* x, const double* below,
                    double* solved, const double* ahead, const double* ahead_end);

}  // namespace sunder::fem
