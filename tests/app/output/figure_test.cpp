// SPDX-License-Identifier: Apache-2.0
// Pictures: which faces are seen, where nodes are drawn, in which colour.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "app/figure/pose.hpp"
#include "app/figure/shading.hpp"
#include "app/figure/surface.hpp"

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

TEST(FaceTable, SurfaceOfWhatIsLiveAndWhatIsDestroyed) {
  const Scene scene = two_tets();
  const FaceTable faces(scene.mesh);
  EXPECT_EQ(faces.surface(std::vector<std::uint8_t>{0, 0}).size(), 6u);
  EXPECT_EQ(faces.surface(std::vector<std::uint8_t>{1, 1}).size(), 6u);
  EXPECT_EQ(faces.surface(std::vector<std::uint8_t>{0, 1}).size(), 8u);  // the common face twice
}

TEST(FaceTable, NormalsPointOutwards) {
  const Scene scene = two_tets();
  for (const BodyFace& face : FaceTable(scene.mesh).surface(std::vector<std::uint8_t>{0, 1})) {
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
