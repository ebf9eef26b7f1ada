// SPDX-License-Identifier: Apache-2.0
// Cracks that grow by toughness in whole runs (method.md "Toughness"): exactly where K reaches K_c,
// or J reaches G_c.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/field_sif/held_strip.hpp"

namespace sunder::test {
namespace {

/// What a decision saw of the strip's one tip, and how many elements were gone before it.
struct Seen {
  TipState tip;
  std::size_t destroyed;
};

struct StripRun {
  std::vector<Seen> seen;
  std::vector<DestroyedElement> rows;
  std::vector<std::string> warnings;
};

StripRun run_strip(Scene scene, int steps) {
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  StripRun out;
  simulation.observe_frames([&] {
    out.seen.push_back({simulation.tips().at(0), simulation.destroyed().size()});
  });
  for (int step = 0; step < steps && out.seen.size() < 60; ++step) simulation.step();
  out.seen.push_back({TipState{}, simulation.destroyed().size()});
  out.rows = simulation.destroyed();
  out.warnings = simulation.warnings();
  return out;
}

/// Without yield: nothing but the crack can grow.
Scene tough_strip(SifSource sif, const Vec3& displacement) {
  Scene scene = HeldStrip{}.scene(sif, displacement);
  scene.materials["board"].yield.reset();
  return scene;
}

void hold_flat(Scene& scene) {
  scene.supports.push_back({Box{Vec3(-1, 0.5, -1), Vec3(21, 20.5, 2)}, Axes{4}});
}

class GrowsBy : public testing::TestWithParam<SifSource> {};

TEST_P(GrowsBy, KcAndNothingElse) {
  Scene scene = tough_strip(GetParam(), {0, 8, 0});
  scene.materials["board"].toughness = 1.5;
  const StripRun r = run_strip(std::move(scene), 20);
  int grown = 0, rested = 0;
  for (std::size_t i = 0; i + 1 < r.seen.size(); ++i) {
    const TipState& tip = r.seen[i].tip;
    if (tip.ended) break;
    ASSERT_TRUE(tip.k && tip.toughness);
    EXPECT_EQ(*tip.toughness, 1.5);
    const bool grows = r.seen[i + 1].destroyed > r.seen[i].destroyed;
    EXPECT_EQ(grows, *tip.k >= 1.5) << "K " << *tip.k;
    ++(grows ? grown : rested);
  }
  EXPECT_GT(grown, 5);
  EXPECT_GT(rested, 1);
  for (const DestroyedElement& row : r.rows) {
    if (!row.sif) continue;
    EXPECT_NEAR(*row.ratio, row.sif->k / 1.5, 1e-12);
    EXPECT_GT(row.sif->advance, 0);
    EXPECT_LE(row.sif->advance, 1.5 * 1.3) << "h is 1.2 mm";
  }
}

INSTANTIATE_TEST_SUITE_P(By, GrowsBy, testing::Values(SifSource::formula, SifSource::field),
                         [](const auto& tested) {
                           return tested.param == SifSource::field ? "Field" : "Formula";
                         });

// E' of field K: E in a thin sheet, E/(1 - nu^2) where it is held flat.
TEST(FieldToughness, MakesKcOfAnEnergyInTheStateRoundTheTip) {
  const double energy = 0.4, young = 5, poisson = 0.3;
  for (const SifSource sif : {SifSource::formula, SifSource::field}) {
    for (const bool flat : {false, true}) {
      Scene scene = tough_strip(sif, {0, 0.1, 0});
      scene.materials["board"].energy = energy;
      if (flat) hold_flat(scene);
      const TipState tip = run_strip(std::move(scene), 1).seen.at(0).tip;
      ASSERT_TRUE(tip.toughness);
      const double effective = flat ? young / (1 - poisson * poisson) : young;
      EXPECT_NEAR(*tip.toughness, std::sqrt(energy * effective), 1e-12);
      EXPECT_EQ(tip.toughness_state, flat ? "plane strain" : "plane stress");
    }
  }
}

TEST(FieldToughness, OfAnEnergyAndOfItsKcIsTheSameRun) {
  Scene by_k = tough_strip(SifSource::field, {0, 8, 0}),
        by_g = tough_strip(SifSource::field, {0, 8, 0});
  by_k.materials["board"].toughness = 1.5;
  by_g.materials["board"].energy = 1.5 * 1.5 / 5;
  const StripRun a = run_strip(std::move(by_k), 10), b = run_strip(std::move(by_g), 10);
  ASSERT_EQ(a.rows.size(), b.rows.size());
  EXPECT_GT(a.rows.size(), 60U);
  for (std::size_t i = 0; i < a.rows.size(); ++i) EXPECT_EQ(a.rows[i].element, b.rows[i].element);
}

// Beyond small strain there is no K: J decides, whatever the law.
TEST(FieldToughness, AtFiniteStrainIsJAgainstGc) {
  Scene scene = tough_strip(SifSource::field, {0, 8, 0});
  scene.materials["board"].law = MaterialLaw::corotated;
  const double energy = 1.2;
  scene.materials["board"].energy = energy;
  const StripRun r = run_strip(std::move(scene), 16);
  int grown = 0, rested = 0;
  for (std::size_t i = 0; i + 1 < r.seen.size(); ++i) {
    const TipState& tip = r.seen[i].tip;
    if (tip.ended || tip.field_note != "strain") continue;
    ASSERT_TRUE(tip.j && tip.k);
    EXPECT_FALSE(tip.k_1);
    const bool grows = r.seen[i + 1].destroyed > r.seen[i].destroyed;
    EXPECT_EQ(grows, *tip.j >= energy) << "J " << *tip.j;
    ++(grows ? grown : rested);
  }
  EXPECT_GT(grown, 3);
  EXPECT_GT(rested, 1);
}

// A region that a frame computes holds what a crack may take, though nothing in it yields.
TEST(FieldToughness, RunsOnEveryRouteAlike) {
  std::vector<Index> first;
  for (const Route route : {Route::factor, Route::inverse, Route::condensed, Route::cg}) {
    Scene scene = tough_strip(SifSource::field, {0, 8, 0});
    scene.materials["board"].toughness = 1.5;
    scene.solver.route = route;
    const StripRun r = run_strip(std::move(scene), 5);
    std::vector<Index> elements;
    for (const DestroyedElement& row : r.rows) elements.push_back(row.element);
    if (first.empty()) first = elements;
    EXPECT_GT(elements.size(), 40U);
    EXPECT_EQ(elements, first);
  }
}

}  // namespace
}  // namespace sunder::test
