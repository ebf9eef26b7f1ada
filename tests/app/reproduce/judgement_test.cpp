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

TEST(Judgement, PeakNamesWhatItIsMeasuredFrom) {
  const Judgement judgement = judge_peak_at_tip(std::vector<std::optional<double>>{1.0}, "a node");
  EXPECT_NE(judgement.rule.find("h of a node in"), std::string::npos) << judgement.rule;
  EXPECT_NE(judgement.numbers[0].name.find("from a node"), std::string::npos);
}

TEST(Judgement, ModelsDiffer) {
  EXPECT_EQ(judge_models_differ(0.5).verdict, reproduced);
  EXPECT_EQ(judge_models_differ(0.51).verdict, partly);
  EXPECT_EQ(judge_models_differ(0.81).verdict, no);
  EXPECT_EQ(judge_models_differ(none).verdict, no);
}

TEST(Judgement, UpThenDown) {
  EXPECT_EQ(judge_up_then_down(Turns{6, -6, 3, 1, -0.2}, 2.7).verdict, reproduced);
  EXPECT_EQ(judge_up_then_down(Turns{6, -6, 2.6, 1, -0.2}, 2.7).verdict, partly);  // top under h
  EXPECT_EQ(judge_up_then_down(Turns{6, -4.9, 3, 2, 0}, 2.7).verdict, partly);
  EXPECT_EQ(judge_up_then_down(Turns{4.9, -6, 3, 1, 0}, 2.7).verdict, no);
  EXPECT_EQ(judge_up_then_down(Turns{0, -20, 0, -9, 0}, 2.7).verdict, no);  // down only
  EXPECT_EQ(judge_up_then_down(Turns{6, 0, 3, 3, -1}, 2.7).verdict, no);    // down, then up
  EXPECT_EQ(judge_up_then_down(none, 2.7).verdict, no);
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
  EXPECT_EQ(judge_goes_further({21, 3}, {20, 3}).verdict, reproduced);
  EXPECT_EQ(judge_goes_further({20.5, 3}, {20, 3}).verdict, partly);
  EXPECT_EQ(judge_goes_further({20, 4}, {20, 3}).verdict, no);  // the reach alone does not count
  EXPECT_EQ(judge_goes_further({5, 3}, {0, none}).verdict, reproduced);  // the far one rests
  EXPECT_EQ(judge_goes_further({0, none}, {0, none}).verdict, no);
  EXPECT_EQ(judge_goes_further({none, none}, {none, none}).verdict, no);
}

TEST(Judgement, FinalLength) {
  using Lengths = std::vector<FinalLength>;
  EXPECT_EQ(judge_final_length(Lengths{{4, 4}, {8, 10.4}, {16, 34.4}}).verdict, reproduced);
  EXPECT_EQ(judge_final_length(Lengths{{4, 4}, {8, 11.9}, {16, 19.2}}).verdict, partly);
  EXPECT_EQ(judge_final_length(Lengths{{4, 4}, {8, 8}, {16, 16}}).verdict, partly);  // all rest
  EXPECT_EQ(judge_final_length(Lengths{{4, 20}, {8, 20}}).verdict, no);
  EXPECT_EQ(judge_final_length(Lengths{{4, none}, {8, 20}}).verdict, no);
  EXPECT_EQ(judge_final_length(Lengths{{4, 5}}).verdict, no);
  EXPECT_EQ(judge_final_length({}).verdict, no);
}

TEST(Judgement, PropagationFirst) {
  EXPECT_EQ(judge_propagation_first({5, 1, 2, 0}).verdict, reproduced);
  EXPECT_EQ(judge_propagation_first({5, 0, 2, 0}).verdict, partly);  // never put to the test
  EXPECT_EQ(judge_propagation_first({5, 5, 2, 1}).verdict, no);      // both in one event
  EXPECT_EQ(judge_propagation_first({0, 0, 2, 0}).verdict, no);
}

TEST(Judgement, Several) {
  EXPECT_EQ(judge_several({2, 2, 1}).verdict, reproduced);
  EXPECT_EQ(judge_several({3, 1, 4}).verdict, partly);  // one instrument has them all
  EXPECT_EQ(judge_several({2, 2, 0}).verdict, partly);  // one after the other
  EXPECT_EQ(judge_several({1, 1, 0}).verdict, no);
}

TEST(Judgement, EqualTotals) {
  using Totals = std::vector<Figure>;
  EXPECT_EQ(judge_equal_totals(Totals{{"A", 69.4}, {"B", 69.0}, {"C", 71.5}}).verdict, reproduced);
  EXPECT_EQ(judge_equal_totals(Totals{{"A", 1.0}, {"B", 1.2}}).verdict, partly);
  EXPECT_EQ(judge_equal_totals(Totals{{"A", 0.062}, {"B", 0.324}, {"C", 0.461}}).verdict, no);
  EXPECT_EQ(judge_equal_totals(Totals{{"A", 1.0}, {"B", none}}).verdict, no);
  EXPECT_EQ(judge_equal_totals(Totals{{"A", none}, {"B", 1.0}}).verdict, no);
  EXPECT_EQ(judge_equal_totals({}).verdict, no);
  EXPECT_NEAR(*judge_equal_totals(Totals{{"A", 2.0}, {"B", 5.0}}).numbers.back().value, 2.5, 1e-12);
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
