// SPDX-License-Identifier: Apache-2.0
// What finite statics reports as error of stress against what a converged Newton's method says it
// is: seldom under half of it, in the median within a factor of two.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "material/corotated.hpp"
#include "material/neo_hookean.hpp"
#include "support/accuracy.hpp"
#include "support/finite_newton.hpp"
#include "support/finite_torn.hpp"
#include "support/sequences.hpp"

namespace sunder::solver {
namespace {

/// The paper's board: pulled, torn one by one, pulled farther.
std::vector<double> reported_over_true(const Law& law, double tolerance) {
  test::FiniteTorn torn(law, {.tolerance = tolerance});
  std::vector<double> ratios;
  const auto look_at = [&](double force) {
    const FiniteStaticsReport report = torn.pull(force);
    EXPECT_TRUE(report.at_rest) << force;
    EXPECT_LE(report.error, tolerance);
    const auto& u = torn.statics.displacement();
    const auto rest = test::newton(torn.body, torn.load(force), u);
    EXPECT_LE(rest.residual, 1e-11);
    ratios.push_back(report.error /
                     test::stress_error(torn.destroyed, torn.stress(u), torn.stress(rest.u)));
  };
  for (int i = 1; i <= 8; ++i) look_at(5.0 * i);
  for (Index e : test::crack_sequence(torn.problem, 12, 15)) {
    torn.tear({&e, 1});
    look_at(40);
  }
  for (int i = 1; i <= 4; ++i) look_at(40 + 2.5 * i);
  std::ranges::sort(ratios);
  return ratios;
}

class FinitePromise : public ::testing::TestWithParam<const Law*> {};

// bench_finite_stability has a larger sample, of extreme cases.
TEST_P(FinitePromise, IsSeldomUnderHalfAndInTheMedianWithinTwo) {
  const std::vector<double> of = reported_over_true(*GetParam(), 1e-4);
  std::printf("%s: reported over true error: least %.2f, median %.2f, most %.2f\n",
              GetParam()->name.data(), of.front(), of[of.size() / 2], of.back());
  EXPECT_GE(of.front(), 0.5);
  EXPECT_GE(of[of.size() / 2], 0.5);
  EXPECT_LE(of[of.size() / 2], 2);
}

INSTANTIATE_TEST_SUITE_P(Laws, FinitePromise, ::testing::Values(&kCorotated, &kNeoHookean),
                         [](const auto& law) {
                           return law.param == &kCorotated ? "corotated" : "neo_hookean";
                         });

}  // namespace
}  // namespace sunder::solver
