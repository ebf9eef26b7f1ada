// SPDX-License-Identifier: Apache-2.0
// The meter on fields that are known exactly, and on what surrounds a tip.
#include "fracture/field_sif/field_intensity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/field_sif/verification_cases.hpp"
#include "core/field_sif/williams.hpp"

namespace sunder::fracture {
namespace {

using test::CrackedBoard;
using test::CrackedBoardOptions;

/// The exact field of three modes at the tip (20, 0.5), prescribed at the nodes of split faces.
FieldView williams_view(const CrackedBoard& board, const Vec3& k, const TipMaterial& material) {
  FieldView view = board.view();
  const auto& mesh = board.problem().mesh();
  view.displacement = [&mesh, k, material](std::span<const Index> ids, std::span<Vec3> u) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const Vec3& node = mesh.nodes[ids[i]];
      Vec2 x(node.x() - 20, node.y() - 0.5);
      // Copies, which come after the grid's nodes, belong to the face above.
      if (std::abs(x.y()) < 1e-9) x.y() = ids[i] >= test::grid_node_count(mesh) ? 0.0 : -0.0;
      u[i] = Vec3(10, -20, 5);  // a rigid motion must not show
      const auto states = auxiliary_states(x.norm() > 0 ? x : Vec2(1e-3, 0), 0, material);
      for (int mode = 0; mode < kModes; ++mode) {
        u[i] += k[mode] * test::williams(x, mode, material);
        const Mat3& s = states[mode].stress;  // thinning of plane stress
        u[i].z() -= k[mode] * material.poisson / material.young * node.z() * (s(0, 0) + s(1, 1));
      }
    }
  };
  return view;
}

class ExactField : public ::testing::Test {
 protected:
  static CrackedBoardOptions split() {
    CrackedBoardOptions options;
    options.made = test::CrackMade::split;
    return options;
  }
  CrackedBoard board_{test::notched_strip(test::Notch::edge, 40, 0.5, split())};
};

/// The same field with the whole body turned by 70 degrees.
FieldView turned(const CrackedBoard& board, const FieldView& view) {
  FieldView of = view;
  const Mat3 r =
      Eigen::AngleAxisd(70 * std::numbers::pi / 180, Vec3(1, -2, 2) / 3).toRotationMatrix();
  of.displacement = [&board, r, before = view.displacement](std::span<const Index> ids,
                                                            std::span<Vec3> u) {
    before(ids, u);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const Vec3& x = board.problem().mesh().nodes[ids[i]];
      u[i] = r * (x + u[i]) - x;
    }
  };
  return of;
}

// By a law of finite deformation a domain of small strain gives the same K however it has turned.
TEST_F(ExactField, ATurnedTipHasTheKOfItsDomain) {
  CrackedBoardOptions options = split();
  options.law = MaterialLaw::corotated;
  CrackedBoard board(test::notched_strip(test::Notch::edge, 40, 0.5, options));
  const Vec3 k(0.03, 0.01, 0.02);
  const auto still = board_.meter().at(board_.crack(), 0, williams_view(board_, k, {5, 0.3, 0}), 8);
  const auto view = williams_view(board, k, {5, 0.3, 0});
  for (const FieldView& seen : {view, turned(board, view)}) {
    const auto found = board.meter().at(board.crack(), 0, seen, 8);
    EXPECT_EQ(found.note(), "");
    const double tolerance = 0.01 * k.norm();  // strain here: .1 %
    EXPECT_NEAR(found.factors.k_1, still.factors.k_1, tolerance);
    EXPECT_NEAR(found.factors.k_2, still.factors.k_2, tolerance);
    EXPECT_NEAR(found.factors.k_3, still.factors.k_3, tolerance);
  }
  // At law linear the same turn is taken for strain.
  const auto wrong = board_.meter().at(board_.crack(), 0,
                                       turned(board_, williams_view(board_, k, {5, 0.3, 0})), 8);
  EXPECT_GT(std::abs(wrong.factors.k_1 - still.factors.k_1), k.norm());
}

