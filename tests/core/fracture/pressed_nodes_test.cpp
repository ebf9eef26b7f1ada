// SPDX-License-Identifier: Apache-2.0
// On which nodes an instrument presses (method.md 7).
#include "fracture/pressed_nodes.hpp"

#include "board_fixture.hpp"

namespace sunder::fracture {
namespace {

using test::Driver;
using test::grid_node;
using test::kSlitShape;

Press press_at(const Vec3& at, CrackSide side) {
  Press press;
  press.at = at;
  press.side = side;
  press.force = Vec3(0, 1, 0);
  return press;
}

std::vector<Index> pressed(const Driver& driver, const Press& press) {
  const PressedNodes found = driver.criterion->pressed_nodes(press, driver.destroyed);
  return {found.list().begin(), found.list().end()};
}

TEST(PressedNodes, OneOnEachSurfaceOfItsFace) {
  Driver driver(test::edge_slit(5));
  const auto on = [&](Vec3 at, CrackSide side) { return pressed(driver, press_at(at, side)); };
  EXPECT_EQ(on(Vec3(2.2, 5.5, 1), CrackSide::upper),
            (std::vector<Index>{grid_node(kSlitShape, 2, 6, 0), grid_node(kSlitShape, 2, 6, 1)}));
  EXPECT_EQ(on(Vec3(2.2, 5.5, 1), CrackSide::lower),
            (std::vector<Index>{grid_node(kSlitShape, 2, 5, 0), grid_node(kSlitShape, 2, 5, 1)}));
  EXPECT_EQ(on(Vec3(-9, 5.5, 1), CrackSide::upper)[0], grid_node(kSlitShape, 0, 6, 0));
}

TEST(PressedNodes, TiesGoToTheLowestId) {
  Driver driver(test::edge_slit(5));
  EXPECT_EQ(pressed(driver, press_at(Vec3(2.5, 5.5, 1), CrackSide::upper)),
            (std::vector<Index>{grid_node(kSlitShape, 2, 6, 0), grid_node(kSlitShape, 2, 6, 1)}));
}

TEST(PressedNodes, CrackThatIsNotBornOffersNone) {
  Driver driver(test::edge_slit(5));
  Press press = press_at(Vec3(2, 5.5, 1), CrackSide::upper);
  press.crack = 1;
  EXPECT_TRUE(pressed(driver, press).empty());
}

TEST(PressedNodes, NodesWithoutALiveElementAreLeft) {
  Driver driver(test::edge_slit(5));
  const Press press = press_at(Vec3(2.1, 5.5, 1), CrackSide::upper);
  const Index chosen = pressed(driver, press)[0];
  ASSERT_EQ(chosen, grid_node(kSlitShape, 2, 6, 0));
  for (Index e : driver.board.elements_of(chosen)) driver.destroyed[e] = 1;
  const auto again = pressed(driver, press);
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[0], grid_node(kSlitShape, 3, 6, 0)) << "the next nearest on the bottom";
}

TEST(PressedNodes, ASurfaceWithoutCandidatesLeavesAllToTheNearestInSpace) {
  // One layer of two is slit: its nodes lie on one surface and in the middle plane.
  const test::BoardShape shape{10, 7, 2, 10, 7, 2};
  for (const Index layer : {0, 1}) {
    Scene scene = test::board_scene(test::structured_board(shape), FractureModel::b);
    std::vector<Index> slit;
    for (Index i = 0; i < 4; ++i)
      for (Index t = 0; t < 6; ++t) slit.push_back(6 * (i + shape.nx * (3 + shape.ny * layer)) + t);
    scene.cracks.push_back({slit, Vec3(0, 3.5, 1), {Vec3(4, 3.5, 1)}});
    Driver driver(std::move(scene));
    const auto on = [&](double z) {
      return pressed(driver, press_at(Vec3(2, 4, z), CrackSide::upper));
    };
    const Index outer = 2 * layer;
    EXPECT_EQ(on(layer == 0 ? 1.8 : 0.2), std::vector<Index>{grid_node(shape, 2, 4, 1)});
    EXPECT_EQ(on(layer == 0 ? 0.1 : 1.9), std::vector<Index>{grid_node(shape, 2, 4, outer)});
  }
}

TEST(PressedNodes, LabelsDecideBeforeThePath) {
  Driver driver(test::edge_slit(5));
  Crack crack = driver.criterion->cracks()[0];
  const Press press = press_at(Vec3(2, 6, 0), CrackSide::upper);
  const Index node = grid_node(kSlitShape, 2, 6, 0);
  EXPECT_EQ(pressed_nodes(driver.board, crack, press, driver.destroyed).nodes[0], node);
  crack.side[node] = -1;  // right of the path: the lower face
  EXPECT_NE(pressed_nodes(driver.board, crack, press, driver.destroyed).nodes[0], node);
}

}  // namespace
}  // namespace sunder::fracture
