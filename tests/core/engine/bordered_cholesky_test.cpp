// SPDX-License-Identifier: Apache-2.0
#include "engine/bordered_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace sunder::engine {
namespace {

Eigen::MatrixXd hilbert_plus_identity(Eigen::Index n) {
  Eigen::MatrixXd s = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) s(i, j) += 1.0 / static_cast<double>(i + j + 1);
  }
  return s;
}

bool grow(BorderedCholesky& l, const Eigen::MatrixXd& s, Eigen::Index to) {
  const Eigen::Index from = l.size();
  return l.append(s.block(0, from, from, to - from), s.block(from, from, to - from, to - from));
}

Eigen::VectorXd solve(const BorderedCholesky& l, Eigen::VectorXd x) {
  l.solve_lower(x);
  l.solve_upper(x);
  return x;
}

TEST(BorderedCholesky, GrowsToTheSameFactorInAnySteps) {
  const Eigen::MatrixXd s = hilbert_plus_identity(23);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(23, 1, 3);
  for (Eigen::Index step : {1, 6, 23}) {
    BorderedCholesky l;
    while (l.size() < 23) {
      ASSERT_TRUE(grow(l, s, std::min<Eigen::Index>(23, l.size() + step)));
    }
    EXPECT_LE((s * solve(l, b) - b).norm(), 1e-13) << "steps of " << step;
  }
}

TEST(BorderedCholesky, ShrinksBackBitByBit) {
  const Eigen::MatrixXd s = hilbert_plus_identity(30);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(12, 1, 3);
  BorderedCholesky l;
  ASSERT_TRUE(grow(l, s, 12));
  const Eigen::VectorXd before = solve(l, b);
  ASSERT_TRUE(grow(l, s, 30));
  l.shrink(12);
  EXPECT_EQ(solve(l, b), before);
}

TEST(BorderedCholesky, RefusesWhatIsNotPositiveDefiniteAndStaysAsItWas) {
  Eigen::MatrixXd s = hilbert_plus_identity(9);
  s(8, 8) = -1;
  BorderedCholesky l;
  ASSERT_TRUE(grow(l, s, 6));
  EXPECT_FALSE(grow(l, s, 9));
  EXPECT_EQ(l.size(), 6);
  s(8, 8) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(grow(l, s, 9));
  EXPECT_LE((s.topLeftCorner(6, 6) * solve(l, Eigen::VectorXd::Ones(6)) - Eigen::VectorXd::Ones(6))
                .norm(),
            1e-13);
}

TEST(BorderedCholesky, ContinuesRowsThatWereSolvedBefore) {
  const Eigen::MatrixXd s = hilbert_plus_identity(15);
  BorderedCholesky l;
  ASSERT_TRUE(grow(l, s, 10));
  const Eigen::MatrixXd b = Eigen::MatrixXd::Random(15, 3);
  Eigen::MatrixXd first = b.topRows(10);
  l.solve_lower(first);
  ASSERT_TRUE(grow(l, s, 15));
  Eigen::MatrixXd x = b, whole = b;
  x.topRows(10) = first;
  l.solve_lower_from(10, x);
  l.solve_lower(whole);
  EXPECT_LE((x - whole).norm(), 1e-14);
  EXPECT_EQ(x.topRows(10), first);
}

}  // namespace
}  // namespace sunder::engine
