// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/filled_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace sunder::test {
namespace {

using linear_algebra::padded;

/// A matrix of elements that share few of their unknowns, and the vectors of its products.
struct Sparse {
  explicit Sparse(Eigen::Index unknowns)
      : n(unknowns),
        s(linear_algebra::RowMajor::Zero(n, padded(n) + 8)),
        x(Eigen::VectorXd::Zero(padded(n))) {
    for (Eigen::Index i = 0; i < n; ++i) x[i] = any();
  }
  double any() { return std::uniform_real_distribution<double>(-1, 1)(generator); }
  /// The unknowns of the next element.
  std::vector<int> add() {
    std::vector<int> rows;
    for (int i = 0; i < 9; ++i) rows.push_back(static_cast<int>(generator() % n));
    for (int i : rows) {
      for (int j : rows) s(i, j) += any();
    }
    return rows;
  }
  [[nodiscard]] Eigen::VectorXd product(const linear_algebra::FilledBlocks& blocks) const {
    Eigen::VectorXd y = Eigen::VectorXd::Constant(n, 7);  // which says nothing
    blocks.multiply(s.data(), s.outerStride(), n, x.data(), y.data());
    return y;
  }
  void expect_whole(const linear_algebra::FilledBlocks& blocks) const {
    const double rounding = static_cast<double>(100 * n) * std::numeric_limits<double>::epsilon();
    EXPECT_LE((product(blocks) - s.leftCols(padded(n)).topRows(n) * x).lpNorm<1>(), rounding);
  }

  Eigen::Index n;
  linear_algebra::RowMajor s;
  Eigen::VectorXd x;
  std::mt19937 generator{5};
};

TEST(FilledBlocks, ReadWhatElementsHaveFilledAndNothingElse) {
  for (Eigen::Index n : {1, 7, 8, 9, 64, 511, 512, 513, 1030}) {
    SCOPED_TRACE(n);
    Sparse of(n);
    linear_algebra::FilledBlocks blocks;
    blocks.reserve(n);
    EXPECT_EQ(of.product(blocks), Eigen::VectorXd::Zero(n));
    for (int e = 0; e < 20; ++e) blocks.add(of.add());
    of.expect_whole(blocks);
    if (n < 100) continue;
    // A block that nothing has filled in four rows is not read.
    const linear_algebra::RowMajor s = of.s;
    for (Eigen::Index i = 0; i < n; i += 4) {
      const Eigen::Index rows = std::min<Eigen::Index>(4, n - i);
      for (Eigen::Index j = 0; j < n; j += 8) {
        auto block = of.s.block(i, j, rows, 8);
        if (block.isZero(0)) block.setConstant(HUGE_VAL);
      }
    }
    EXPECT_TRUE(of.product(blocks).allFinite());
    of.s = s;
    blocks.clear();
    EXPECT_EQ(of.product(blocks), Eigen::VectorXd::Zero(n));
  }
}

TEST(FilledBlocks, AreFoundInAMatrixAndStayWhereThereIsMoreRoom) {
  Sparse of(1200);
  linear_algebra::FilledBlocks added, found;
  added.reserve(of.n);
  for (int e = 0; e < 50; ++e) added.add(of.add());
  found.reserve(of.n);
  found.find(of.s, of.n);
  const Eigen::VectorXd y = of.product(added);
  EXPECT_GT(y.norm(), 0);
  EXPECT_EQ(of.product(found), y);
  found.reserve(5000);
  EXPECT_EQ(of.product(found), y);
  // Blocks of zeros change no bit.
  std::vector<int> all(static_cast<std::size_t>(of.n));
  for (int i = 0; i < of.n; ++i) all[static_cast<std::size_t>(i)] = i;
  found.add(all);
  EXPECT_EQ(of.product(found), y);
}

}  // namespace
}  // namespace sunder::test
