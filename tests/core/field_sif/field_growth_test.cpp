// SPDX-License-Identifier: Apache-2.0
// A board that tears by the K of its field, whole frames on the reference.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/field_sif/held_strip.hpp"
#include "fracture/field_sif/field_intensity.hpp"

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

/// Runs a scene to its end; every K told must be a number.
Torn run(Scene scene) {
  auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!simulation.done()) simulation.step();
  for (const DestroyedElement& row : simulation.destroyed()) {
    if (!row.sif) continue;
    EXPECT_TRUE(std::isfinite(row.sif->k) && std::isfinite(row.sif->theta)) << row.element;
    EXPECT_TRUE(row.sif->k_1 && std::isfinite(*row.sif->k_1)) << row.element;
  }
  return {simulation.destroyed(), simulation.cracks()};
}

TEST(FieldGrowth, EndsAtTheFarEdge) {
  const Torn torn = run(test::HeldStrip{}.scene(SifSource::field, {0, 14, 0}));
  EXPECT_TRUE(torn.cracks[0].tips[0].ended);
  EXPECT_GT(torn.cracks[0].length, 19);
}

TEST(FieldGrowth, RestsAtMaterialThatHolds) {
  Scene scene = test::HeldStrip{}.scene(SifSource::field, {0, 8, 0});
  scene.mesh = test::structured_board({20, 21, 1, 20, 21, 1}, [](const Vec3& x) {
    return std::string(x.x() > 12 ? "holding" : "board");
  });
  scene.materials["holding"] = {500, 0.3, std::nullopt};
  const Torn torn = run(std::move(scene));
  EXPECT_GT(torn.cracks[0].length, 8);
  EXPECT_LT(torn.cracks[0].length, 12.5);
  EXPECT_FALSE(torn.cracks[0].tips[0].ended);
  std::string first, last;
  for (const DestroyedElement& row : torn.rows) {
    if (!row.sif) continue;
    if (last.empty() && row.sif->a < 7) first = row.sif->field_note;
    last = row.sif->field_note;
  }
  EXPECT_EQ(first, "");  // 6 h away the ring shrinks to what is free of it
  EXPECT_EQ(last, "material");
}

TEST(FieldGrowth, ACrackOfSplitNodesGrowsOn) {
  Scene scene = test::HeldStrip{}.scene(SifSource::field, {0, 8, 0});
  Mesh& mesh = scene.mesh;
  std::map<Index, Index> copy;
  for (Index n = 0, count = mesh.node_count(); n < count; ++n) {
    const Vec3 x = mesh.nodes[n];
    if (x.y() != 10 || x.x() >= 6) continue;
    copy[n] = mesh.node_count();
    mesh.nodes.push_back(x);
  }
  for (auto& tet : mesh.tets) {
    double height = 0;
    for (Index n : tet) height += mesh.nodes[n].y() / 4;
    for (Index& n : tet)
      if (height > 10 && copy.contains(n)) n = copy[n];
  }
  scene.cracks[0].elements = std::vector<Index>{};
  scene.cracks[0].mouth = Vec3(0, 10, 0.5);
  scene.cracks[0].tips = {Vec3(6, 10, 0.5)};
  const Torn torn = run(std::move(scene));
  EXPECT_GT(torn.cracks[0].length, 12);
  int compared = 0;
  for (const DestroyedElement& row : torn.rows) {
    EXPECT_EQ(row.cause, Cause::sif);
    if (!row.sif || row.sif->a < 7 || row.sif->a > 12) continue;
    EXPECT_NEAR(*row.sif->k_1 / test::HeldStrip{}.rice(8 * row.load_factor), 1, 0.1) << row.sif->a;
    ++compared;
  }
  EXPECT_GT(compared, 5);
}

TEST(FieldGrowth, TwoCracksMeet) {
  Scene scene = test::HeldStrip{}.scene(SifSource::field, {0, 10, 0});
  PresetCrack other;
  other.elements = Box{{14, 10, -1}, {21, 11, 2}};
  other.mouth = Vec3(20, 10.5, 0.5);
  other.tips = {Vec3(14, 10.5, 0.5)};
  scene.cracks.push_back(other);
  const Torn torn = run(std::move(scene));
  ASSERT_EQ(torn.cracks.size(), 2u);
  EXPECT_GT(torn.cracks[0].length + torn.cracks[1].length, 18);
  bool warned = false;
  for (const DestroyedElement& row : torn.rows)
    warned |= row.sif && row.sif->field_note.find("damage") != std::string::npos;
  EXPECT_TRUE(warned);
}

TEST(FieldGrowth, GripsOnTheFacesBelongToTheField) {
  // Forceps hold the notch's upper face 2.5 h behind the tip, within the ring, and pull.
  Scene scene = test::HeldStrip{}.scene(SifSource::field, {0, 0, 0});
  Instrument forceps;
  forceps.name = "forceps";
  forceps.action = Grip{Box{{2.9, 10.99, -1}, {4.1, 11.01, 2}}, Vec3(0, 6, 0), Axes{2}};
  scene.instruments.push_back(forceps);
  scene.steps = 1;
  auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  const fracture::Board board(problem->mesh(), {});
  fracture::FieldIntensityMeter meter(*problem, board);
  std::vector<double> without, small;
  simulation.observe_frames([&] {
    const fracture::FieldView view{simulation.backend().destroyed(),
                                   [&](std::span<const Index> nodes, std::span<Vec3> u) {
                                     simulation.backend().read_displacement(nodes, u);
                                   },
                                   {}};
    without.push_back(meter.at(simulation.cracks()[0], 0, view).factors.k_1);
    small.push_back(meter.at(simulation.cracks()[0], 0, view, 1.9).factors.k_1);
  });
  simulation.step();
  for (const DestroyedElement& row : simulation.destroyed()) {
    if (!row.sif) continue;
    EXPECT_NEAR(*row.sif->k_1 / small[0], 1, 0.1);  // a ring that ends before the forceps
    EXPECT_GT(std::abs(without[0] / small[0] - 1), 0.3);
    return;
  }
  FAIL() << "the notch did not grow";
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
