// SPDX-License-Identifier: Apache-2.0
// A board that tears by the K of its field, whole frames on the reference.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder {
namespace {

/// A board 20 x 20 x 1 with a preset edge notch of 6 cells at mid-height, held below, its
/// upper end moved by a grip.
Scene notched_scene(SifSource sif, const Vec3& displacement) {
  const test::BoardShape shape{20, 21, 1, 20, 21, 1};
  Scene scene;
  scene.mesh = test::structured_board(shape);
  scene.materials["board"] = {5, 0.3, 2.0};
  Support support;
  support.nodes = Box{{-1, -0.1, -1}, {21, 0.1, 2}};
  scene.supports.push_back(support);
  Instrument grip;
  grip.name = "grip";
  grip.action = Grip{Box{{-1, 20.9, -1}, {21, 21.1, 2}}, displacement, Axes{7}};
  grip.ramp = Ramp{0, 1};
  scene.instruments.push_back(grip);
  PresetCrack notch;
  notch.elements = Box{{-1, 10, -1}, {6, 11, 2}};
  notch.mouth = Vec3(0, 10.5, 0.5);
  notch.tips = {Vec3(6, 10.5, 0.5)};
  scene.cracks.push_back(notch);
  scene.fracture.model = FractureModel::b;
  scene.fracture.sif = sif;
  scene.solver.backend = "cpu";
  scene.steps = 20;
  return scene;
}

struct Torn {
  std::vector<DestroyedElement> rows;
  std::vector<Crack> cracks;
};

Torn tear(SifSource sif, const Vec3& displacement) {
  auto problem = std::make_shared<const Problem>(notched_scene(sif, displacement));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!simulation.done() && simulation.destroyed().size() < 200) simulation.step();
  return {simulation.destroyed(), simulation.cracks()};
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
  // Strip of height H between held ends moved apart by u (Rice 1967): far ahead e_xx = 0 and
  // s_yy = E/(1 - nu^2) u/H, far behind nothing, so K = sqrt(E G) = E u/H sqrt(H/2/(1 - nu^2)),
  // whatever the crack's length. The formula's F(a/b), made for free ends, grows with the crack.
  const double young = 5, poisson = 0.3, height = 21;
  int compared = 0;
  double formula_first = 0, formula_last = 0;
  for (const DestroyedElement& row : tear(SifSource::field, {0, 8, 0}).rows) {
    if (!row.sif || row.sif->a < 7 || row.sif->a > 12) continue;
    const double strain = 8 * row.load_factor / height;
    const double rice = young * strain * std::sqrt(height / 2 / (1 - poisson * poisson));
    EXPECT_NEAR(*row.sif->k_1 / rice, 1, 0.05) << "a = " << row.sif->a;
    if (compared++ == 0) formula_first = row.sif->k_a;
    formula_last = row.sif->k_a;
  }
  EXPECT_GT(compared, 5);
  EXPECT_GT(formula_last, 1.5 * formula_first);
}

TEST(FieldGrowth, FormulaLeavesTheFieldAlone) {
  const Torn torn = tear(SifSource::formula, {0, 8, 0});
  bool any = false;
  for (const DestroyedElement& row : torn.rows) {
    if (!row.sif) continue;
    any = true;
    EXPECT_FALSE(row.sif->k_1 || row.sif->k_2);
  }
  EXPECT_TRUE(any);
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
