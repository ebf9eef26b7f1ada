// SPDX-License-Identifier: Apache-2.0
// What becomes of a statement by another law, and how it is told.
#include "app/reproduce/survival.hpp"

#include <gtest/gtest.h>

namespace sunder::test {
namespace {

using namespace app::reproduce;

constexpr Verdict kYes = Verdict::reproduced, kPartly = Verdict::partly, kNo = Verdict::no;

TwoVerdicts forces(std::optional<double> linear_b, std::optional<double> other_b,
                   const std::string& k, std::vector<RunNote> runs) {
  const auto of = [&](std::optional<double> b, double a) {
    return Statement{"2b", "B before A.", k, judge_lower_force(b, a, "B", "A"), "words"};
  };
  return {of(linear_b, 50), of(other_b, 60), std::move(runs)};
}

TEST(Survival, IsAVerdictAsGoodAsTheLinearLaws) {
  for (const bool ended : {false, true}) {
    EXPECT_EQ(survival_of(kYes, kYes, ended), Survival::survives);
    EXPECT_EQ(survival_of(kPartly, kPartly, ended), Survival::survives);
    EXPECT_EQ(survival_of(kPartly, kYes, ended), Survival::survives);
    EXPECT_EQ(survival_of(kNo, kNo, ended), Survival::with_neither);
    EXPECT_EQ(survival_of(kNo, kPartly, ended), Survival::appears);
  }
}

TEST(Survival, AWorseVerdictIsTheRunsEndIfItEnded) {
  EXPECT_EQ(survival_of(kYes, kPartly, false), Survival::in_part);
  EXPECT_EQ(survival_of(kYes, kNo, false), Survival::does_not);
  EXPECT_EQ(survival_of(kPartly, kNo, false), Survival::does_not);
  for (const Verdict other : {kPartly, kNo})
    EXPECT_EQ(survival_of(kYes, other, true), Survival::ends_before);
}

TEST(Survival, TablesHaveTheFiguresOfBothLaws) {
  const std::vector<TwoVerdicts> all = {forces(40, 45, "formula K", {}),
                                        forces(40, std::nullopt, "field K", {})};
  const DataTable statements = survival_table(all);
  ASSERT_EQ(statements.rows.size(), 2U);
  EXPECT_TRUE(statements.in_markdown);
  EXPECT_EQ(statements.rows[0][5], "survives");
  EXPECT_EQ(statements.rows[0][6], "B [N]: 40 / 45; A [N]: 50 / 60; ratio: 0.8 / 0.75");
  EXPECT_EQ(statements.rows[1][5], "does not");
  EXPECT_EQ(statements.rows[1][6], "B [N]: 40 / none; A [N]: 50 / 60; ratio: 0.8 / none");
  const DataTable figures = figures_table(all);
  ASSERT_EQ(figures.rows.size(), 6U);
  EXPECT_EQ(figures.rows[1], (std::vector<std::string>{"2b", "formula K", "A [N]", "50", "60"}));
  EXPECT_EQ(figures.rows[3][4], "");
  const auto findings = survival_findings(all);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0], "survives: 1 of 2 (2b formula K).");
  EXPECT_EQ(findings[1], "does not: 1 of 2 (2b field K).");
}

TEST(Survival, SaysWhereARunEndedOrTheFieldHadNoK) {
  RunNote ended;
  ended.scene = "notch-b";
  ended.load = 1.5;
  ended.failure = "the body finds no equilibrium";
  const TwoVerdicts torn_off = forces(40, std::nullopt, "formula K", {ended});
  EXPECT_EQ(survival_of(torn_off), Survival::ends_before);
  EXPECT_EQ(why_not(torn_off),
            "scene notch-b at 1.5 times its forces: no equilibrium (exit code 5)");
  RunNote without;
  without.by_j = true;
  EXPECT_NE(
      why_not(forces(40, std::nullopt, "field K", {without, {}})).find("strained by over 10 %"),
      std::string::npos);
  EXPECT_EQ(why_not(forces(40, 45, "field K", {without})), "");
  EXPECT_EQ(why_not(forces(40, std::nullopt, "formula K", {without})), "");
}

TEST(Survival, NoRunIsDropped) {
  RunNote whole, stopped, ended, moving;
  whole.steps = whole.all = stopped.all = 50;
  stopped.steps = 40;
  ended.failure = "no equilibrium";
  moving.unfinished = 2;
  const std::vector<RunNote> notes = {whole, stopped, ended, moving};
  const DataTable table = runs_table(notes);
  ASSERT_EQ(table.rows.size(), 4U);
  EXPECT_EQ(table.rows[0].back(), "all steps");
  EXPECT_EQ(table.rows[1].back(), "so many broke");
  EXPECT_EQ(table.rows[2].back(), "exit code 5: no equilibrium");
  EXPECT_EQ(table.rows[3].back(), "2 steps not at rest at the end");
}

}  // namespace
}  // namespace sunder::test
