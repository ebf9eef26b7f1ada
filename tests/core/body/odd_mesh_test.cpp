// SPDX-License-Identifier: Apache-2.0
// What a body may have that is odd: it is used, with one warning.
#include "sunder/problem.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/body/small_scene.hpp"
#include "sunder/board_plane.hpp"

namespace sunder::test {
namespace {

/// The one warning of a scene.
std::string only_warning(const Problem& problem) {
  EXPECT_EQ(problem.warnings().size(), 1U);
  return problem.warnings().empty() ? "" : problem.warnings().front();
}

TEST(OddMesh, IsQuietWhenNothingIsOdd) { EXPECT_TRUE(Problem(good_scene()).warnings().empty()); }

TEST(OddMesh, TurnsInvertedElements) {
  const Problem whole(good_scene());
  Scene scene = good_scene();
  std::swap(scene.mesh.tets[7][0], scene.mesh.tets[7][1]);
  std::swap(scene.mesh.tets[9][1], scene.mesh.tets[9][3]);
  const Problem problem(std::move(scene));
  expect_parts(only_warning(problem), {"2 elements of negative volume were turned", "element 7"});
  for (Index e = 0; e < problem.tet_count(); ++e) {
    EXPECT_DOUBLE_EQ(problem.shape(e).volume, whole.shape(e).volume);
    EXPECT_TRUE(std::is_permutation(problem.mesh().tets[e].begin(), problem.mesh().tets[e].end(),
                                    whole.mesh().tets[e].begin()));
  }
}

TEST(OddMesh, UnusedNodesHaveNoUnknowns) {
  Scene scene = good_scene();
  scene.mesh.nodes.emplace_back(0, 0, 0);  // in the place of node 0 even
  scene.mesh.nodes.emplace_back(50, 50, 50);
  scene.supports.push_back({std::vector<Index>{19}, Axes{7}});  // a host may hold what it likes
  scene.instruments.push_back(pull(Ball{Vec3(0, 0, 0), 0.1}, Vec3(0, -1, 0)));
  const Problem problem(std::move(scene));
  EXPECT_TRUE(problem.warnings().empty());
  EXPECT_EQ(problem.node_count(), 20);
  EXPECT_EQ(problem.dof_count(), 3 * (18 - 6));
  for (Index n : {18, 19}) EXPECT_EQ(problem.dof(n, 0), kNone);
  EXPECT_EQ(problem.instrument_nodes()[0].nodes, std::vector<Index>{0});
  EXPECT_LT(board_plane(problem.mesh(), std::nullopt).outline_max.maxCoeff(), 3);
}

TEST(OddMesh, LeavesOutBodiesThatNothingHolds) {
  Scene scene = good_scene();
  add_second_body(scene);
  const Problem problem(std::move(scene));
  expect_parts(only_warning(problem),
               {"1 body with 1 element (first: element 24 at [9.25, 0.25, 0.25])", "stays"});
  EXPECT_EQ(problem.dof_count(), 3 * (18 - 6));
  EXPECT_EQ(problem.dof(18, 0), kNone);
}

/// A tetrahedron beyond the corner node 2 at (2, 0, 0) that uses it, and node 11 above it.
void add_hanging(Scene& scene, bool by_edge) {
  const Index first = scene.mesh.node_count();
  ASSERT_EQ(scene.mesh.nodes[2], Vec3(2, 0, 0));
  ASSERT_EQ(scene.mesh.nodes[11], Vec3(2, 0, 1));
  for (const Vec3& x : {Vec3(3, 0, 0), Vec3(3, -1, 0), Vec3(3, 0, 1)})
    scene.mesh.nodes.push_back(x);
  if (by_edge) {
    scene.mesh.nodes.pop_back();
    scene.mesh.tets.push_back({2, first + 1, first, 11});
  } else {
    scene.mesh.tets.push_back({2, first + 1, first, first + 2});
  }
  scene.mesh.volume_of.push_back(0);
}

TEST(OddMesh, LatchesWhatHangsByANodeOrAnEdge) {
  for (const bool by_edge : {false, true}) {
    SCOPED_TRACE(by_edge ? "edge" : "node");
    Scene scene = good_scene();
    add_hanging(scene, by_edge);
    const Problem problem(std::move(scene));
    expect_parts(only_warning(problem), {"1 part hangs", "1 element, first: element 24"});
    // Three turns about a node, one about an edge.
    const Index of_its_own = by_edge ? 6 : 9;
    EXPECT_EQ(problem.dof_count(), 3 * (18 - 6) + of_its_own - (by_edge ? 1 : 3));
  }
}

TEST(OddMesh, CountsElementsTwiceInOnePlace) {
  Scene scene = good_scene();
  for (const Index e : {9, 4}) {
    scene.mesh.tets.push_back(scene.mesh.tets[static_cast<std::size_t>(e)]);
    scene.mesh.volume_of.push_back(0);
  }
  expect_parts(only_warning(Problem(std::move(scene))),
               {"2 elements have the same four nodes", "elements 9 and 24"});
}

/// Two boards side by side whose nodes at x = 2 are there twice: 2 x 1 cells of 2 faces.
Scene cut_scene(double gap) {
  Scene scene = good_scene();
  const Index first = scene.mesh.node_count(), elements = scene.mesh.tet_count();
  for (Index n = 0; n < first; ++n)  // mirrored, so that the faces fit
    scene.mesh.nodes.emplace_back(4 + gap - scene.mesh.nodes[n].x(), scene.mesh.nodes[n].y(),
                                  scene.mesh.nodes[n].z());
  for (Index e = 0; e < elements; ++e) {
    auto tet = scene.mesh.tets[e];
    for (Index& n : tet) n += first;
    std::swap(tet[2], tet[3]);
    scene.mesh.tets.push_back(tet);
    scene.mesh.volume_of.push_back(scene.mesh.volume_of[e]);
  }
  scene.supports[0].nodes = Box{Vec3(-1, 1.9, -1), Vec3(5, 3, 2)};
  return scene;
}

TEST(OddMesh, FindsTheCutThatDuplicatedNodesHide) {
  for (const double gap : {0.0, 1e-9}) {
    expect_parts(only_warning(Problem(cut_scene(gap))),
                 {"4 pairs of faces", "6 nodes repeat", "at [2, "});
  }
  EXPECT_TRUE(Problem(cut_scene(0.01)).warnings().empty()) << "a slot is no cut";
}

TEST(OddMesh, KnowsADeclaredCrackOfSplitNodes) {
  Scene scene = cut_scene(0);
  scene.cracks.push_back(crack({}, Vec3(2, 0, 0.5), {Vec3(2, 2, 0.5)}));
  EXPECT_TRUE(Problem(std::move(scene)).warnings().empty());
}

TEST(HeldAxes, TakeTheForceOnThem) {
  Scene scene = good_scene();  // nodes 6 to 8 are held, 3 to 5 are free
  scene.instruments.push_back(pull(std::vector<Index>{3, 6, 7, 8}, Vec3(0, -1, 0)));
  expect_parts(
      only_warning(Problem(std::move(scene))),
      {"\"forceps\"", "y of 3 nodes out of 4", "[0, -0.75, 0] N of its [0, -1, 0] N", "reaction"});
}

}  // namespace
}  // namespace sunder::test
