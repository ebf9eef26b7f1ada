// SPDX-License-Identifier: Apache-2.0
// Cracks from presets and ruptures, and the geometry of their paths (method.md 4, 7).
#include "fracture/crack_birth.hpp"

#include "board_fixture.hpp"
#include "fracture/crack_path.hpp"
#include "sunder/error.hpp"

namespace sunder::fracture {
namespace {

using test::BoardShape;
using test::kSlitShape;

InPlane in_plane_tension(double s0, double degrees) {
  return test::tension(s0, degrees).topLeftCorner<2, 2>();
}

class Birth : public ::testing::Test {
 protected:
  Mesh mesh = test::structured_board(kSlitShape);
  Board board{mesh, std::nullopt};
};

TEST_F(Birth, InnerElementStartsAnInternalCrackAcrossTheTension) {
  const Index e = 6 * (10 + 20 * 5);  // cell (10, 5): x 10..11, y 5..6
  const Crack crack = born_crack(board, e, in_plane_tension(2, 90), 3);
  EXPECT_EQ(crack.id, 3);
  EXPECT_EQ(crack.kind, CrackKind::internal);
  EXPECT_FALSE(crack.mouth);
  ASSERT_EQ(crack.tips.size(), 2u);
  const double y = board.centroid(e).y();
  EXPECT_NEAR((crack.tips[0].position - Vec2(10, y)).norm(), 0, 1e-14);
  EXPECT_NEAR((crack.tips[1].position - Vec2(11, y)).norm(), 0, 1e-14);
  EXPECT_NEAR((crack.tips[0].direction - Vec2(-1, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR((crack.tips[1].direction - Vec2(1, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR(crack.length, 1, 1e-14);
  EXPECT_NEAR(crack_length(crack), 0.5, 1e-14) << "a is half of an internal crack's path";
  EXPECT_EQ(crack.elements, std::pmr::vector<Index>{e});
}

TEST_F(Birth, SlantedTensionTurnsTheCrack) {
  const Index e = 6 * (10 + 20 * 5) + 2;
  const Crack crack = born_crack(board, e, in_plane_tension(2, 60), 0);
  const Vec2 d(std::cos(-EIGEN_PI / 6), std::sin(-EIGEN_PI / 6));
  EXPECT_NEAR((crack.tips[1].direction - d).norm(), 0, 1e-14);
  double least = 1e9, largest = -1e9;
  for (Index n : mesh.tets[e]) {
    least = std::min(least, (board.node(n) - board.centroid(e)).dot(d));
    largest = std::max(largest, (board.node(n) - board.centroid(e)).dot(d));
  }
  EXPECT_NEAR((crack.tips[0].position - board.centroid(e)).dot(d), least, 1e-14);
  EXPECT_NEAR((crack.tips[1].position - board.centroid(e)).dot(d), largest, 1e-14);
}

TEST_F(Birth, FirstTipLiesTowardsSmallerE1) {
  for (double degrees : {20.0, 70.0, 110.0, 160.0, 200.0, 290.0}) {
    const Crack crack = born_crack(board, 6 * 110 + 1, in_plane_tension(2, degrees), 0);
    EXPECT_LT(crack.tips[0].position.x(), crack.tips[1].position.x()) << degrees;
  }
}

TEST_F(Birth, EqualPrincipalsRunAlongE1) {
  const Crack crack = born_crack(board, 6 * 110, InPlane::Identity(), 0);
  EXPECT_NEAR((crack.tips[1].direction - Vec2(1, 0)).norm(), 0, 1e-14);
}

TEST_F(Birth, ElementOnTheRimStartsAnEdgeCrackInwards) {
  for (Index column : {0, 19}) {
    const double rim = column == 0 ? 0 : 20, inward = column == 0 ? 1 : -1;
    for (Index t = 0; t < 6; ++t) {
      const Index e = 6 * (column + 20 * 4) + t;
      if (board.lateral_faces(e).empty()) continue;
      const Crack crack = born_crack(board, e, in_plane_tension(1, 90), 1);
      EXPECT_EQ(crack.kind, CrackKind::edge);
      ASSERT_TRUE(crack.mouth);
      ASSERT_EQ(crack.tips.size(), 1u);
      EXPECT_EQ(crack.mouth->x(), rim);
      EXPECT_NEAR((crack.tips[0].direction - Vec2(inward, 0)).norm(), 0, 1e-14);
      EXPECT_NEAR(crack.length, 1, 1e-14) << "to the farthest node";
      EXPECT_NEAR(crack_length(crack), 1, 1e-14);
      EXPECT_NEAR((crack.tips[0].position - *crack.mouth - Vec2(inward, 0)).norm(), 0, 1e-14);
      EXPECT_FALSE(crack.tips[0].ended);
    }
  }
}

TEST_F(Birth, MouthIsTheMeanOfTheElementsLateralFaces) {
  // Corner cells have elements with two lateral faces; the mouth is the mean of their centroids.
  bool met = false;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    const auto faces = board.lateral_faces(e);
    if (faces.size() != 2) continue;
    met = true;
    const Crack crack = born_crack(board, e, in_plane_tension(1, 45), 0);
    EXPECT_NEAR((*crack.mouth - (faces[0].centroid + faces[1].centroid) / 2).norm(), 0, 1e-14);
  }
  EXPECT_TRUE(met);
}

TEST_F(Birth, TipsNearTheOutlineHaveEnded) {
  EXPECT_TRUE(at_outline(board, Vec2(0.04 * board.h(), 5)));
  EXPECT_FALSE(at_outline(board, Vec2(0.06 * board.h(), 5)));
  EXPECT_TRUE(at_outline(board, Vec2(-3, 5)));
  EXPECT_TRUE(at_outline(board, Vec2(10, 10.97)));
}

TEST_F(Birth, PresetsOfBothKinds) {
  PresetCrack edge{VolumeName{"x"}, Vec3(0, 5.5, 1), {Vec3(3, 5.5, 0)}};
  const Crack one = preset_crack(board, edge, 0, {4, 5});
  EXPECT_EQ(one.kind, CrackKind::edge);
  EXPECT_EQ(one.length, 3);
  EXPECT_EQ(one.tips[0].direction, Vec2(1, 0));
  EXPECT_EQ(one.elements, (std::pmr::vector<Index>{4, 5}));
  EXPECT_TRUE(one.side.empty()) << "labels come from growth alone";
  PresetCrack inner{VolumeName{"x"}, std::nullopt, {Vec3(8, 5, 1), Vec3(8, 2, 1)}};
  const Crack two = preset_crack(board, inner, 1, {});
  EXPECT_EQ(two.kind, CrackKind::internal);
  EXPECT_EQ(two.tips[0].direction, Vec2(0, 1));
  EXPECT_EQ(two.tips[1].direction, Vec2(0, -1));
}

TEST_F(Birth, PresetWithoutLengthInThePlaneIsRefused) {
  PresetCrack upright{VolumeName{"x"}, Vec3(1, 1, 0), {Vec3(1, 1, 2)}};
  EXPECT_THROW((void)preset_crack(board, upright, 0, {}), InputError);
}

Crack path_crack(CrackKind kind, const std::vector<Vec2>& path) {
  Crack crack;
  crack.kind = kind;
  crack.path.assign(path.begin(), path.end());
  for (std::size_t i = 0; i + 1 < crack.path.size(); ++i)
    crack.length += (crack.path[i + 1] - crack.path[i]).norm();
  return crack;
}

TEST(CrackPath, OriginIsTheMouthOrTheMiddle) {
  const std::vector<Vec2> path{Vec2(0, 0), Vec2(2, 0), Vec2(2, 4)};
  const PathPoint mouth = crack_origin(path_crack(CrackKind::edge, path));
  EXPECT_EQ(mouth.position, Vec2(0, 0));
  EXPECT_EQ(mouth.direction, Vec2(1, 0));
  const PathPoint middle = crack_origin(path_crack(CrackKind::internal, path));
  EXPECT_NEAR((middle.position - Vec2(2, 1)).norm(), 0, 1e-15);
  EXPECT_EQ(middle.direction, Vec2(0, 1));
}

TEST(CrackPath, SidesOfABentPath) {
  const Crack crack = path_crack(CrackKind::edge, {Vec2(0, 0), Vec2(4, 0), Vec2(4, 4)});
  EXPECT_EQ(path_side(crack, Vec2(2, 0.5), 1e-9), 1);
  EXPECT_EQ(path_side(crack, Vec2(2, -0.5), 1e-9), -1);
  EXPECT_EQ(path_side(crack, Vec2(2, 0), 1e-9), 0);
  EXPECT_EQ(path_side(crack, Vec2(3.5, 3), 1e-9), 1);
  EXPECT_EQ(path_side(crack, Vec2(4.5, 3), 1e-9), -1);
  EXPECT_EQ(path_side(crack, Vec2(4.6, -0.5), 1e-9), -1) << "in the lee of the kink";
  EXPECT_EQ(path_side(crack, Vec2(4.5, -0.6), 1e-9), -1);
  EXPECT_EQ(path_side(crack, Vec2(-1, 1), 1e-9), 1) << "before the mouth";
  // Turning back: past the kink, one segment's line alone would call the outside left.
  const Crack sharp = path_crack(CrackKind::edge, {Vec2(0, 0), Vec2(4, 0), Vec2(2, 3)});
  EXPECT_EQ(path_side(sharp, Vec2(4.5, 0.2), 1e-9), -1);
}

TEST(CrackPath, UpperFaceLooksUpOrRight) {
  const auto upper = [](Vec2 from, Vec2 to) {
    const Crack crack = path_crack(CrackKind::edge, {from, to});
    return std::pair{upward_normal(crack), upper_side(crack)};
  };
  EXPECT_EQ(upper(Vec2(0, 0), Vec2(2, 0)), std::pair(Vec2(0, 1), 1));
  EXPECT_EQ(upper(Vec2(2, 0), Vec2(0, 0)), std::pair(Vec2(0, 1), -1)) << "from the right edge";
  EXPECT_EQ(upper(Vec2(0, 0), Vec2(0, 2)), std::pair(Vec2(1, 0), -1)) << "upright: to the right";
  EXPECT_EQ(upper(Vec2(0, 2), Vec2(0, 0)), std::pair(Vec2(1, 0), 1));
}

TEST(CrackPath, AdvancingExtendsTheRightEnd) {
  Crack crack = path_crack(CrackKind::internal, {Vec2(0, 0), Vec2(2, 0)});
  crack.tips = {{Vec2(0, 0), Vec2(-1, 0), false}, {Vec2(2, 0), Vec2(1, 0), false}};
  advance_tip(crack, 0, Vec2(0, 1), 0.5);
  advance_tip(crack, 1, Vec2(1, 0), 0.25);
  EXPECT_EQ(crack.path,
            (std::pmr::vector<Vec2>{Vec2(0, 0.5), Vec2(0, 0), Vec2(2, 0), Vec2(2.25, 0)}));
  EXPECT_EQ(crack.length, 2.75);
  EXPECT_EQ(crack.tips[0].direction, Vec2(0, 1));
  EXPECT_EQ(orientation(crack, 0), -1);
  EXPECT_EQ(orientation(crack, 1), 1);
}

}  // namespace
}  // namespace sunder::fracture