// J = (K_I^2 + K_II^2) / E' + K_III^2 / (2 mu) where strains are small.
TEST_F(ExactField, JIsThatOfItsK) {
  for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::corotated}) {
    CrackedBoardOptions options = split();
    options.law = law;
    CrackedBoard board(test::notched_strip(test::Notch::edge, 40, 0.5, options));
    for (const Vec3& k : {Vec3(0.03, 0, 0), Vec3(0, 0.03, 0), Vec3(0.02, 0.01, 0)}) {
      const auto found =
          board.meter().at(board.crack(), 0, williams_view(board, k, {5, 0.3, 0}), 8);
      const double expected = k.squaredNorm() / found.material.effective_young();
      EXPECT_NEAR(found.j, expected, 0.02 * expected) << k.transpose();
    }
  }
}

TEST_F(ExactField, BeyondSmallStrainThereIsNoK) {
  CrackedBoardOptions options = split();
  options.law = MaterialLaw::corotated;
  CrackedBoard board(test::notched_strip(test::Notch::edge, 40, 0.5, options));
  const auto found =
      board.meter().at(board.crack(), 0, williams_view(board, Vec3(8, 0, 0), {5, 0.3, 0}), 8);
  EXPECT_FALSE(found.disturbed.left_out);
  EXPECT_EQ(found.note(), "strain");
  EXPECT_GT(found.j, 0);
}

TEST_F(ExactField, EachModeIsMeasuredAlone) {
  for (int mode = 0; mode < kModes; ++mode) {
    Vec3 k = Vec3::Zero();
    k[mode] = 3;
    const auto view = williams_view(board_, k, {5, 0.3, 0});
    const auto result = board_.meter().at(board_.crack(), 0, view, 8.0);
    // Of signs, see below: the board's axes are its height and its width, in this order.
    const Vec3 measured(result.factors.k_1, result.factors.k_2, result.factors.k_3);
    EXPECT_LT((measured.cwiseAbs() - k).norm(), 0.02 * 3) << "mode " << mode << " " << measured;
  }
}

TEST_F(ExactField, ShearPointsWhereItPoints) {
  // K_II > 0 moves the face on the tip's left forward against the other one.
  const auto view = williams_view(board_, Vec3(1, 0.5, 0), {5, 0.3, 0});
  const auto result = board_.meter().at(board_.crack(), 0, view, 8.0);
  const auto& plane = board_.board().plane();
  const TipFrame& frame = result.frame;
  const Vec3 left = frame.axes(plane).row(1);
  EXPECT_EQ(result.factors.k_2 > 0, left.y() > 0);
  EXPECT_NEAR(std::abs(result.factors.k_2), 0.5, 0.02);
}

TEST_F(ExactField, CostsOnlyTheRing) {
  FieldView view = williams_view(board_, Vec3(1, 0, 0), {5, 0.3, 0});
  std::size_t asked = 0;
  const auto exact = view.displacement;
  view.displacement = [&](std::span<const Index> ids, std::span<Vec3> u) {
    asked += ids.size();
    for (Index n : ids) {
      const Vec3& x = board_.problem().mesh().nodes[n];
      const double r = std::hypot(x.x() - 20, x.y() - 0.5);
      EXPECT_LT(r, 8 + 2.0);  // an element's size beyond the radius
    }
    exact(ids, u);
  };
  (void)board_.meter().at(board_.crack(), 0, view, 8.0);
  EXPECT_GT(asked, 0u);
  EXPECT_LT(asked, 600u);
}

TEST_F(ExactField, SameEveryTime) {
  const auto view = williams_view(board_, Vec3(1, 2, 3), {5, 0.3, 0});
  const auto first = board_.meter().at(board_.crack(), 0, view);
  const auto second = board_.meter().at(board_.crack(), 0, view);
  EXPECT_EQ(first.factors.k_1, second.factors.k_1);
  EXPECT_EQ(first.factors.k_2, second.factors.k_2);
}

