// SPDX-License-Identifier: Apache-2.0
// The sources themselves, in a namespace of another name and without extensions.
#include "plain_lanes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#define SUNDER_PLAIN_COMPILER
#define linear_algebra plain_linear_algebra
#include "../core/linear_algebra/filled_blocks.cpp"
#include "../core/linear_algebra/panel_kernels.cpp"
#include "../core/linear_algebra/row_product.cpp"
#include "../core/linear_algebra/symmetric_product.cpp"

namespace sunder::test {

std::vector<double> plain_product(const Eigen::MatrixXd& a, const std::vector<double>& b,
                                  Index width, bool packed, bool add) {
  std::vector<double> c(static_cast<std::size_t>(a.rows() * width), 0.3), room;
  const linear_algebra::LeftFactor left = linear_algebra::plain(a);
  if (packed) {
    linear_algebra::packed_product(left, b.data(), width, width, c.data(), width, room);
  } else if (add) {
    linear_algebra::row_product_add(left, b.data(), width, width, c.data(), width);
  } else {
    linear_algebra::row_product(left, b.data(), width, width, c.data(), width);
  }
  return c;
}

std::vector<double> plain_symmetric_product(const std::vector<double>& s, Index stride, Index n,
                                            const std::vector<double>& x) {
  std::vector<double> y(x.size());
  linear_algebra::symmetric_product(s.data(), stride, n, x.data(), y.data());
  return y;
}

std::vector<double> plain_filled_product(std::span<const std::vector<int>> filled,
                                         const std::vector<double>& s, Index stride, Index n,
                                         const std::vector<double>& x) {
  linear_algebra::FilledBlocks blocks;
  blocks.reserve(n);
  for (const std::vector<int>& rows : filled) blocks.add(rows);
  std::vector<double> y(static_cast<std::size_t>(n));
  blocks.multiply(s.data(), stride, n, x.data(), y.data());
  return y;
}

void plain_forward_few(const double* panel, Index width, Index height, Index columns, double* x,
                       double* below, double* product, Index stride) {
  linear_algebra::panel_forward_few(panel, width, height, columns, x, below, product, stride);
}

void plain_backward(const double* panel, Index width, Index height, double* x, const double* below,
                    double* solved) {
  linear_algebra::panel_backward(panel, width, height, x, below, solved, panel, panel);
}

}  // namespace sunder::test
