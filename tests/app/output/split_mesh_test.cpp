// SPDX-License-Identifier: Apache-2.0
// Bodies that a crack has split: where their lips are drawn, how far apart they are, which faces of
// them are seen.
#include "app/output/split_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/figure/surface.hpp"

namespace sunder::app {
namespace {

TEST(ClosestOnPath, FollowsThePolylineAndItsProlongedEnds) {
  const std::vector<Vec2> path{{0, 0}, {4, 0}, {4, 3}};
  EXPECT_LT((closest_on_path(path, {1, 2}) - Vec2(1, 0)).norm(), 1e-15);
  EXPECT_LT((closest_on_path(path, {5, 1}) - Vec2(4, 1)).norm(), 1e-15);
  EXPECT_LT((closest_on_path(path, {5, -2}) - Vec2(4, 0)).norm(), 1e-15);   // outside of the bend
  EXPECT_LT((closest_on_path(path, {-3, 1}) - Vec2(-3, 0)).norm(), 1e-15);  // before the mouth
  EXPECT_LT((closest_on_path(path, {5, 9}) - Vec2(4, 9)).norm(), 1e-15);    // beyond the tip
}

/// Two tetrahedra on both sides of a face that has opened: nodes 1, 2, 3 on the left, 5, 6 and 3 on
/// the right. 3 is at the front.
struct Opened {
  Opened() {
    split.mesh.nodes = {{0, 1, 0},  {0, 0.2, 0}, {1, -0.1, 0}, {0.5, 0, 1},
                        {0, -1, 0}, {0, 0.2, 0}, {1, -0.1, 0}};
    split.mesh.tets = {{1, 2, 0, 3}, {6, 5, 4, 3}};
    split.mesh.volume_of = {0, 0};
    split.mesh.volumes = {{"tissue", 1}};
    split.in_file = {0, 1, 2, 3, 4, 1, 2};
    split.faces = {{0, {1, 2, 3}, {5, 6, 3}}};
    crack.path = {{0, 0}, {1, 0}};
    plane.e1 = Vec3::UnitX();
    plane.e2 = Vec3::UnitY();
    plane.e3 = Vec3::UnitZ();
    plane.outline_min = {-2, -2};
    plane.outline_max = {2, 2};
    plane.edge_length = 1;
  }
  [[nodiscard]] std::vector<Vec3> drawn() const {
    return on_ideal_paths(split.mesh, split.faces, std::vector<Crack>{crack}, plane);
  }
  SplitMesh split;
  Crack crack;
  BoardPlane plane;
};

TEST(IdealPath, TakesTheLipsAtTheirThicknessAndNothingElse) {
  const Opened body;
  const auto drawn = body.drawn();
  ASSERT_EQ(drawn.size(), 7u);
  for (const std::size_t lip : {1u, 5u}) EXPECT_LT((drawn[lip] - Vec3(0, 0, 0)).norm(), 1e-15);
  for (const std::size_t lip : {2u, 6u}) EXPECT_LT((drawn[lip] - Vec3(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((drawn[3] - Vec3(0.5, 0, 1)).norm(), 1e-15);
  for (const std::size_t other : {0u, 4u}) EXPECT_EQ(drawn[other], body.split.mesh.nodes[other]);
}

// A path that leaves the body aslant: the mouth's nodes go to where it crosses the edge.
TEST(IdealPath, LeavesNodesOfTheOutlineOnIt) {
  Opened body;
  body.plane.outline_min.x() = 0;
  body.crack.path = {{0, 0}, {1, 0.5}};
  const auto drawn = body.drawn();
  EXPECT_LT((drawn[1] - Vec3(0, 0, 0)).norm(), 1e-15);
  EXPECT_LT((drawn[5] - Vec3(0, 0, 0)).norm(), 1e-15);
  EXPECT_LT((drawn[2] - Vec3(0.76, 0.38, 0)).norm(), 1e-15);  // inside: the closest point
}

TEST(IdealPath, LeavesWhatIsFarFromIt) {
  Opened body;
  body.crack.path = {{0, 30}, {1, 30}};
  EXPECT_EQ(body.drawn(), body.split.mesh.nodes);
}

TEST(Openings, AreTheJumpsBetweenTheLips) {
  const Opened body;
  std::vector<Vec3> u(7, Vec3(9, 9, 9));
  u[5] = u[1] + Vec3(0.3, -0.4, 0);
  u[6] = u[2] + Vec3(0, 0, 2);
  const auto opening = openings(body.split, u);
  const std::vector<double> wanted{0, 0.5, 2, 0, 0, 0.5, 2};
  for (std::size_t n = 0; n < 7; ++n) EXPECT_NEAR(opening[n], wanted[n], 1e-15) << n;
}

TEST(CrackArea, IsThatOfOneLipOnThePath) {
  Opened body;
  body.split.drawn = body.drawn();
  body.split.area =
      face_areas(body.split.drawn, body.split.faces, std::vector<Crack>{body.crack}, body.plane);
  EXPECT_NEAR(crack_area(body.split), 0.5, 1e-15);
  EXPECT_NEAR(crack_area(body.split, 0), 0.5, 1e-15);
  EXPECT_EQ(crack_area(body.split, 1), 0);
}

// Three faces in a row, the middle one folded back over half of the first: a length of 2, not 3.
TEST(CrackArea, CountsWhatIsFoldedBackOnce) {
  const Opened body;
  // Strips of two triangles each from x to x, one high.
  std::vector<Vec3> drawn;
  std::vector<CrackFace> faces;
  double from = 0;
  for (const double to : {1.5, 1.0, 2.0}) {
    const auto first = static_cast<Index>(drawn.size());
    drawn.insert(drawn.end(), {{from, 0, 0}, {to, 0, 0}, {to, 0, 1}, {from, 0, 1}});
    faces.push_back({0, {first, first + 1, first + 2}, {}});
    faces.push_back({0, {first, first + 2, first + 3}, {}});
    from = to;
  }
  SplitMesh split;
  split.faces = faces;
  split.area = face_areas(drawn, faces, std::vector<Crack>{body.crack}, body.plane);
  EXPECT_NEAR(crack_area(split), 2, 1e-15);
  EXPECT_NEAR(split.area[2], -0.25, 1e-15);
}

// Both tetrahedra show all of their faces, of which those that hung together are lips.
TEST(FaceTable, LipsAreWhereACrackHasSplit) {
  const Opened body;
  Mesh intact = body.split.mesh;
  for (auto& tet : intact.tets) {
    for (Index& n : tet) n = body.split.in_file[static_cast<std::size_t>(n)];
  }
  const FaceTable whole(intact);
  const std::vector<std::uint8_t> none{0, 0};
  EXPECT_EQ(whole.surface(none).size(), 6u);
  const FaceTable table(body.split.mesh, whole);
  const auto faces = table.surface(none);
  EXPECT_EQ(faces.size(), 8u);
  std::vector<std::array<Index, 3>> lips;
  for (const BodyFace& face : faces) {
    if (!face.lip) continue;
    lips.push_back(face.nodes);
    std::sort(lips.back().begin(), lips.back().end());
  }
  EXPECT_EQ(lips, (std::vector<std::array<Index, 3>>{{1, 2, 3}, {3, 5, 6}}));
}

}  // namespace
}  // namespace sunder::app
