// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/supernodal_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <limits>
#include <numeric>
#include <random>
#include <span>

#include "linear_algebra/factor.hpp"
#include "sunder/error.hpp"

namespace sunder::linear_algebra {
namespace {

/// Random sparse, diagonally dominant; n of no special form.
SparseMatrix random_matrix(Index n, int per_column, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (Index j = 0; j < n; ++j) {
    entries.emplace_back(j, j, 2.0 * per_column + 1);
    for (int k = 0; k < per_column; ++k) {
      const Index i = static_cast<Index>(generator() % static_cast<unsigned>(n));
      const double value = static_cast<double>(generator() % 1000) / 1000.0 - 0.5;
      if (i > j) entries.emplace_back(i, j, value);
      if (i < j) entries.emplace_back(j, i, value);
    }
  }
  SparseMatrix a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

Eigen::MatrixXd dense(const SparseMatrix& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

TEST(SupernodalCholesky, SolvesLikeADenseFactor) {
  for (Index n : {1, 2, 3, 43, 597}) {
    for (int per_column : {0, 1, 3}) {
      SCOPED_TRACE(std::to_string(n) + " unknowns, " + std::to_string(per_column) + " a column");
      const SparseMatrix a = random_matrix(n, per_column, 7);
      const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1, 2);
      const Eigen::VectorXd x = Factor(a).solve(b);
      const Eigen::VectorXd reference = dense(a).llt().solve(b);
      EXPECT_LE((x - reference).norm(), 1e-14 * n * reference.norm());
    }
  }
}

// A block of 64 right sides and some more; what each is does not depend on the others.
TEST(SupernodalCholesky, SolvesForSeveralRightSides) {
  const Index n = 211;
  const Factor factor(random_matrix(n, 2, 3));
  for (Index columns : {1, 12, 70}) {
    Eigen::MatrixXd x(n, columns);
    for (Index c = 0; c < columns; ++c) x.col(c) = Eigen::VectorXd::LinSpaced(n, c - 1, 2);
    const Eigen::MatrixXd b = x;
    RowMajor room;
    SolveWork work;
    factor.solve(x, room, work);
    for (Index c = 0; c < columns; ++c) {
      const Eigen::VectorXd alone = factor.solve(Eigen::VectorXd(b.col(c)));
      EXPECT_LE((x.col(c) - alone).norm(), 1e-14 * alone.norm()) << c;
    }
    Eigen::MatrixXd last = b.rightCols(1);
    factor.solve(last, room, work);
    EXPECT_EQ(last, x.rightCols(1));
  }
}

TEST(SupernodalCholesky, InvertsTheMatrix) {
  const SparseMatrix a = random_matrix(211, 2, 3);
  const Eigen::MatrixXd x = Factor(a).inverse();
  EXPECT_LE((x * dense(a) - Eigen::MatrixXd::Identity(211, 211)).norm(), 1e-12);
  EXPECT_EQ(x, x.transpose());
}

TEST(SupernodalCholesky, GivesSomeColumnsAtSomeRows) {
  const SparseMatrix a = random_matrix(211, 2, 3);
  const Factor factor(a);
  const std::vector<Index> rows{5, 210, 0, 77}, columns{210, 3, 3, 100, 8};
  const Eigen::MatrixXd block = factor.inverse_block(rows, columns);
  const Eigen::MatrixXd inverse = dense(a).inverse();
  EXPECT_LE((block - inverse(rows, columns)).norm(), 1e-14);
  EXPECT_LE((factor.inverse_columns(columns) - inverse(Eigen::all, columns)).norm(), 1e-14);
}

// What route condensed's region grows by may have been computed before, with other columns.
TEST(SupernodalCholesky, AnEntryHasTheSameBitsWhateverItIsComputedWith) {
  const Factor factor(random_matrix(597, 3, 5));
  std::vector<Index> rows(400), columns(90);
  std::iota(rows.begin(), rows.end(), 100);
  std::iota(columns.begin(), columns.end(), 3);
  const Eigen::MatrixXd all = factor.inverse_block(rows, columns);
  const std::vector<Index> fewer(rows.begin() + 20, rows.end());
  for (std::size_t k = 1; k <= 70; ++k) {
    for (std::size_t first : {0, 7}) {
      SCOPED_TRACE(std::to_string(k) + " from " + std::to_string(first));
      const auto some = std::span(columns).subspan(first, k);
      const auto begin = static_cast<Eigen::Index>(first), count = static_cast<Eigen::Index>(k);
      ASSERT_EQ(factor.inverse_block(rows, some), all.middleCols(begin, count));
      ASSERT_EQ(factor.inverse_block(fewer, some), all.bottomRows(380).middleCols(begin, count));
    }
  }
}

// Blocks of 64 columns, the last one of fewer; more threads than blocks.
TEST(SupernodalCholesky, SeveralThreadsGiveTheSameBits) {
  const Index n = 331;
  const Factor factor(random_matrix(n, 2, 3));
  std::vector<Index> rows(n), columns;
  std::iota(rows.begin(), rows.end(), 0);
  for (Index j = n - 1; j >= 0; j -= 2) columns.push_back(j);
  const Eigen::MatrixXd inverse = factor.inverse(), some = factor.inverse_columns(columns),
                        block = factor.inverse_block(columns, columns);
  for (const int threads : {2, 3, 16}) {
    SCOPED_TRACE(threads);
    const FactorWork work{.threads = threads};
    EXPECT_EQ(factor.inverse(work), inverse);
    EXPECT_EQ(factor.inverse_columns(columns, work), some);
    EXPECT_EQ(factor.inverse_block(columns, columns, work), block);
  }
}

TEST(SupernodalCholesky, AnInverseIsGivenUp) {
  const Factor factor(random_matrix(331, 2, 3));
  const std::atomic<bool> stop{true};
  const std::vector<Index> columns{3, 5};
  for (const int threads : {1, 3}) {
    const FactorWork work{.threads = threads, .stop = &stop};
    EXPECT_THROW((void)factor.inverse(work), Stopped);
    EXPECT_THROW((void)factor.inverse_columns(columns, work), Stopped);
    EXPECT_THROW((void)factor.inverse_block(columns, columns, work), Stopped);
  }
}

TEST(SupernodalCholesky, ForwardSolutionStaysOnItsPath) {
  const SparseMatrix a = random_matrix(597, 1, 11);
  const SupernodalCholesky l(a);
  for (Index row : {0, 17, 300, 596}) {
    const std::vector<Index> seeds{row};
    Eigen::VectorXd on_path = Eigen::VectorXd::Zero(597), full = on_path;
    on_path[row] = full[row] = 1;
    SolveWork work;
    std::vector<Index> path;
    l.reach(seeds, path, work);
    l.forward(path, on_path, work);
    l.forward(full, work);
    EXPECT_EQ(on_path, full) << "row " << row;
  }
}

TEST(SupernodalCholesky, SolvesForwardForFewRightSidesByTheBitsOfMany) {
  const SparseMatrix a = random_matrix(597, 3, 7);
  const SupernodalCholesky l(a);
  SolveWork work;
  std::vector<Index> path;
  for (Index columns : {1, 2, 3, 4}) {
    RowMajor few = RowMajor::Zero(597, 8);
    std::vector<Index> rows;
    for (Index c = 0; c < columns; ++c) {
      rows.push_back(3 + 40 * c);
      few(rows.back(), c) = 1 + c;
    }
    RowMajor many = few;
    l.reach(rows, path, work);
    l.forward(path, many, work);
    l.forward_few(path, few.leftCols(columns), work);
    EXPECT_EQ(few, many) << columns;
    EXPECT_GT(few.cwiseAbs().sum(), 0);
  }
}

TEST(SupernodalCholesky, SaysWhenAMatrixIsNotPositiveDefinite) {
  SparseMatrix a = random_matrix(43, 2, 5);
  a.coeffRef(20, 20) = -1;
  EXPECT_FALSE(SupernodalCholesky(a).succeeded());
  EXPECT_THROW(Factor{a}, NumericalError);
  a.coeffRef(20, 20) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(SupernodalCholesky(a).succeeded());
}

}  // namespace
}  // namespace sunder::linear_algebra
