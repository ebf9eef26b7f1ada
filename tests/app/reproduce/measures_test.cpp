// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/measures.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sunder::test {
namespace {

using namespace app::reproduce;

std::vector<DestroyedElement> rows(const std::vector<Index>& ids) {
  std::vector<DestroyedElement> list;
  for (const Index id : ids) {
    DestroyedElement row;
    row.element = id;
    list.push_back(row);
  }
  return list;
}

TEST(GrownPath, MeasuresAlongTheNotchWhateverSideItPointsTo) {
  Crack crack;
  // From the right edge to the left, then up by 3 over 4.
  crack.path = {{50, 25}, {46, 25}, {42, 28}, {38, 28}};
  const GrownPath left = grown_path(crack, {46, 25}, {-1, 0});
  ASSERT_EQ(left.points.size(), 3U);
  EXPECT_DOUBLE_EQ(left.advance(), 8);
  EXPECT_DOUBLE_EQ(left.height(2).value(), 1.5);  // up is positive
  EXPECT_FALSE(left.height(8.1).has_value());
  crack.path = {{0, 25}, {4, 25}, {8, 28}, {12, 28}};
  const GrownPath right = grown_path(crack, {4, 25}, {2, 0});
  EXPECT_DOUBLE_EQ(right.height(2).value(), 1.5);
}

TEST(GrownPath, TurnsAtItsHighestPoint) {
  const GrownPath path{{{0, 0}, {10, 10}, {20, 0}}};
  const Turns turns = turns_of(path);
  EXPECT_NEAR(turns.rise_deg, 45, 1e-12);
  EXPECT_NEAR(turns.fall_deg, -45, 1e-12);
  EXPECT_DOUBLE_EQ(turns.highest, 10);
  EXPECT_DOUBLE_EQ(turns.end, 0);
  EXPECT_DOUBLE_EQ(turns.dip, 0);
  EXPECT_DOUBLE_EQ(turns_of({{{0, 0}, {5, -2}, {9, 3}, {10, -7}}}).dip, -2);
  const Turns down = turns_of({{{0, 0}, {10, -10}}});
  EXPECT_DOUBLE_EQ(down.rise_deg, 0);
  EXPECT_NEAR(down.fall_deg, -45, 1e-12);
}

/// A run that broke nothing, with one crack put into it.
RunResult with_crack(Crack crack) {
  RunResult run;
  run.plane.outline_min = {0, 0};
  run.plane.outline_max = {50, 40};
  run.cracks.push_back(std::move(crack));
  return run;
}

TEST(BornPath, RunsFromItsMouthStraightIntoTheBody) {
  Crack crack;
  crack.mouth = Vec2(50, 30);
  crack.path = {{50, 30}, {46, 31}, {40, 28}};
  const auto right = born_path(with_crack(crack));
  ASSERT_TRUE(right);
  EXPECT_DOUBLE_EQ(right->advance(), 10);
  EXPECT_DOUBLE_EQ(right->height(4).value(), 1);
  EXPECT_DOUBLE_EQ(right->points.back().y(), -2);
  crack.mouth = Vec2(0, 30);
  crack.path = {{0, 30}, {6, 29}};
  EXPECT_DOUBLE_EQ(born_path(with_crack(crack))->points.back().x(), 6);
  crack.mouth.reset();
  EXPECT_FALSE(born_path(with_crack(crack)));
  EXPECT_FALSE(born_path(RunResult{}));
}

TEST(Deviation, OverTheCommonLength) {
  const GrownPath flat{{{0, 0}, {10, 0}}}, steep{{{0, 0}, {5, 5}, {20, 20}}};
  const Deviation apart = deviation(flat, steep);
  EXPECT_DOUBLE_EQ(apart.common, 10);
  EXPECT_NEAR(apart.largest, 10, 1e-12);
  EXPECT_NEAR(apart.mean, 5, 1e-12);
  EXPECT_DOUBLE_EQ(deviation(steep, steep).largest, 0);
}

TEST(Overlap, OfTheFirstFractures) {
  const auto a = rows({1, 2, 3, 4}), b = rows({3, 4, 5, 6});
  EXPECT_DOUBLE_EQ(overlap(a, b, 4), 2.0 / 6);
  EXPECT_DOUBLE_EQ(overlap(a, b, 2), 0);
  EXPECT_DOUBLE_EQ(overlap(a, a, 9), 1);
  EXPECT_DOUBLE_EQ(overlap({}, {}, 4), 0);
}

TEST(ConnectedShare, LargestPieceBySharedNodes) {
  Mesh mesh;
  mesh.nodes.resize(16, Vec3::Zero());
  mesh.tets = {{0, 1, 2, 3}, {3, 4, 5, 6}, {6, 7, 8, 9}, {10, 11, 12, 13}};
  EXPECT_DOUBLE_EQ(connected_share(mesh, rows({0, 2, 3})), 1.0 / 3);
  EXPECT_DOUBLE_EQ(connected_share(mesh, rows({0, 1, 2, 3})), 0.75);
  EXPECT_DOUBLE_EQ(connected_share(mesh, rows({2, 1})), 1);
  EXPECT_DOUBLE_EQ(connected_share(mesh, {}), 0);
}

TEST(Power, OfAPowerLaw) {
  std::vector<Vec2> points;
  for (const double x : {1.0, 2.0, 5.0}) points.emplace_back(x, 3 * std::pow(x, 0.7));
  EXPECT_NEAR(power(points), 0.7, 1e-12);
}

}  // namespace
}  // namespace sunder::test
