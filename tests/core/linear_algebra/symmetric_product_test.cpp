// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/symmetric_product.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "linear_algebra/row_product.hpp"

namespace sunder::test {
namespace {

TEST(SymmetricProduct, IsThatOfTheWholeMatrixAndReadsTheLowerTriangleAlone) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (Eigen::Index n : {0, 1, 3, 4, 7, 8, 9, 15, 16, 20, 31, 64, 101}) {
    SCOPED_TRACE(n);
    const Eigen::Index stride = n + 5;
    linear_algebra::RowMajor s(n, stride);
    Eigen::VectorXd x(n), y = Eigen::VectorXd::Constant(n, 7);  // which says nothing
    for (double& v : s.reshaped()) v = any(generator);
    for (double& v : x) v = any(generator);
    const Eigen::MatrixXd whole = s.leftCols(n).selfadjointView<Eigen::Lower>();
    for (Eigen::Index i = 0; i < n; ++i) {
      s.row(i).tail(stride - i - 1).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    linear_algebra::symmetric_product(s.data(), stride, n, x.data(), y.data());
    // Each entry is a sum of n products of numbers up to 1.
    const double rounding = static_cast<double>(n * n) * std::numeric_limits<double>::epsilon();
    EXPECT_LE((y - whole * x).lpNorm<1>(), rounding);
  }
}

}  // namespace
}  // namespace sunder::test
