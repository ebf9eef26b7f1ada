// SPDX-License-Identifier: Apache-2.0
// Rigid modes and connected bodies, by hand.
#include "body/supports.hpp"

#include <gtest/gtest.h>

#include "support/structured_board.hpp"

namespace sunder::fem {
namespace {

Mesh cube() {
  test::BoardShape shape;
  shape.nx = shape.ny = shape.nz = 1;
  shape.width = shape.height = shape.depth = 1;
  return test::structured_board(shape);  // nodes: x fastest, then y, then z
}

TEST(RigidModes, NothingHeldLeavesSix) { EXPECT_EQ(rigid_modes_left(cube(), {}), 6); }

TEST(RigidModes, OneNodeLeavesTheRotations) {
  const std::vector<HeldDof> held = {{0, 0}, {0, 1}, {0, 2}};
  EXPECT_EQ(rigid_modes_left(cube(), held), 3);
}

TEST(RigidModes, TwoNodesLeaveTheTurnAboutTheirLine) {
  const std::vector<HeldDof> held = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}};
  EXPECT_EQ(rigid_modes_left(cube(), held), 1);
}

TEST(RigidModes, ThreeTwoOneHolds) {
  const std::vector<HeldDof> held = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  EXPECT_EQ(rigid_modes_left(cube(), held), 0);
}

TEST(RigidModes, AFaceOnRollersLeavesThree) {
  const std::vector<HeldDof> held = {{0, 2}, {1, 2}, {2, 2}, {3, 2}};
  EXPECT_EQ(rigid_modes_left(cube(), held), 3);
}

TEST(RigidModes, DoNotDependOnPlaceOrSize) {
  Mesh mesh = cube();
  for (Vec3& x : mesh.nodes) x = 1e-3 * x + Vec3(1000, -2000, 500);
  const std::vector<HeldDof> held = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  EXPECT_EQ(rigid_modes_left(mesh, held), 0);
  EXPECT_EQ(rigid_modes_left(mesh, std::span(held).first(5)), 1);
}

TEST(Bodies, TouchingThroughANodeIsOneBody) {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.tets = {{0, 1, 2, 3}, {0, 4, 6, 5}};
  EXPECT_EQ(find_bodies(mesh, {}).count, 1);
}

TEST(Bodies, ExcludedElementsConnectNothing) {
  test::BoardShape shape;
  shape.nx = 3;
  shape.ny = shape.nz = 1;
  const Mesh mesh = test::structured_board(shape);
  std::vector<std::uint8_t> middle(mesh.tets.size(), 0);
  for (int e = 6; e < 12; ++e) middle[e] = 1;
  const Bodies bodies = find_bodies(mesh, middle);
  EXPECT_EQ(bodies.count, 2);
  EXPECT_EQ(bodies.body_of_element[0], 0);
  EXPECT_EQ(bodies.body_of_element[6], kNone);
  EXPECT_EQ(bodies.body_of_element[12], 1);
  EXPECT_EQ(bodies.body_of_node[0], 0);
  EXPECT_EQ(bodies.body_of_node[3], 1);
}

}  // namespace
}  // namespace sunder::fem
