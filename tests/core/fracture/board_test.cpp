// SPDX-License-Identifier: Apache-2.0
// Projection, outline, neighbourhoods and free faces (method.md "Model B", 4).
#include "fracture/board.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sunder/error.hpp"
#include "support/msh_reader.hpp"
#include "support/structured_board.hpp"

namespace sunder::fracture {
namespace {

using test::BoardShape;
using test::structured_board;

TEST(BoardPlane, AxesFollowTheExtent) {
  const Mesh mesh = structured_board({2, 4, 1, 20, 40, 3});
  const BoardPlane plane = board_plane(mesh, std::nullopt);
  EXPECT_EQ(plane.e1, Vec3::UnitY());
  EXPECT_EQ(plane.e2, Vec3::UnitX());
  EXPECT_EQ(plane.e3, Vec3::UnitZ());
  EXPECT_EQ(plane.thickness(), 3);
  EXPECT_EQ(plane.outline_max, Vec2(40, 20));
  EXPECT_EQ(plane.project(Vec3(5, 7, 1)), Vec2(7, 5));
  EXPECT_EQ(plane.lift(Vec2(7, 5)), Vec3(5, 7, 1.5));
}

TEST(BoardPlane, TiesKeepXBeforeYBeforeZ) {
  const BoardPlane plane = board_plane(structured_board({1, 1, 1, 2, 2, 2}), std::nullopt);
  EXPECT_EQ(plane.e1, Vec3::UnitX());
  EXPECT_EQ(plane.e2, Vec3::UnitY());
}

TEST(BoardPlane, NormalOverridesTheBox) {
  const Mesh mesh = structured_board({2, 4, 1, 20, 40, 3});
  const BoardPlane plane = board_plane(mesh, Vec3(2, 0, 0));
  EXPECT_EQ(plane.e1, Vec3::UnitY());
  EXPECT_EQ(plane.e2, Vec3::UnitZ());
  EXPECT_EQ(plane.thickness(), 20);
  const BoardPlane tilted = board_plane(mesh, Vec3(0.1, -0.2, 1));
  Mat3 axes;
  axes << tilted.e1, tilted.e2, tilted.e3;
  EXPECT_NEAR((axes.transpose() * axes - Mat3::Identity()).norm(), 0, 1e-15);
  EXPECT_GT(tilted.e1.y(), 0.9);
  EXPECT_GT(tilted.e2.x(), 0.9);
  EXPECT_THROW((void)board_plane(mesh, Vec3(0, 0, 0)), InputError);
}

TEST(BoardPlane, MeanProjectedEdgeOfACube) {
  // Six tetrahedra: edges along x and y count 1, along z 0, in-plane diagonals sqrt(2).
  const BoardPlane plane = board_plane(structured_board({3, 3, 1, 3, 3, 1}), std::nullopt);
  EXPECT_NEAR(plane.edge_length, (20 + 10 * std::sqrt(2.0)) / 36, 1e-14);
}

TEST(BoardPlane, MeanProjectedEdgeOfThePapersBoard) {
  const Mesh mesh = test::read_msh22(SUNDER_SCENES "/meshes/board1954.msh");
  EXPECT_NEAR(board_plane(mesh, std::nullopt).edge_length, 2.708, 5e-4);
}

TEST(BoardPlane, ChordsOfTheOutline) {
  const BoardPlane plane = board_plane(structured_board({4, 3, 1, 4, 3, 1}), std::nullopt);
  EXPECT_DOUBLE_EQ(plane.chord(Vec2(1, 1), Vec2(1, 0)), 4);
  EXPECT_DOUBLE_EQ(plane.chord(Vec2(1, 1), Vec2(0, -1)), 3);
  EXPECT_NEAR(plane.chord(Vec2(2, 1.5), Vec2(4, 3).normalized()), 5, 1e-14);
  EXPECT_NEAR(plane.chord(Vec2(3.5, 0.5), Vec2(1, 1).normalized()), std::sqrt(2.0), 1e-14);
  EXPECT_EQ(plane.chord(Vec2(5, 5), Vec2(1, 0)), 0);
  EXPECT_DOUBLE_EQ(plane.inside(Vec2(1, 0.25)), 0.25);
  EXPECT_DOUBLE_EQ(plane.inside(Vec2(4.5, 1)), -0.5);
}

TEST(Board, NeighbourhoodsMatchASearchOfAllElements) {
  const Mesh mesh = structured_board({7, 5, 2, 9, 6, 1});
  const Board board(mesh, std::nullopt);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-2, 11), y(-2, 8), r(0, 4);
  for (int i = 0; i < 200; ++i) {
    const Vec2 p(x(random), y(random));
    const double radius = r(random);
    std::vector<Index> expected;
    for (Index e = 0; e < mesh.tet_count(); ++e)
      if ((board.centroid(e) - p).norm() <= radius) expected.push_back(e);
    std::vector<Index> found{1, 2, 3};
    board.elements_within(p, radius, found);
    EXPECT_EQ(found, expected);
    EXPECT_LE(found.size(), board.most_within(radius));
  }
}

TEST(Board, ElementsOfANodeMatchASearchOfAllElements) {
  const Mesh mesh = structured_board({3, 4, 2, 3, 4, 1});
  const Board board(mesh, std::nullopt);
  for (Index n = 0; n < mesh.node_count(); ++n) {
    std::vector<Index> expected;
    for (Index e = 0; e < mesh.tet_count(); ++e)
      for (Index m : mesh.tets[e])
        if (m == n) expected.push_back(e);
    const auto found = board.elements_of(n);
    EXPECT_EQ(std::vector<Index>(found.begin(), found.end()), expected);
  }
}

TEST(Board, FreeFacesAreLateralBottomOrTop) {
  const BoardShape shape{3, 2, 2, 3, 2, 1};
  const Mesh mesh = structured_board(shape);
  const Board board(mesh, std::nullopt);
  for (Index n = 0; n < mesh.node_count(); ++n) {
    EXPECT_EQ(board.on_bottom(n), mesh.nodes[n].z() == 0);
    EXPECT_EQ(board.on_top(n), mesh.nodes[n].z() == 1);
  }
  // Every cell side on the outline is two triangles: 2 (nx + ny) nz sides.
  std::size_t lateral = 0;
  for (Index e = 0; e < mesh.tet_count(); ++e)
    for (const auto& face : board.lateral_faces(e)) {
      ++lateral;
      EXPECT_NEAR(board.plane().inside(face.centroid), 0, 1e-15);
    }
  EXPECT_EQ(lateral, 2u * 2u * (3 + 2) * 2);
}

}  // namespace
}  // namespace sunder::fracture
