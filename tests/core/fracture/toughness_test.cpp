// SPDX-License-Identifier: Apache-2.0
// Cracks that grow by toughness (method.md "Toughness"): which elements, how far, where they stop.
#include "fracture/toughness.hpp"

#include <cmath>
#include <numbers>

#include "board_fixture.hpp"
#include "fracture/band.hpp"
#include "fracture/geometry_factor.hpp"
#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

using std::numbers::pi;
using test::Driver;
using test::tension;

/// Five live elements without yield, K_c = 1 each.
struct ToughElements {
  std::vector<std::uint8_t> dead = std::vector<std::uint8_t>(5, 0);
  std::vector<double> yields = std::vector<double>(5, 0.0);
  std::vector<GivenToughness> given = std::vector<GivenToughness>(5, {1, 0});
  double young = 0;
  [[nodiscard]] Walk walk(std::initializer_list<double> rhos, double k, double size = 1) const {
    Band band;
    band.size = size;
    for (const double rho : rhos)
      band.elements.push_back({static_cast<Index>(band.elements.size()), rho});
    Walk walk;
    walk_band(band, 1, k, 0, {dead, yields, {}, false, {given, {}, {}, young}}, walk);
    return walk;
  }
};

TEST(ToughWalk, GoesTheLocalHAtKcAndNowhereBelow) {
  const ToughElements all;
  EXPECT_TRUE(all.walk({0.2, 0.6}, std::nextafter(1.0, 0.0)).passed.empty());
  const Walk walk = all.walk({-0.2, 0.3, 0.7, 0.9, 1.2}, 1);
  ASSERT_EQ(walk.passed.size(), 4U) << "centroids up to h";
  EXPECT_EQ(walk.advance, 1.0);
  for (const Passed& passed : walk.passed) {
    EXPECT_EQ(passed.ratio, 1.0);
    EXPECT_EQ(passed.toughness, 1.0);
    EXPECT_EQ(passed.reach, 0.0) << "Eq. 1 has no say";
  }
}

// K far above K_c goes no farther in one event: the next one looks at the field again.
TEST(ToughWalk, DoesNotGoFartherForALargerK) {
  const ToughElements all;
  const Walk walk = all.walk({0.3, 0.9, 1.2}, 10);
  EXPECT_EQ(walk.passed.size(), 2U);
  EXPECT_EQ(walk.advance, 1.0);
  EXPECT_EQ(walk.passed[0].ratio, 10.0);
}

TEST(ToughWalk, TakesTheSizeOfWhatLiesAhead) {
  const ToughElements all;
  const Walk walk = all.walk({0.2, 0.5, 0.65}, 1, 0.6);
  EXPECT_EQ(walk.passed.size(), 2U);
  EXPECT_EQ(walk.advance, 0.6);
}

// The row may end before h; a tip beyond it would have no crack behind it.
TEST(ToughWalk, EndsAQuarterPastTheLastCentroid) {
  const ToughElements all;
  EXPECT_NEAR(all.walk({0.2, 0.6}, 1).advance, 0.85, 1e-15);
}

TEST(ToughWalk, TakesTheFirstElementHoweverFar) {
  const ToughElements all;
  const Walk walk = all.walk({1.3, 1.4}, 1);
  EXPECT_EQ(walk.passed.size(), 1U);
  EXPECT_NEAR(walk.advance, 1.3, 1e-15);
}

TEST(ToughWalk, StopsBeforeATougherElement) {
  ToughElements some;
  some.given[1].intensity = 1.5;
  const Walk walk = some.walk({0.2, 0.55, 0.7}, 1.2);
  ASSERT_EQ(walk.passed.size(), 1U) << "weaker ones behind it live";
  EXPECT_EQ(walk.advance, 0.55) << "at most the survivor's rho";
  EXPECT_TRUE(some.walk({0.2, 0.55}, 0.9).passed.empty());
  EXPECT_EQ(some.walk({0.2, 0.55, 0.7}, 1.5).passed.size(), 3U);
}

