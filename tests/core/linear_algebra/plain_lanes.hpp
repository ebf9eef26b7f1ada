// SPDX-License-Identifier: Apache-2.0
// The kernels of panels and products once more, as a compiler without gcc's extensions makes them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::test {

/// A b, of a row-major b; packed: as packed_product() sums it; add: .3 of every entry and that.
[[nodiscard]] std::vector<double> plain_product(const Eigen::MatrixXd& a,
                                                const std::vector<double>& b, Index width,
                                                bool packed, bool add = false);
/// S x of a symmetric S, row by row at `stride`, n x n.
[[nodiscard]] std::vector<double> plain_symmetric_product(const std::vector<double>& s,
                                                          Index stride, Index n,
                                                          const std::vector<double>& x);
/// The same of a matrix that these rows and columns fill, each set by itself.
[[nodiscard]] std::vector<double> plain_filled_product(std::span<const std::vector<int>> filled,
                                                       const std::vector<double>& s, Index stride,
                                                       Index n, const std::vector<double>& x);
/// As the functions of panel_kernels.hpp without `plain_`.
void plain_forward_few(const double* panel, Index width, Index height, Index columns, double* x,
                       double* below, double* product, Index stride);
void plain_backward(const double* panel, Index width, Index height, double* x, const double* below,
                    double* solved);

}  // namespace sunder::test
