// SPDX-License-Identifier: Apache-2.0
// In-plane stress and the intact body's smoothed field (method.md "Model B", 5).
#include "fracture/pristine_field.hpp"

#include <cmath>

#include "board_fixture.hpp"
#include "body/element.hpp"

namespace sunder::fracture {
namespace {

using test::BoardShape;

TEST(Principal, ValueAndDirectionOfATensor) {
  for (double degrees : {0.0, 20.0, 90.0, 133.0}) {
    const double angle = degrees * EIGEN_PI / 180;
    const Vec2 n(std::cos(angle), std::sin(angle)), m(-n.y(), n.x());
    const Principal p = principal(3 * n * n.transpose() - 2 * m * m.transpose());
    EXPECT_NEAR(p.s1, 3, 1e-14);
    EXPECT_NEAR(std::abs(p.n1.dot(n)), 1, 1e-14);
  }
}

TEST(Principal, EqualValuesLetCracksRunAlongE1) {
  const Principal p = principal(InPlane::Identity() * 4);
  EXPECT_EQ(p.s1, 4);
  EXPECT_EQ(p.n1, Vec2(0, 1));
  EXPECT_EQ(principal(InPlane::Zero()).n1, Vec2(0, 1));
}

TEST(InPlaneStress, DropsTheThirdAxis) {
  Voigt s;
  s << 1, 2, 3, 4, 5, 6;  // xx yy zz xy yz zx
  const BoardPlane xy = board_plane(test::structured_board({2, 2, 1, 5, 4, 1}), std::nullopt);
  InPlane expected;
  expected << 1, 4, 4, 2;
  EXPECT_EQ(in_plane(s, xy), expected);
  const BoardPlane yz = board_plane(test::structured_board({2, 2, 1, 1, 4, 5}), std::nullopt);
  expected << 3, 5, 5, 2;
  EXPECT_EQ(in_plane(s, yz), expected);
}

Scene half_board() {
  return test::board_scene(
      test::structured_board(
          {8, 8, 1, 8, 8, 1},
          [](const Vec3& x) { return std::string(x.y() < 4 ? "board" : "frame"); }),
      FractureModel::b);
}

TEST(PristineField, UniformStressStaysAsItIs) {
  const Problem problem(half_board());
  const Board board(problem.mesh(), std::nullopt);
  const auto u = test::uniform_field(problem.mesh(), test::tension(2, 30));
  const PristineField field(problem, board, u);
  const InPlane expected = test::tension(2, 30).topLeftCorner<2, 2>();
  EXPECT_NEAR((*field.at(Vec2(3, 2)) - expected).norm(), 0, 1e-14);
  EXPECT_NEAR((*field.along(Vec2(0, 1), Vec2(5, 3)) - expected).norm(), 0, 1e-14);
}

/// u_y = y^2/2: stress yy grows with y.
std::vector<double> stretched_along_y(const Mesh& mesh) {
  std::vector<double> u(3 * mesh.nodes.size(), 0.0);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const double y = mesh.nodes[n].y();
    u[3 * n + 1] = y * y / 2;
  }
  return u;
}

TEST(PristineField, IsTheVolumeWeightedMeanOverBreakableNeighbours) {
  const Problem problem(half_board());
  const Board board(problem.mesh(), std::nullopt);
  const auto u = stretched_along_y(problem.mesh());
  const Vec2 p(4.2, 3.7);
  InPlane sum = InPlane::Zero();
  double volume = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!problem.breakable(e) || (board.centroid(e) - p).norm() > 1.5 * board.h()) continue;
    const Voigt s = fem::stress(problem.shape(e), problem.small_strain(e),
                                fem::corner_displacement(problem.mesh(), e, u));
    sum += problem.shape(e).volume * in_plane(s, board.plane());
    volume += problem.shape(e).volume;
  }
  EXPECT_NEAR((*PristineField(problem, board, u).at(p) - sum / volume).norm(), 0, 1e-13);
}

TEST(PristineField, EmptyNeighbourhoodsAreSkipped) {
  const Problem problem(half_board());
  const Board board(problem.mesh(), std::nullopt);
  const auto u = stretched_along_y(problem.mesh());
  const PristineField field(problem, board, u);
  EXPECT_FALSE(field.at(Vec2(4, 7)));
  EXPECT_FALSE(field.along(Vec2(2, 7), Vec2(6, 7)));
  // Stations at (k + 1/2)/9 of the way up; those above the breakable half do not count.
  const Vec2 from(4, 0), to(4, 8);
  InPlane sum = InPlane::Zero();
  int count = 0;
  for (int k = 0; k < 9; ++k) {
    if (const auto s = field.at(from + (k + 0.5) / 9 * (to - from))) {
      sum += *s;
      ++count;
    }
  }
  ASSERT_GT(count, 3);
  ASSERT_LT(count, 9);
  EXPECT_NEAR((*field.along(from, to) - sum / count).norm(), 0, 1e-14);
}

}  // namespace
}  // namespace sunder::fracture
