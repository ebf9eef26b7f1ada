// SPDX-License-Identifier: Apache-2.0
// Pictures: which faces are seen, where nodes are drawn, in which colour.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <set>

#include "app/figure/inset.hpp"
#include "app/figure/pose.hpp"
#include "app/figure/shading.hpp"
#include "app/figure/surface.hpp"
#include "app/figure/visible.hpp"
#include "support/structured_board.hpp"

namespace sunder::app {
namespace {

/// Two tetrahedra on a common face, standing on held nodes 0, 1, 2.
Scene two_tets() {
  Scene scene;
  scene.title = "two";
  scene.mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  scene.mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  scene.mesh.volume_of = {0, 0};
  scene.mesh.volumes = {{"tissue", 1}};
  scene.materials["tissue"] = {5.0, 0.4, 2.0};
  Support support;
  support.nodes = std::vector<Index>{0, 1, 2};
  scene.supports.push_back(support);
  return scene;
}

using Destroyed = std::vector<std::uint8_t>;

TEST(FaceTable, SurfaceIsOfLiveElementsAlone) {
  const Scene scene = two_tets();
  const FaceTable faces(scene.mesh);
  EXPECT_EQ(faces.surface(Destroyed{0, 0}).size(), 6u);
  EXPECT_EQ(faces.surface(Destroyed{1, 1}).size(), 0u);
  EXPECT_EQ(faces.removed(Destroyed{1, 1}).size(), 6u);
  EXPECT_EQ(faces.removed(Destroyed{0, 0}).size(), 0u);
  EXPECT_EQ(faces.surface(Destroyed{0, 1}).size(), 4u);
  for (const BodyFace& face : faces.surface(Destroyed{0, 1})) EXPECT_EQ(face.tet, 0);
  for (const BodyFace& face : faces.removed(Destroyed{0, 1})) EXPECT_EQ(face.tet, 1);
}

TEST(FaceTable, LipsAreWhereDestroyedElementsLay) {
  const Scene scene = two_tets();
  const FaceTable faces(scene.mesh);
  for (const BodyFace& face : faces.surface(Destroyed{0, 0})) {
    EXPECT_FALSE(face.lip);
    EXPECT_EQ(face.rim, (std::array<bool, 3>{}));
  }
  int lips = 0;
  for (const BodyFace& face : faces.surface(Destroyed{0, 1})) {
    std::array<Index, 3> nodes = face.nodes;
    std::sort(nodes.begin(), nodes.end());
    const bool between = nodes == std::array<Index, 3>{1, 2, 3};
    EXPECT_EQ(face.lip, between);
    lips += face.lip;
    for (int i = 0; i < 3; ++i)  // node 0 alone is off the common face
      EXPECT_EQ(face.rim[i], edge(face, i)[0] != 0) << edge(face, i)[0] << " " << edge(face, i)[1];
  }
  EXPECT_EQ(lips, 1);
}

TEST(FaceTable, NormalsPointOutwards) {
  const Scene scene = two_tets();
  for (const BodyFace& face : FaceTable(scene.mesh).surface(Destroyed{0, 1})) {
    Vec3 centroid = Vec3::Zero();
    for (const Index node : scene.mesh.tets[face.tet]) centroid += scene.mesh.nodes[node] / 4;
    const Vec3 &a = scene.mesh.nodes[face.nodes[0]], &b = scene.mesh.nodes[face.nodes[1]],
               &c = scene.mesh.nodes[face.nodes[2]];
    Mat3 edges;
    edges << b - a, c - a, a - centroid;
    EXPECT_GT(edges.determinant(), 0);
  }
}

State displaced(const Problem& problem, const Vec3& u3, const Vec3& u4) {
  State state = undeformed(problem);
  state.displacement[3] = u3;
  state.displacement[4] = u4;
  return state;
}

TEST(Pose, TrueScaleUnlessNothingWouldBeSeen) {
  const Problem problem(two_tets());
  const BoardPlane plane = board_plane(problem.mesh(), std::nullopt);
  const auto scale = [&](double u) {
    return pose_of(problem, plane, displaced(problem, {u, 0, 0}, {0, u, 0})).scale;
  };
  EXPECT_EQ(scale(0), 1);
  EXPECT_EQ(scale(0.1), 1);
  EXPECT_EQ(scale(0.5), 1);
  EXPECT_EQ(scale(1), 1);
  EXPECT_EQ(scale(1.2), 0.5);
  EXPECT_EQ(scale(6e-5), 1000);
  EXPECT_EQ(scale(3e-3), 20);
  EXPECT_EQ(scale(60), 0.01);
}

TEST(Pose, NodesOfDestroyedElementsAloneFollowTheirNeighbours) {
  const Problem problem(two_tets());
  const BoardPlane plane = board_plane(problem.mesh(), std::nullopt);
  State state = displaced(problem, {0.3, 0, 0}, {1e6, 1e6, 1e6});
  state.destroyed = {0, 1};
  const Pose pose = pose_of(problem, plane, state);
  EXPECT_EQ(pose.scale, 1);
  EXPECT_LT((pose.shift[4] - Vec3(0.1, 0, 0)).norm(), 1e-12);  // mean of nodes 1, 2, 3
  EXPECT_FALSE(pose.loose_piece);
}

TEST(Pose, CutOffPiecesStayNearTheirPlace) {
  const Problem problem(two_tets());
  const BoardPlane plane = board_plane(problem.mesh(), std::nullopt);
  State state = displaced(problem, {1e6, 0, 0}, {1e6, 0, 0});
  state.destroyed = {1, 0};  // element 1 keeps two held corners: it can turn about them
  const Pose pose = pose_of(problem, plane, state);
  EXPECT_TRUE(pose.loose_piece);
  EXPECT_EQ(pose.scale, 1);
  // As a whole, a share of the body's side (1 mm) at most.
  for (const Index node : {3, 4}) EXPECT_LT((pose.shift[node] - Vec3(0.12, 0, 0)).norm(), 1e-12);
}

/// A board of 4 x 4 cells of 1 mm; the six elements of the cell from (1, 1) to (2, 2) destroyed.
struct HoleyBoard {
  static constexpr test::BoardShape shape{4, 4, 1, 4, 4, 1};
  Mesh mesh = test::structured_board(shape);
  BoardPlane plane = board_plane(mesh, std::nullopt);
  Destroyed destroyed = Destroyed(mesh.tets.size(), 0);
  Pose pose;

