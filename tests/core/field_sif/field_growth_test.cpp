// SPDX-License-Identifier: Apache-2.0
// A board that tears by the K of its field, whole frames on the reference.
#include <gtest/gtest.h>

#include <cmath>

#include "core/field_sif/held_strip.hpp"

namespace sunder {
namespace {

using test::Torn;

Torn tear(SifSource sif, const Vec3& displacement) {
  return test::HeldStrip{}.tear(sif, displacement);
}

TEST(FieldGrowth, TearsStraightUnderTension) {
  const Torn torn = tear(SifSource::field, {0, 8, 0});
  const Crack& crack = torn.cracks[0];
  EXPECT_GT(crack.length, 12);
  // The board's first axis is its height: a point of the path is (y, x).
  for (const Vec2& p : crack.path) EXPECT_NEAR(p.x(), 10.5, 1.5);
}

TEST(FieldGrowth, ReportsTheTermsOfBoth) {
  for (const DestroyedElement& row : tear(SifSource::field, {0, 8, 0}).rows) {
    if (!row.sif) continue;
    ASSERT_TRUE(row.sif->k_1 && row.sif->k_2);
    EXPECT_GE(row.sif->k, *row.sif->k_1 * (1 - 1e-12));  // the best direction
    EXPECT_GT(row.sif->k_a, 0);
    EXPECT_GT(row.sif->b, 0);
  }
}

TEST(FieldGrowth, TheFieldKnowsThatHeldEndsKeepKConstant) {
  // The formula's F(a/b), made for free ends, grows with the crack.
  int compared = 0;
  double formula_first = 0, formula_last = 0;
  for (const DestroyedElement& row : tear(SifSource::field, {0, 8, 0}).rows) {
    if (!row.sif || row.sif->a < 7 || row.sif->a > 12) continue;
    const double rice = test::HeldStrip{}.rice(8 * row.load_factor);
    EXPECT_NEAR(*row.sif->k_1 / rice, 1, 0.05) << "a = " << row.sif->a;
    if (compared++ == 0) formula_first = row.sif->k_a;
    formula_last = row.sif->k_a;
  }
  EXPECT_GT(compared, 5);
  EXPECT_GT(formula_last, 1.5 * formula_first);
}

TEST(FieldGrowth, TheFormulaDrivesAndTheFieldIsTold) {
  int told = 0;
  for (const DestroyedElement& row : tear(SifSource::formula, {0, 8, 0}).rows) {
    if (!row.sif) continue;
    const SifTerms& k = *row.sif;
    EXPECT_EQ(k.k, k.k_formula.value());
    EXPECT_EQ(k.theta, k.theta_formula.value());
    ASSERT_TRUE(k.k_1 && k.k_2 && k.k_3 && k.k_field);
    // Far from the ends: the field's K is Rice's, the formula's is that of free ends.
    if (k.a > 7 && k.a < 12) {
      EXPECT_NEAR(*k.k_1 / test::HeldStrip{}.rice(8 * row.load_factor), 1, 0.05) << k.a;
      ++told;
    }
  }
  EXPECT_GT(told, 5);
}

TEST(FieldGrowth, TheFieldDrivesAndTheFormulaIsTold) {
  for (const DestroyedElement& row : tear(SifSource::field, {2, 8, 0}).rows) {
    if (!row.sif) continue;
    EXPECT_EQ(row.sif->k, row.sif->k_field.value());
    EXPECT_EQ(row.sif->theta, row.sif->theta_field.value());
    EXPECT_EQ(row.sif->k_formula.value(), row.sif->k_a);  // nothing presses
  }
}

TEST(FieldGrowth, ShearTurnsTheCrack) {
  const Torn up = tear(SifSource::field, {0, 8, 0}), right = tear(SifSource::field, {4, 8, 0});
  const auto first = [](const Torn& torn) {
    for (const DestroyedElement& row : torn.rows)
      if (row.sif) return *row.sif;
    return SifTerms{};
  };
  EXPECT_LT(std::abs(first(up).theta), 10);
  EXPECT_GT(std::abs(first(right).theta), std::abs(first(up).theta) + 5);
  EXPECT_LT(first(right).theta * *first(right).k_2, 0);
}

TEST(FieldGrowth, SameRunTwice) {
  const Torn one = tear(SifSource::field, {2, 8, 0}), two = tear(SifSource::field, {2, 8, 0});
  ASSERT_EQ(one.rows.size(), two.rows.size());
  for (std::size_t i = 0; i < one.rows.size(); ++i) {
    EXPECT_EQ(one.rows[i].element, two.rows[i].element);
    ASSERT_EQ(one.rows[i].sif.has_value(), two.rows[i].sif.has_value());
    if (one.rows[i].sif) {
      EXPECT_EQ(one.rows[i].sif->k, two.rows[i].sif->k);
    }
  }
}

}  // namespace
}  // namespace sunder
