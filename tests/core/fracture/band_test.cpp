// SPDX-License-Identifier: Apache-2.0
// The band ahead of a tip: which elements, how far, which side (method.md 10).
#include "fracture/band.hpp"

#include <cmath>

#include "board_fixture.hpp"
#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

using test::BoardShape;
using test::structured_board;

const BoardShape kShape{12, 8, 1, 12, 8, 1};

/// Everything lives and yields at 1, unless told otherwise.
struct Elements {
  explicit Elements(std::size_t count = 12 * 8 * 6) : dead(count, 0), yields(count, 1.0) {}
  std::vector<std::uint8_t> dead;
  std::vector<double> yields;
  [[nodiscard]] ElementView view() const { return {dead, yields}; }
};

Band find_band(const Board& board, const Ray& ray, const ElementView& view) {
  return BandSearch(board).find(ray, view);
}

Walk walk_band(const Band& band, double h, double k, double theta, const ElementView& view) {
  Walk walk{{{7, 1, 1, 1}}, 9};  // to be replaced
  fracture::walk_band(band, h, k, theta, view, walk);
  return walk;
}

std::vector<Index> ids(const Band& band) {
  std::vector<Index> out;
  for (const auto& b : band.elements) out.push_back(b.element);
  return out;
}

/// K whose reach straight ahead is r at yield 1.
double intensity_for_reach(double r) { return std::sqrt(2 * EIGEN_PI * r); }

class BandOnABoard : public ::testing::Test {
 protected:
  Mesh mesh = structured_board(kShape);
  Board board{mesh, std::nullopt};
  double h = board.h();
  Crack crack;
  Elements elements;
};

TEST_F(BandOnABoard, HoldsTheElementsTheRaySeparates) {
  // Through the middle of row 3: its elements from column 5 on have nodes at y = 3 and y = 4.
  const Ray ray{Vec2(5, 3.5), Vec2(1, 0), &crack, 1};
  const Band band = find_band(board, ray, elements.view());
  ASSERT_FALSE(band.elements.empty());
  double last = -h / 2;
  for (const auto& b : band.elements) {
    EXPECT_GE(b.rho, last);
    EXPECT_LE(b.rho, 1.5 * h);
    EXPECT_EQ(b.element / 6 / kShape.nx, 3) << "row of the element's cell";
    last = b.rho;
  }
  for (Index e : test::row_elements(kShape, 3, 5, 6))
    EXPECT_EQ(std::count_if(band.elements.begin(), band.elements.end(),
                            [&](const BandElement& b) { return b.element == e; }),
              1)
        << e;
}

