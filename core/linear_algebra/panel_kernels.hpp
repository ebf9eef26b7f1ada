// SPDX-License-Identifier: Apache-2.0
// Triangular solves with one panel of a supernodal factor: column-major, `height` rows, of which
// the first `width` are the triangle.
#pragma once

#include "sunder/types.hpp"

namespace sunder::linear_algebra {

/// Columns are read in vectors of so many entries: up to so many less one after a panel's end.
constexpr Index kPanelLanes = 8;

/// Right sides that are worth a pass of their own by columns of the panel.
constexpr Index kFewColumns = 4;

/// x (width) <- L1^-1 x; below (height - width) += L2 x.
void panel_forward(const double* panel, Index width, Index height, double* x, double* below);
/// The same for up to kFewColumns right sides, which begin `stride` apart in x and in below:
/// below <- L2 x up to a full vector. `product` has room for width + kPanelLanes values per right
/// side, `stride` apart too. Bit by bit what lower_solve() and row_product() make of them.
void panel_forward_few(const double* panel, Index width, Index height, Index columns, double* x,
                       double* below, double* product, Index stride);
/// x (width) <- L1^-T (x - L2^T below), with zeros after the end of `below` up to a full vector.
/// `solved` is room for width + kPanelLanes values. From `ahead` on is what will be read next.
void panel_backward(const double* panel, Index width, Index height, double* x, const double* below,
                    double* solved, const double* ahead, const double* ahead_end);

}  // namespace sunder::linear_algebra