  HoleyBoard() {
    pose.position = mesh.nodes;
    for (int p = 0; p < 6; ++p) destroyed[6 * (1 + 4 * 1) + p] = 1;
  }
  [[nodiscard]] std::vector<VisibleFace> visible() const {
    return visible_faces(mesh, plane, pose, FaceTable(mesh).surface(destroyed));
  }
};

/// Edges to be outlined, of lips or of the rest of the surface.
std::set<Edge> outlined(const std::vector<VisibleFace>& visible, bool of_lips) {
  std::set<Edge> edges;
  for (const VisibleFace& v : visible)
    for (int i = 0; i < 3; ++i)
      if (v.outlined[i] && v.face.lip == of_lips) edges.insert(edge(v.face, i));
  return edges;
}

TEST(Visible, ATearIsAGapWithAnOutlinedRim) {
  const HoleyBoard board;
  const auto visible = board.visible();
  EXPECT_EQ(visible.size(), 2u * (16 - 1));  // two triangles a cell, none where the hole is
  for (const VisibleFace& v : visible) {
    EXPECT_FALSE(board.destroyed[v.face.tet]) << v.face.tet;
    EXPECT_FALSE(v.face.lip);  // they are seen edge-on
  }
  const auto node = [](Index i, Index j) { return test::grid_node(HoleyBoard::shape, i, j, 1); };
  const std::set<Edge> rim{Edge{node(1, 1), node(2, 1)}, Edge{node(1, 2), node(2, 2)},
                           Edge{node(1, 1), node(1, 2)}, Edge{node(2, 1), node(2, 2)}};
  EXPECT_EQ(outlined(visible, false), rim);
}

TEST(Visible, ALipThatTurnsToTheViewerIsOutlinedAllRound) {
  HoleyBoard board;
  for (std::size_t n = 25; n < 50; ++n) board.pose.position[n].x() += 0.25;  // the nearer layer
  const auto visible = board.visible();
  std::size_t lips = 0;
  for (const VisibleFace& v : visible) lips += v.face.lip;
  EXPECT_EQ(lips, 2u);  // the wall at x = 2; the near edge of the one at x = 1 hides it
  const auto at = [](Index j, Index k) { return test::grid_node(HoleyBoard::shape, 2, j, k); };
  // Its rim on the near and the far side and its two contours, not the diagonal.
  const std::set<Edge> round{Edge{at(1, 1), at(2, 1)}, Edge{at(1, 0), at(2, 0)},
                             Edge{at(1, 0), at(1, 1)}, Edge{at(2, 0), at(2, 1)}};
  EXPECT_EQ(outlined(visible, true), round);
}

TEST(Visible, AnElementTurnedInsideOutLeavesNoHole) {
  const Scene scene = two_tets();
  Pose pose;
  pose.position = scene.mesh.nodes;
  pose.position[3].z() = -1;
  const auto visible = visible_faces(scene.mesh, board_plane(scene.mesh, std::nullopt), pose,
                                     FaceTable(scene.mesh).surface(Destroyed{0, 1}));
  EXPECT_EQ(visible.size(), 2u);  // its floor, now its lid, and its lip; the others are edge-on
}

std::ptrdiff_t count(const std::string& text, char c) {
  return std::count(text.begin(), text.end(), c);
}

TEST(Inset, ShowsWhatIsDestroyedOnTheOutlineOfTheUndeformedBody) {
  const HoleyBoard board;
  const std::string svg = destroyed_inset(board.mesh, board.plane, FaceTable(board.mesh),
                                          board.destroyed, {0, 0}, {100, 100});
  const std::size_t outline = svg.find("<path fill=\"none\""), black = svg.find("fill=\"#111111\"");
  ASSERT_NE(outline, std::string::npos);
  ASSERT_NE(black, std::string::npos);
  EXPECT_EQ(count(svg.substr(outline, svg.find('\n', outline) - outline), 'M'), 4 * 4);
  EXPECT_EQ(count(svg.substr(black, svg.find('\n', black) - black), 'M'), 2);  // one cell's front
}

TEST(Shading, RedsGetDarkerAndStayInRange) {
  EXPECT_EQ(red(-1), red(0));
  EXPECT_EQ(red(2), red(1));
  int last = 3 * 256;
  for (int i = 0; i <= 20; ++i) {
    const Color c = red(i / 20.0);
    EXPECT_LT(c.r + c.g + c.b, last);
    last = c.r + c.g + c.b;
    EXPECT_GE(c.r, c.g);
  }
  EXPECT_EQ(hex({255, 0, 171}), "#ff00ab");
}

}  // namespace
}  // namespace sunder::app