TEST(FieldIntensity, PlaneStrainWhereTheBoardIsHeldFlat) {
  CrackedBoardOptions options;
  options.held_flat = true;
  auto board = test::notched_strip(test::Notch::edge, 40, 0.3, options);
  board.load_uniform(0, 1, 0);
  board.solve();
  const auto result = board.intensity(6);
  EXPECT_EQ(result.material.constraint, 1);
  // Stress intensity under given forces knows neither E nor nu.
  EXPECT_NEAR(result.factors.k_1 / test::published_intensity(test::Notch::edge, 40, 0.3), 1, 0.02);
}

TEST(FieldIntensity, SmallDomainsInAThickBlockSeePlaneStrain) {
  // 8 mm thick, free: a domain of 3 h has its surfaces' terms, and its size does not matter.
  auto board = test::thick_strip(20, 0.5, 8, false);
  board.load_uniform(0, 1, 0);
  board.solve();
  const auto small = board.intensity(3), larger = board.intensity(3.9);
  EXPECT_EQ(small.material.constraint, 1);
  EXPECT_EQ(larger.material.constraint, 1);
  EXPECT_NEAR(larger.factors.k_1 / small.factors.k_1, 1, 0.01);
  // The front's own K lies between the plane solution's and that over sqrt(1 - nu^2).
  const double plane = test::published_intensity(test::Notch::edge, 20, 0.5);
  EXPECT_GT(small.factors.k_1, plane * 0.98);
  EXPECT_LT(small.factors.k_1, plane / std::sqrt(1 - 0.09));
}

TEST(FieldIntensity, ForeignDamageNearTheTipIsReported) {
  auto board = test::notched_strip(test::Notch::edge, 20, 0.5);
  board.load_uniform(0, 1, 0);
  board.solve();
  FieldView view = board.view();
  EXPECT_EQ(board.meter().at(board.crack(), 0, view).note(), "");
  std::vector<std::uint8_t> destroyed(view.destroyed.begin(), view.destroyed.end());
  const Vec2 tip = board.crack().tips[0].position;
  const Vec2 near = tip + 2 * board.crack().tips[0].direction;
  std::vector<Index> others;
  board.board().elements_within(near, 0.6, others);
  for (Index e : others) destroyed[e] = 1;
  view.destroyed = destroyed;
  const auto result = board.meter().at(board.crack(), 0, view);
  EXPECT_EQ(result.note(), "damage");
  EXPECT_NEAR(result.radius, kSmallestDomainRadius * board.board().h(), 1e-12);
}

TEST(FieldIntensity, NothingLeftAroundTheTipIsNoIntensity) {
  auto board = test::notched_strip(test::Notch::edge, 20, 0.5);
  board.load_uniform(0, 1, 0);
  board.solve();
  FieldView view = board.view();
  const std::vector<std::uint8_t> destroyed(view.destroyed.size(), 1);
  view.destroyed = destroyed;
  const auto result = board.meter().at(board.crack(), 0, view);
  EXPECT_EQ(result.factors.k_1, 0);
  EXPECT_EQ(result.factors.k_2, 0);
}

TEST(FieldIntensity, AThickBlockHasAFront) {
  // Six layers, plane strain: uniform along the front, equal to the plane solution.
  auto board = test::thick_strip(20, 0.5, 6, true);
  board.load_uniform(0, 1, 0);
  board.solve();
  const double published = test::published_intensity(test::Notch::edge, 20, 0.5);
  double mean = 0;
  const auto front = board.front(4);
  for (const auto& station : front) {
    EXPECT_NEAR(station.factors.k_1 / published, 1, 0.05);
    mean += station.factors.k_1 / 4;
  }
  EXPECT_NEAR(mean / board.intensity(6).factors.k_1, 1, 0.03);
}

}  // namespace
}  // namespace sunder::fracture
