// SPDX-License-Identifier: Apache-2.0
// What a compiler without vectors of numbers makes of the kernels has the bits of what gcc makes.
#include "plain_lanes.hpp"

#include <gtest/gtest.h>

#include <random>

#include "linear_algebra/filled_blocks.hpp"
#include "linear_algebra/panel_kernels.hpp"
#include "linear_algebra/row_product.hpp"
#include "linear_algebra/symmetric_product.hpp"

namespace sunder::test {
namespace {

std::vector<double> random_values(Index count) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<double> values(static_cast<std::size_t>(count));
  for (double& v : values) v = any(generator);
  return values;
}

TEST(PlainLanes, GiveProductsOfTheSameBits) {
  for (Index rows : {1, 4, 9, 17, 28}) {
    for (Index width : {1, 3, 8, 15, 16, 35, 64}) {
      const Index inner = 23;
      const auto left = random_values(rows * inner), b = random_values(inner * width);
      const Eigen::MatrixXd a = Eigen::Map<const Eigen::MatrixXd>(left.data(), rows, inner);
      const linear_algebra::LeftFactor factor = linear_algebra::plain(a);
      std::vector<double> c(static_cast<std::size_t>(rows * width)), packed = c, room;
      linear_algebra::row_product(factor, b.data(), width, width, c.data(), width);
      EXPECT_EQ(plain_product(a, b, width, false), c) << rows << " x " << width;
      std::vector<double> added(c.size(), 0.3);
      linear_algebra::row_product_add(factor, b.data(), width, width, added.data(), width);
      EXPECT_EQ(plain_product(a, b, width, false, true), added) << rows << " x " << width;
      linear_algebra::packed_product(factor, b.data(), width, width, packed.data(), width, room);
      EXPECT_EQ(plain_product(a, b, width, true), packed) << rows << " x " << width;
    }
  }
}

TEST(PlainLanes, GiveSymmetricProductsOfTheSameBits) {
  for (Index n = 1; n <= 41; ++n) {
    const Index stride = n + 3;
    const auto s = random_values(stride * n), x = random_values(n);
    std::vector<double> y(x.size());
    linear_algebra::symmetric_product(s.data(), stride, n, x.data(), y.data());
    EXPECT_EQ(plain_symmetric_product(s, stride, n, x), y) << n;
  }
}

TEST(PlainLanes, GiveProductsOfFilledBlocksOfTheSameBits) {
  for (Index n : {1, 3, 8, 13, 41, 700}) {
    const Index stride = linear_algebra::padded(n) + 8;
    std::vector<std::vector<int>> filled;
    for (int e = 0; e < n; e += 2) filled.push_back({e, (e * 7 + 1) % n, (e * 11 + 5) % n});
    auto x = random_values(stride);
    std::vector<double> s(static_cast<std::size_t>(n * stride), 0.0),
        y(static_cast<std::size_t>(n));
    const auto values = random_values(n * stride);
    linear_algebra::FilledBlocks blocks;
    blocks.reserve(n);
    for (const std::vector<int>& rows : filled) {
      blocks.add(rows);
      for (int i : rows) {
        for (int j : rows) s[i * stride + j] = values[i * stride + j];
      }
    }
    blocks.multiply(s.data(), stride, n, x.data(), y.data());
    EXPECT_EQ(plain_filled_product(filled, s, stride, n, x), y) << n;
  }
}

TEST(PlainLanes, SolveToTheSameBits) {
  for (Index width : {1, 7, 8, 17, 40}) {
    for (Index under : {0, 1, 13, 32}) {
      const Index height = width + under, lanes = linear_algebra::kPanelLanes;
      auto panel = random_values(height * width + lanes);
      for (Index i = 0; i < width; ++i) panel[static_cast<std::size_t>(i * height + i)] += 9.0;
      for (Index columns = 1; columns <= linear_algebra::kFewColumns; ++columns) {
        const Index stride = height + lanes;
        auto x = random_values(stride * columns), y = x;
        auto below = std::vector<double>(x.size()), product = below, below_too = below;
        linear_algebra::panel_forward_few(panel.data(), width, height, columns, x.data(),
                                          below.data(), product.data(), stride);
        plain_forward_few(panel.data(), width, height, columns, y.data(), below_too.data(),
                          product.data(), stride);
        EXPECT_EQ(x, y) << width << " over " << under;
        EXPECT_EQ(below, below_too) << width << " over " << under;
      }
      auto x = random_values(height + lanes), y = x, solved = x, below = x;
      std::fill(below.begin() + under, below.end(), 0.0);
      linear_algebra::panel_backward(panel.data(), width, height, x.data(), below.data(),
                                     solved.data(), panel.data(), panel.data());
      plain_backward(panel.data(), width, height, y.data(), below.data(), solved.data());
      EXPECT_EQ(x, y) << width << " over " << under;
    }
  }
}

}  // namespace
}  // namespace sunder::test
