// SPDX-License-Identifier: Apache-2.0
// Stress intensity and direction of a tip in a known field (method.md 5-8).
#include "fracture/tip_growth.hpp"

#include <cmath>
#include <numbers>

#include "board_fixture.hpp"
#include "fracture/geometry_factor.hpp"
#include "fracture/pristine_field.hpp"

namespace sunder::fracture {
namespace {

using std::numbers::pi;
using test::Driver;
using test::kSlitHeight;
using test::tension;

/// One pressing instrument on node `node` of the slit's face.
struct Pusher {
  Press press;
  Vec3 force;
  Index node;
};

Pusher pusher(CrackSide side, double force_y, Index column) {
  const Vec3 force(0, force_y, 0);
  Pusher p{{Vec3(column, kSlitHeight, 1), side, 0, force}, force, 0};
  p.node = test::grid_node(test::kSlitShape, column, side == CrackSide::upper ? 6 : 5, 0);
  return p;
}

/// Names the instruments so that warnings can speak of them.
Scene with_instruments(Scene scene, const std::vector<Pusher>& pushers) {
  for (std::size_t i = 0; i < pushers.size(); ++i)
    scene.instruments.push_back({"tool " + std::to_string(i), pushers[i].press, std::nullopt});
  return scene;
}

struct Outcome {
  std::optional<TipGrowth> growth;
  std::vector<Finding> findings;
};

Outcome grow_tip(Driver& driver, const std::vector<Pusher>& pushers = {}, std::size_t tip = 0) {
  for (std::size_t i = 0; i < pushers.size(); ++i)
    driver.presses.push_back({i, &pushers[i].press, pushers[i].force, {&pushers[i].node, 1}});
  const FractureState state = driver.state();
  Outcome out;
  const Crack& crack = driver.criterion->cracks()[0];
  FacePressure faces;
  face_pressure(driver.board, crack, state, out.findings, faces);
  const PristineField field(driver.problem, driver.board, driver.pristine);
  out.growth = tip_growth(driver.board, field, crack, tip, faces, state);
  return out;
}

TEST(TipGrowth, TensionAcrossTheSlit) {
  Driver driver(test::edge_slit(5));
  driver.pull(tension(0.3, 90));
  const auto growth = grow_tip(driver).growth;
  ASSERT_TRUE(growth);
  const SifTerms& k = growth->terms;
  EXPECT_DOUBLE_EQ(k.a, 5);
  EXPECT_DOUBLE_EQ(k.b, 20);
  EXPECT_NEAR(k.sigma0, 0.3, 1e-14);
  EXPECT_NEAR(k.beta, 0, 1e-6);
  EXPECT_NEAR(k.k_a, edge_factor(0.25) * 0.3 * std::sqrt(pi * 5), 1e-13);
  EXPECT_EQ(k.k, k.k_a);
  EXPECT_NEAR(k.theta, 0, 1e-12);
  EXPECT_NEAR((growth->direction - Vec2(1, 0)).norm(), 0, 1e-14);
}

TEST(TipGrowth, AngledTensionCountsByCosSquaredAndTurnsTheCrack) {
  for (double beta : {-50.0, -20.0, 10.0, 45.0}) {
    Driver straight(test::edge_slit(5)), angled(test::edge_slit(5));
    straight.pull(tension(0.3, 90));
    angled.pull(tension(0.3, 90 + beta));
    const auto reference = grow_tip(straight).growth, growth = grow_tip(angled).growth;
    ASSERT_TRUE(reference && growth);
    const double cosine = std::cos(beta * pi / 180);
    EXPECT_NEAR(growth->terms.k_a / reference->terms.k_a, cosine * cosine, 1e-12) << beta;
    EXPECT_NEAR(growth->terms.beta, std::abs(beta), 1e-10);
    EXPECT_NEAR(growth->terms.theta, beta, 1e-10) << "perpendicular to n1, counter-clockwise";
  }
}

TEST(TipGrowth, InternalSlitUsesHalfItsLengthAndItsFactor) {
  Driver driver(test::internal_slit(8, 12));
  driver.pull(tension(0.3, 90));
  for (std::size_t tip : {0u, 1u}) {
    const auto growth = grow_tip(driver, {}, tip).growth;
    ASSERT_TRUE(growth);
    EXPECT_DOUBLE_EQ(growth->terms.a, 2);
    EXPECT_NEAR(growth->terms.k_a, internal_factor(4.0 / 20) * 0.3 * std::sqrt(pi * 2), 1e-13);
    EXPECT_NEAR((growth->direction - Vec2(tip == 0 ? -1 : 1, 0)).norm(), 0, 1e-13);
  }
}

TEST(TipGrowth, WithoutBreakableElementsAtTheTipItRunsStraight) {
  Driver driver(test::edge_slit(10, test::structured_board(test::kSlitShape, [](const Vec3& x) {
                                  return std::string(x.x() < 5 ? "board" : "frame");
                                })));
  driver.pull(tension(0.3, 60));
  const auto growth = grow_tip(driver).growth;
  ASSERT_TRUE(growth);
  EXPECT_NEAR(growth->terms.sigma0, 0.3, 1e-14) << "the stations near the mouth are not empty";
  EXPECT_EQ(growth->terms.theta, 0);
}

TEST(TipGrowth, PullAlongTheSlitAtTheTipLeadsToTheLeft) {
  for (const bool from_right : {false, true}) {
    Scene scene = test::edge_slit(5);
    if (from_right) {
      scene.cracks[0] = {
          test::row_elements(test::kSlitShape, 5, 15, 20), Vec3(20, 5.5, 1), {Vec3(15, 5.5, 1)}};
    }
    Driver driver(std::move(scene));
    // Stress yy = 0.6 everywhere, xx = 2 around the tip only: few stations see it.
    const double middle = from_right ? 16 : 4;
    for (std::size_t n = 0; n < driver.problem.mesh().nodes.size(); ++n) {
      const Vec3& x = driver.problem.mesh().nodes[n];
      const bool at_tip = from_right ? x.x() < middle : x.x() > middle;
      driver.pristine[3 * n] = at_tip ? 2 * (x.x() - middle) : 0;
      driver.pristine[3 * n + 1] = 0.6 * x.y();
    }
    const auto growth = grow_tip(driver).growth;
    ASSERT_TRUE(growth);
    ASSERT_NEAR(growth->terms.theta, 90, 1e-12) << "left of d, whichever way d points";
  }
}

TEST(TipGrowth, CompressionDoesNotGrow) {
  Driver driver(test::edge_slit(5));
  driver.pull(tension(-0.3, 90));
  EXPECT_FALSE(grow_tip(driver).growth) << "the larger principal is 0 along the slit";
}

TEST(TipGrowth, RemoteStressIsAveragedOverTheLineOrTakenAtTheTip) {
  // yy grows as x: at mean station 2.5 mm from the mouth, at the tip 5 mm.
  Scene at_tip = test::edge_slit(5);
  at_tip.fracture.sigma0 = RemoteStress::tip;
  Driver line(test::edge_slit(5)), tip(std::move(at_tip));
  for (Driver* d : {&line, &tip}) {
    for (std::size_t n = 0; n < d->problem.mesh().nodes.size(); ++n) {
      const Vec3& x = d->problem.mesh().nodes[n];
      d->pristine[3 * n] = -x.y() * x.y() / 2;  // no shear
      d->pristine[3 * n + 1] = x.x() * x.y();
    }
  }
  const PristineField field(line.problem, line.board, line.pristine);
  const auto expected = principal(*field.along(Vec2(0, kSlitHeight), Vec2(5, kSlitHeight))).s1;
  EXPECT_NEAR(grow_tip(line).growth->terms.sigma0, expected, 1e-13);
  EXPECT_NEAR(expected, 2.5, 0.2);
  EXPECT_NEAR(grow_tip(tip).growth->terms.sigma0, 5, 0.2);
}

TEST(TipGrowth, BalancedPressureGoesStraight) {
  const std::vector<Pusher> pair{pusher(CrackSide::upper, 3, 2), pusher(CrackSide::lower, -3, 2)};
  Driver driver(with_instruments(test::edge_slit(5), pair));
  const auto growth = grow_tip(driver, pair).growth;
  ASSERT_TRUE(growth);
  const double distance = std::hypot(3, 0.5);  // from (5, 5.5) to (2, 6) and (2, 5)
  EXPECT_NEAR(growth->terms.k_b, 2 * (3.0 / 2) / std::sqrt(2 * pi * distance), 1e-13);
  EXPECT_EQ(growth->terms.k_c, 0);
  EXPECT_EQ(growth->terms.k, growth->terms.k_b);
  EXPECT_EQ(growth->terms.theta, 0);
}

TEST(TipGrowth, OneSidedPressureTurnsToItsSide) {
  for (const auto side : {CrackSide::upper, CrackSide::lower}) {
    const std::vector<Pusher> one{pusher(side, side == CrackSide::upper ? 3 : -3, 2)};
    Driver driver(with_instruments(test::edge_slit(5), one));
    const auto growth = grow_tip(driver, one).growth;
    ASSERT_TRUE(growth);
    EXPECT_EQ(growth->terms.k_b, 0);
    EXPECT_NEAR(growth->terms.k_c, 1.5 / std::sqrt(2 * pi * std::hypot(3, 0.5)), 1e-13);
    EXPECT_NEAR(growth->terms.theta, side == CrackSide::upper ? 90 : -90, 1e-12);
  }
}

TEST(TipGrowth, SurplusTurnsPartly) {
  const std::vector<Pusher> both{pusher(CrackSide::upper, 5, 2), pusher(CrackSide::lower, -3, 2)};
  Driver driver(with_instruments(test::edge_slit(5), both));
  const auto growth = grow_tip(driver, both).growth;
  ASSERT_TRUE(growth);
  // K_b d + K_c e_c with K_b = 2 * 3, K_c = 2 (same denominator).
  EXPECT_NEAR(growth->terms.theta, std::atan(2.0 / 6) * 180 / pi, 1e-12);
}

TEST(TipGrowth, TellsTheVectorsThatMakeItsDirection) {
  const std::vector<Pusher> both{pusher(CrackSide::upper, 5, 2), pusher(CrackSide::lower, -3, 2)};
  Driver driver(with_instruments(test::edge_slit(5), both));
  driver.pull(tension(0.3, 110));
  const auto growth = grow_tip(driver, both).growth;
  ASSERT_TRUE(growth);
  const SifTerms& k = growth->terms;
  const double angle = 20 * pi / 180;
  EXPECT_EQ(k.at, Vec2(5, kSlitHeight));
  EXPECT_EQ(k.d, Vec2(1, 0));
  EXPECT_NEAR((k.e_a - Vec2(std::cos(angle), std::sin(angle))).norm(), 0, 1e-12);
  EXPECT_NEAR((k.e_c - Vec2(0, 1)).norm(), 0, 1e-12);
  const Vec2 v = k.k_a * k.e_a + k.k_b * k.d + k.k_c * k.e_c;
  EXPECT_NEAR((v.normalized() - growth->direction).norm(), 0, 1e-12);
}

TEST(TipGrowth, PressureFallsWithTheRootOfItsDistance) {
  double k[2], b[2];
  for (Index i : {0, 1}) {
    const Index column = i == 0 ? 4 : 1;
    const std::vector<Pusher> pair{pusher(CrackSide::upper, 3, column),
                                   pusher(CrackSide::lower, -3, column)};
    Driver driver(with_instruments(test::edge_slit(5), pair));
    k[i] = grow_tip(driver, pair).growth->terms.k_b;
    b[i] = std::hypot(5 - column, 0.5);
  }
  EXPECT_NEAR(k[0] / k[1], std::sqrt(b[1] / b[0]), 1e-12);
}

TEST(TipGrowth, DistanceIsWeightedByPressure) {
  FacePressure faces;
  EXPECT_EQ(pressure_distance(faces, Vec2(0, 0)), 0);
  faces.pushes = {{3, Vec2(0, 4)}, {1, Vec2(8, 0)}};
  EXPECT_DOUBLE_EQ(pressure_distance(faces, Vec2(0, 0)), (3 * 4 + 8) / 4.0);
}

TEST(TipGrowth, PressureAtTheTipCountsFromHalfAnEdge) {
  // The tip lies 0.1 mm under the pressed node (5, 6); the crack rises 0.4 mm over 5 mm.
  const std::vector<Pusher> one{pusher(CrackSide::upper, 3, 5)};
  Scene scene = with_instruments(test::edge_slit(5), one);
  scene.cracks[0].tips[0] = Vec3(5, 5.9, 1);
  Driver driver(std::move(scene));
  const double pressure = 3 * 5 / std::hypot(5, 0.4) / 2;
  EXPECT_NEAR(grow_tip(driver, one).growth->terms.k_c,
              pressure / std::sqrt(2 * pi * driver.board.h() / 2), 1e-13);
}

TEST(TipGrowth, ClosingPushCountsZeroWithAWarning) {
  const std::vector<Pusher> shut{pusher(CrackSide::upper, -3, 2)};
  Driver driver(with_instruments(test::edge_slit(5), shut));
  const Outcome out = grow_tip(driver, shut);
  EXPECT_FALSE(out.growth);
  ASSERT_EQ(out.findings.size(), 1u);
  EXPECT_EQ(sentence(out.findings[0], driver.problem.scene()),
            "instrument \"tool 0\" pushes crack 0 shut on its upper face and counts as no pressure "
            "in its stress intensity");
}

TEST(TipGrowth, OneSidedPressureAddsWithTheExpansionAndSubtractsAgainstIt) {
  // The lower part is pulled down: pressing the lower face helps, the upper face hinders.
  for (const auto side : {CrackSide::upper, CrackSide::lower}) {
    const std::vector<Pusher> one{pusher(side, side == CrackSide::upper ? 0.1 : -0.1, 2)};
    Driver driver(with_instruments(test::edge_slit(5), one));
    driver.pull(tension(0.3, 90));
    driver.resultant = Vec3(0, -10, 0);
    const auto growth = grow_tip(driver, one).growth;
    ASSERT_TRUE(growth);
    const double s = side == CrackSide::lower ? 1 : -1;
    EXPECT_NEAR(growth->terms.k, growth->terms.k_a + s * growth->terms.k_c, 1e-14);
    EXPECT_EQ(growth->terms.theta > 0, side == CrackSide::upper) << "the direction knows no s";
  }
}

TEST(TipGrowth, ToolLengthIsTheDistanceToThePressedPoint) {
  const std::vector<Pusher> pair{pusher(CrackSide::upper, 3, 2), pusher(CrackSide::lower, -3, 2)};
  Scene scene = with_instruments(test::edge_slit(5), pair);
  scene.fracture.crack_length = CrackLength::tool;
  Driver driver(std::move(scene));
  driver.pull(tension(0.3, 90));
  const double distance = std::hypot(3, 0.5);
  EXPECT_DOUBLE_EQ(grow_tip(driver, pair).growth->terms.a, distance);
  driver.presses.clear();
  EXPECT_DOUBLE_EQ(grow_tip(driver).growth->terms.a, 5) << "nothing presses";
}

TEST(TipGrowth, CrackFromTheRightEdgeKnowsItsUpperFace) {
  // Mouth at x = 20, running left: the upper face is right of the path.
  Scene scene = test::board_scene(test::structured_board(test::kSlitShape), FractureModel::b);
  scene.cracks.push_back(
      {test::row_elements(test::kSlitShape, 5, 15, 20), Vec3(20, 5.5, 1), {Vec3(15, 5.5, 1)}});
  const std::vector<Pusher> one{pusher(CrackSide::upper, 3, 18)};
  Driver driver(with_instruments(std::move(scene), one));
  const auto growth = grow_tip(driver, one).growth;
  ASSERT_TRUE(growth);
  EXPECT_NEAR(growth->terms.theta, -90, 1e-12) << "up is to the right of a crack that runs left";
  EXPECT_NEAR((growth->direction - Vec2(0, 1)).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace sunder::fracture
