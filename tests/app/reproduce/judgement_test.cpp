// SPDX-License-Identifier: Apache-2.0
// Verdicts on numbers made by hand: each rule on both sides of each of its limits.
#include "app/reproduce/judgement.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sunder::test {
namespace {

using namespace app::reproduce;
using enum Verdict;

constexpr std::nullopt_t none = std::nullopt;

TEST(Judgement, OneCrack) {
  EXPECT_EQ(judge_one_crack({0.9, 0.5}).verdict, reproduced);
  EXPECT_EQ(judge_one_crack({0.89, 0.5}).verdict, partly);
  EXPECT_EQ(judge_one_crack({0.9, 0.49}).verdict, partly);
  EXPECT_EQ(judge_one_crack({0.89, 0.49}).verdict, no);
  EXPECT_EQ(judge_one_crack({none, none}).verdict, no);
}

TEST(Judgement, PeakAtTip) {
  using Distances = std::vector<std::optional<double>>;
  EXPECT_EQ(judge_peak_at_tip(Distances{0.1, 3.0, 1.0, 9.0}).verdict, reproduced);
  EXPECT_EQ(judge_peak_at_tip(Distances{0.1, 3.0, 3.1, 9.0}).verdict, partly);
  EXPECT_EQ(judge_peak_at_tip(Distances{0.1, 3.1, 3.1, 9.0}).verdict, no);
  EXPECT_EQ(judge_peak_at_tip(Distances{none, none}).verdict, no);
  EXPECT_EQ(judge_peak_at_tip({}).verdict, no);
}

TEST(Judgement, ModelsDiffer) {
  EXPECT_EQ(judge_models_differ(0.5).verdict, reproduced);
  EXPECT_EQ(judge_models_differ(0.51).verdict, partly);
  EXPECT_EQ(judge_models_differ(0.81).verdict, no);
  EXPECT_EQ(judge_models_differ(none).verdict, no);
}

TEST(Judgement, UpThenDown) {
  EXPECT_EQ(judge_up_then_down(Turns{6, -6, 3, 1, -0.2}).verdict, reproduced);
  EXPECT_EQ(judge_up_then_down(Turns{6, -4.9, 3, 2, 0}).verdict, partly);
  EXPECT_EQ(judge_up_then_down(Turns{4.9, -6, 3, 1, 0}).verdict, no);
  EXPECT_EQ(judge_up_then_down(Turns{0, -20, 0, -9, 0}).verdict, no);  // down only
  EXPECT_EQ(judge_up_then_down(Turns{6, 0, 3, 3, -1}).verdict, no);    // down, then up
  EXPECT_EQ(judge_up_then_down(none).verdict, no);
}

TEST(Judgement, LowerForce) {
  EXPECT_EQ(judge_lower_force(95, 100, "a", "b").verdict, reproduced);
  EXPECT_EQ(judge_lower_force(96, 100, "a", "b").verdict, partly);
  EXPECT_EQ(judge_lower_force(100, 100, "a", "b").verdict, no);
  EXPECT_EQ(judge_lower_force(101, 100, "a", "b").verdict, no);
  EXPECT_EQ(judge_lower_force(none, 100, "a", "b").verdict, no);
  EXPECT_EQ(judge_lower_force(95, none, "a", "b").verdict, no);
  EXPECT_EQ(judge_lower_force(std::nan(""), 100, "a", "b").verdict, no);
}

TEST(Judgement, GoesFurther) {
  EXPECT_EQ(judge_goes_further(21, 20).verdict, reproduced);
  EXPECT_EQ(judge_goes_further(20.5, 20).verdict, partly);
  EXPECT_EQ(judge_goes_further(20, 20).verdict, no);
  EXPECT_EQ(judge_goes_further(5, 0).verdict, reproduced);  // the far one does not start
  EXPECT_EQ(judge_goes_further(0, 0).verdict, no);
}

TEST(Judgement, Sides) {
  EXPECT_EQ(judge_sides({12, 1, -9}).verdict, reproduced);
  EXPECT_EQ(judge_sides({12, 10.5, -9}).verdict, no);    // not 2 deg apart
  EXPECT_EQ(judge_sides({30, 11, -9}).verdict, partly);  // balanced is not straight
  EXPECT_EQ(judge_sides({12, 6, 1}).verdict, partly);    // under goes up
  EXPECT_EQ(judge_sides({-9, 1, 12}).verdict, no);       // the wrong way round
  EXPECT_EQ(judge_sides({12, none, -9}).verdict, no);
}

TEST(Judgement, SideForces) {
  EXPECT_EQ(judge_side_forces({30, 40, 50}).verdict, reproduced);
  EXPECT_EQ(judge_side_forces({30, 40, 35}).verdict, partly);
  EXPECT_EQ(judge_side_forces({41, 40, 35}).verdict, no);
  EXPECT_EQ(judge_side_forces({30, none, 50}).verdict, no);
}

TEST(Judgement, TakesLonger) {
  EXPECT_EQ(judge_takes_longer(1.1, 1, "a", "b").verdict, reproduced);
  EXPECT_EQ(judge_takes_longer(1.01, 1, "a", "b").verdict, partly);
  EXPECT_EQ(judge_takes_longer(1, 1.1, "a", "b").verdict, no);
  EXPECT_EQ(judge_takes_longer(none, 1, "a", "b").verdict, no);
}

TEST(Judgement, CarriesRuleAndNumbers) {
  const Judgement judgement = judge_lower_force(95, 100, "near", "far");
  EXPECT_NE(judgement.rule.find("5 %"), std::string::npos) << judgement.rule;
  ASSERT_EQ(judgement.numbers.size(), 3U);
  EXPECT_EQ(judgement.numbers[0].name, "near [N]");
  EXPECT_EQ(judgement.numbers[1].value, 100.0);
  EXPECT_NEAR(*judgement.numbers[2].value, 0.95, 1e-12);
}

}  // namespace
}  // namespace sunder::test