TEST(ToughWalk, StopsBeforeTheUnbreakable) {
  ToughElements some;
  some.given[1].intensity = 0;
  EXPECT_EQ(some.walk({0.2, 0.55, 0.7}, 9).passed.size(), 1U);
}

// A material without toughness beside one with: Eq. 1 decides in it, r_e = K^2/(2 pi yield^2).
TEST(ToughWalk, LeavesElementsWithYieldAloneToEq1) {
  ToughElements some;
  some.given[1].intensity = 0;
  some.yields[1] = 1;
  const double k = std::sqrt(2 * pi * 0.58);  // reach .58, past .55 and short of .6
  const Walk walk = some.walk({0.2, 0.55}, k);
  ASSERT_EQ(walk.passed.size(), 2U);
  EXPECT_NEAR(walk.passed[1].reach, 0.58, 1e-12);
  EXPECT_NEAR(walk.passed[1].ratio, 0.58 / 0.55, 1e-12);
  EXPECT_EQ(walk.passed[1].toughness, 0);
  EXPECT_EQ(some.walk({0.2, 0.6}, k).passed.size(), 1U);
}

TEST(ToughWalk, MakesKcOfAnEnergyByTheYoungOfTheTip) {
  ToughElements some;
  some.given.assign(5, {0, 0.5});
  some.young = 8;  // K_c = sqrt(.5 * 8) = 2
  EXPECT_TRUE(some.walk({0.2}, 1.999).passed.empty());
  EXPECT_EQ(some.walk({0.2}, 2).passed.size(), 1U);
  EXPECT_EQ(some.walk({0.2}, 2).passed[0].toughness, 2);
}

// ---- Model B, K by the formula ------------------------------------------------------------------

/// K of Eq. 2 of the slit of 3 mm in 20 mm under tension of 1 MPa across it.
double slit_intensity() { return edge_factor(3.0 / 20) * std::sqrt(pi * 3); }

Scene tough_slit(double toughness, bool yields = false) {
  Scene scene = test::edge_slit(3);
  for (auto& [name, material] : scene.materials) {
    material.toughness = toughness;
    if (!yields) material.yield.reset();
  }
  return scene;
}

TEST(ToughModelB, GrowsFromKcOn) {
  const double k = slit_intensity();
  for (const auto& [share, grows] : {std::pair{0.999, true}, std::pair{1.001, false}}) {
    Driver driver(tough_slit(share * k));
    driver.pull(tension(1, 90));
    const Decision d = driver.decide();
    EXPECT_EQ(!d.elements.empty(), grows) << share;
    for (const DestroyedElement& row : d.elements) {
      EXPECT_EQ(row.cause, Cause::sif);
      EXPECT_NEAR(*row.ratio, 1 / share, 1e-9);
      EXPECT_NEAR(*row.sif->toughness, share * k, 1e-12);
      EXPECT_EQ(row.sif->reach, 0);
      EXPECT_NEAR(row.sif->advance, driver.criterion->cracks()[0].length - 3, 1e-12);
    }
  }
}

// The yield that starts cracks has no say in how they grow.
TEST(ToughModelB, DoesNotReadTheYield) {
  Driver with(tough_slit(0.999 * slit_intensity(), true)),
      without(tough_slit(0.999 * slit_intensity()));
  for (Driver* driver : {&with, &without}) driver->pull(tension(1, 90));
  const Decision a = with.decide(), b = without.decide();
  ASSERT_EQ(a.elements.size(), b.elements.size());
  for (std::size_t i = 0; i < a.elements.size(); ++i)
    EXPECT_EQ(a.elements[i].element, b.elements[i].element);
}

