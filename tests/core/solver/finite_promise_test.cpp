// SPDX-License-Identifier: Apache-2.0
// What finite statics reports as error of stress against what a converged Newton's method says it
// is: seldom under half of it, in the median within a factor of two.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "material/corotated.hpp"
#include "material/neo_hookean.hpp"
#include "solver/finite_minimiser.hpp"
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

// Beside a frame that is a million times as stiff tissue has stress of its own, which errors are
// measured by; what rounding leaves of the frame's is less.
TEST(FiniteScale, IsThatOfTheSoftTissueInAStiffFrame) {
  for (double contrast : {1.0, 1e3, 1e6, 1e9}) {
    Scene scene = test::pulled_board();
    test::set_contrast(scene, contrast);
    const Problem problem(std::move(scene));
    double soft = HUGE_VAL, stiff = 0;
    for (Index e = 0; e < problem.tet_count(); ++e) {
      soft = std::min(soft, problem.small_strain(e).mu);
      stiff = std::max(stiff, problem.small_strain(e).mu);
    }
    const FiniteScale scale = finite_scale(problem);
    EXPECT_LE(scale.stress, 1e-9 * stiff);
    EXPECT_LE(scale.stress, std::max(1.0001e-6 * soft, 1.0001e-12 * stiff));
    EXPECT_GE(scale.stress, 9.999 * scale.stress_rounding);
  }
}

}  // namespace
}  // namespace sunder::solver