/// The band by its definition, from all elements.
std::vector<std::pair<double, Index>> searched_band(const Board& board, const Ray& ray,
                                                    int near_side) {
  const double h = board.h();
  std::vector<std::pair<double, Index>> found;
  for (Index e = 0; e < board.mesh().tet_count(); ++e) {
    const double rho = (board.centroid(e) - ray.origin).dot(ray.direction);
    if (!(rho > -h / 2) || rho > 1.5 * h) continue;
    bool left = false, right = false, ahead = false;
    for (Index n : board.mesh().tets[e]) {
      const int side = node_side(board, ray, near_side, n);
      left = left || side > 0;
      right = right || side < 0;
      ahead = ahead || (board.node(n) - ray.origin).dot(ray.direction) > -h / 4;
    }
    if (left && right && ahead) found.emplace_back(rho, e);
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Band, MatchesASearchOfAllElements) {
  const Crack crack;
  // In narrow cells some elements near the tip have no node beyond -h/4.
  for (const BoardShape& shape : {kShape, BoardShape{36, 8, 1, 12, 8, 1}}) {
    const Mesh mesh = structured_board(shape);
    const Board board(mesh, std::nullopt);
    const Elements elements(mesh.tets.size());
    for (double degrees : {0.0, 25.0, 63.0, 155.0, -100.0}) {
      const double angle = degrees * EIGEN_PI / 180;
      const Ray ray{Vec2(5.3, 3.9), Vec2(std::cos(angle), std::sin(angle)), &crack, 1};
      const Band band = find_band(board, ray, elements.view());
      const auto expected = searched_band(board, ray, band.near_side);
      ASSERT_EQ(band.elements.size(), expected.size()) << degrees;
      for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_EQ(band.elements[i].element, expected[i].second) << degrees;
    }
  }
}

TEST_F(BandOnABoard, NodesOnTheRayGoWhereTheWeakerElementsAre) {
  // Along y = 4: with the ray's nodes on the left, the row under it (3) is separated; with them on
  // the right, the row above (4).
  const Ray ray{Vec2(5, 4), Vec2(1, 0), &crack, 1};
  for (Index weak_row : {3, 4}) {
    elements = Elements();
    for (Index e : test::row_elements(kShape, weak_row, 0, 12)) elements.yields[e] = 0.5;
    const Band band = find_band(board, ray, elements.view());
    ASSERT_FALSE(band.elements.empty());
    EXPECT_EQ(band.near_side, weak_row == 3 ? 1 : -1);
    for (Index e : ids(band)) EXPECT_EQ(e / 6 / kShape.nx, weak_row);
  }
}

TEST_F(BandOnABoard, OnTheRayMeansWithinAFifthOfAnEdge) {
  const Index node = test::grid_node(kShape, 6, 4, 0);  // at (6, 4)
  for (const double side : {1.0, -1.0}) {
    const Ray near{Vec2(5, 4 - side * 0.19 * h), Vec2(1, 0), &crack, 1};
    const Ray far{Vec2(5, 4 - side * 0.21 * h), Vec2(1, 0), &crack, 1};
    EXPECT_EQ(node_side(board, near, 1, node), 1);
    EXPECT_EQ(node_side(board, near, -1, node), -1);
    EXPECT_EQ(node_side(board, far, 1, node), side);
    EXPECT_EQ(node_side(board, far, -1, node), side);
  }
}

TEST_F(BandOnABoard, EqualYieldsPreferFewerElementsThenTheLeft) {
  const Ray ray{Vec2(5, 4), Vec2(1, 0), &crack, 1};
  EXPECT_EQ(find_band(board, ray, elements.view()).near_side, 1) << "tie";
  elements.dead[find_band(board, ray, elements.view()).elements.back().element] = 1;
  EXPECT_EQ(find_band(board, ray, elements.view()).near_side, 1) << "fewer under the ray";
  elements = Elements();
  for (Index e : test::row_elements(kShape, 4, 5, 6)) elements.dead[e] = 1;
  EXPECT_EQ(find_band(board, ray, elements.view()).near_side, -1) << "fewer above the ray";
}

TEST_F(BandOnABoard, UnbreakableElementsAreTheStrongest) {
  const Ray ray{Vec2(5, 4), Vec2(1, 0), &crack, 1};
  for (Index e : test::row_elements(kShape, 3, 0, 12)) elements.yields[e] = 0;
  EXPECT_EQ(find_band(board, ray, elements.view()).near_side, -1);
}

TEST_F(BandOnABoard, LabelledNodesNearTheRayKeepTheirSide) {
  const Ray ray{Vec2(5, 3.5), Vec2(1, 0), &crack, 1};
  const Index above = test::grid_node(kShape, 6, 4, 0);  // 0.5 above the ray
  const Index far = test::grid_node(kShape, 6, 6, 0);    // 2.5 above: beyond h
  crack.side[above] = -1;
  crack.side[far] = -1;
  EXPECT_EQ(node_side(board, ray, 1, above), -1);
  EXPECT_EQ(node_side(board, ray, 1, far), 1);
  const Ray first_tip{Vec2(5, 3.5), Vec2(1, 0), &crack, -1};
  EXPECT_EQ(node_side(board, first_tip, 1, above), 1) << "left of that tip is right of the path";
  // A label wins over the common side of nodes on the ray.
  const Index on_ray = test::grid_node(kShape, 6, 4, 1);
  const Ray along{Vec2(5, 4), Vec2(1, 0), &crack, 1};
  EXPECT_EQ(node_side(board, along, 1, on_ray), 1);
  crack.side[on_ray] = -1;
  EXPECT_EQ(node_side(board, along, 1, on_ray), -1);
}

TEST_F(BandOnABoard, NodesOnTheProlongedRayHaveNoSide) {
  const Ray ray{Vec2(5.5, 4), Vec2(1, 0), &crack, 1};
  EXPECT_EQ(node_side(board, ray, 1, test::grid_node(kShape, 5, 4, 0)), 0);
  EXPECT_EQ(node_side(board, ray, -1, test::grid_node(kShape, 6, 4, 0)), -1) << "ahead: the choice";
}

TEST_F(BandOnABoard, DestroyedElementsAreSkipped) {
  const Ray ray{Vec2(5, 3.5), Vec2(1, 0), &crack, 1};
  const Band whole = find_band(board, ray, elements.view());
  elements.dead[whole.elements[1].element] = 1;
  const Band rest = find_band(board, ray, elements.view());
  EXPECT_EQ(rest.elements.size() + 1, whole.elements.size());
}

TEST_F(BandOnABoard, SmallIntensityDestroysNothing) {
  const Ray ray{Vec2(5, 3.5), Vec2(1, 0), &crack, 1};
  const Band band = find_band(board, ray, elements.view());
  const Walk walk = walk_band(band, h, intensity_for_reach(0.499 * h), 0, elements.view());
  EXPECT_TRUE(walk.passed.empty());
  EXPECT_EQ(walk.advance, 0);
}

/// A band by hand: rho in h.
Band hand_band(double h, std::initializer_list<double> rhos) {
  Band band;
  for (double rho : rhos)
    band.elements.push_back({static_cast<Index>(band.elements.size()), rho * h});
  return band;
}

TEST(Walk, PassesWhatItsReachCovers) {
  const Elements all;
  const Band band = hand_band(1, {-0.2, 0.3, 0.7, 0.9});
  const Walk walk = walk_band(band, 1, intensity_for_reach(0.8), 0, all.view());
  ASSERT_EQ(walk.passed.size(), 3u);
  EXPECT_NEAR(walk.passed[0].ratio, 0.8 / 0.5, 1e-14) << "rho counts as h/2 at least";
  EXPECT_NEAR(walk.passed[2].ratio, 0.8 / 0.7, 1e-14);
  EXPECT_NEAR(walk.passed[2].reach, 0.8, 1e-14);
  // min(r_e, 1.5 h, max(rho, h/2) + h/4) = 0.8, under the survivor's 0.9.
  EXPECT_NEAR(walk.advance, 0.8, 1e-14);
}

TEST(Walk, AdvanceEndsAQuarterPastTheLastCentroid) {
  const Elements all;
  EXPECT_NEAR(walk_band(hand_band(1, {0.2, 0.6}), 1, intensity_for_reach(9), 0, all.view()).advance,
              0.85, 1e-14);
  EXPECT_NEAR(walk_band(hand_band(1, {0.2}), 1, intensity_for_reach(9), 0, all.view()).advance,
              0.75, 1e-14);
  EXPECT_NEAR(walk_band(hand_band(1, {1.4}), 1, intensity_for_reach(9), 0, all.view()).advance, 1.5,
              1e-14);
}

TEST(Walk, StopsAtTheUnbreakable) {
  Elements some;
  some.yields[1] = 0;
  const Walk walk =
      walk_band(hand_band(1, {0.2, 0.4, 0.6}), 1, intensity_for_reach(9), 0, some.view());
  ASSERT_EQ(walk.passed.size(), 1u);
  EXPECT_NEAR(walk.advance, 0.4, 1e-14) << "at most the survivor's rho";
}

TEST(Walk, ASurvivorBehindTheTipDoesNotHoldItBack) {
  Elements some;
  some.yields[1] = 0;
  const Walk walk =
      walk_band(hand_band(1, {-0.4, -0.1, 0.6}), 1, intensity_for_reach(9), 0, some.view());
  ASSERT_EQ(walk.passed.size(), 1u);
  EXPECT_NEAR(walk.advance, 0.75, 1e-14);
}

TEST(Walk, StrongElementsAreReachedLess) {
  Elements some;
  some.yields[1] = 2;  // a quarter of the reach
  const Walk walk =
      walk_band(hand_band(1, {0.2, 0.6, 0.7}), 1, intensity_for_reach(2), 0, some.view());
  EXPECT_EQ(walk.passed.size(), 1u)
      << "the stronger one stops the walk, the weaker behind it lives";
}

}  // namespace
}  // namespace sunder::fracture