TEST(ToughModelB, WithoutYieldNothingIsBorn) {
  Driver driver(tough_slit(1e9));
  driver.pull(tension(1, 90));
  EXPECT_TRUE(driver.decide().elements.empty());
  EXPECT_EQ(driver.criterion->cracks().size(), 1U);
  for (Index e = 0; e < driver.problem.tet_count(); ++e) {
    EXPECT_FALSE(driver.problem.breakable(e));
    EXPECT_TRUE(driver.problem.destructible(e));
  }
}

// Runs until it meets the tougher half: x > 10 asks for more than the K that it has there.
TEST(ToughModelB, StopsAtATougherMaterial) {
  Mesh mesh = test::structured_board(
      test::kSlitShape, [](const Vec3& x) { return std::string(x.x() < 10 ? "board" : "strong"); });
  Scene scene = test::edge_slit(3, std::move(mesh));
  scene.materials["board"] = {1.0, 0.0, {}};
  scene.materials["strong"] = {1.0, 0.0, {}};
  scene.materials["board"].toughness = 1;
  scene.materials["strong"].toughness = 1e6;
  Driver driver(std::move(scene));
  driver.pull(tension(1, 90));
  int events = 0;
  while (!driver.decide().elements.empty()) ASSERT_LT(++events, 50);
  EXPECT_GT(events, 3);
  const Crack& crack = driver.criterion->cracks()[0];
  EXPECT_NEAR(crack.tips[0].position.x(), 10, driver.board.h());
  EXPECT_FALSE(crack.tips[0].ended) << "it rests there";
  for (Index e = 0; e < driver.problem.tet_count(); ++e) {
    if (driver.destroyed[e]) {
      EXPECT_LT(driver.board.centroid(e).x(), 10);
    }
  }
}

// h/2 and h/4 of the old reach: with Eq. 1 the load of first growth goes with sqrt(h).
TEST(ToughModelB, FirstGrowthDoesNotDependOnTheMesh) {
  for (const Index per_mm : {1, 2, 4}) {
    const test::BoardShape shape{20 * per_mm, 11 * per_mm, 1, 20, 11, 2};
    Scene scene = test::board_scene(test::structured_board(shape), FractureModel::b);
    scene.materials.begin()->second.toughness = 0.999 * slit_intensity();
    const double half = 0.5 / per_mm, y = 5.5;
    scene.cracks.push_back({Box{Vec3(-1, y - half - 1e-9, -1), Vec3(3, y + half + 1e-9, 3)},
                            Vec3(0, y, 1),
                            {Vec3(3, y, 1)}});
    Driver driver(std::move(scene));
    driver.pull(tension(1, 90));
    EXPECT_FALSE(driver.decide().elements.empty()) << per_mm;
    Driver weaker(Scene(driver.problem.scene()));
    weaker.pull(tension(0.998, 90));
    EXPECT_TRUE(weaker.decide().elements.empty()) << per_mm;
  }
}

TEST(Toughness, IsThatOfTheElementsMaterial) {
  Scene scene = test::board_scene(
      test::structured_board(
          test::kSlitShape,
          [](const Vec3& x) { return std::string(x.y() < 5 ? "board" : "strong"); }),
      FractureModel::b);
  scene.materials["board"].toughness = 2;
  scene.materials["strong"].energy = 0.25;
  const Problem problem(std::move(scene));
  const Board board(problem.mesh(), {});
  const Toughness toughness(problem, board);
  EXPECT_TRUE(toughness.any());
  EXPECT_TRUE(toughness.by_energy());
  const ToughnessView view = toughness.view(100, Vec2::UnitX());
  for (Index e = 0; e < problem.tet_count(); ++e)
    EXPECT_EQ(view.of(e), problem.material(e).toughness ? 2 : 5);
  const Problem plain(test::edge_slit(3));
  EXPECT_FALSE(Toughness(plain, board).any());
  EXPECT_EQ(Toughness(plain, board).view(100, Vec2::UnitX()).of(0), 0);
}

}  // namespace
}  // namespace sunder::fracture
