// SPDX-License-Identifier: Apache-2.0
// What a checked scene becomes: unknowns, selections, ramps, free faces, and the words of messages.
#include "sunder/problem.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

#include "body/board_check.hpp"
#include "core/body/small_scene.hpp"
#include "sunder/board_plane.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"
#include "support/msh_reader.hpp"

namespace sunder::test {
namespace {

TEST(GoodScene, NumbersItsUnknowns) {
  const Problem problem(good_scene());
  EXPECT_EQ(problem.node_count(), 18);
  EXPECT_EQ(problem.dof_count(), 3 * (18 - 6));  // six nodes at y = 2
  EXPECT_EQ(problem.dof(0, 0), 0);
  EXPECT_EQ(problem.dof(5, 2), 17);
  EXPECT_EQ(problem.dof(6, 0), kNone);
  EXPECT_EQ(problem.dof(9, 0), 18);
  EXPECT_EQ(problem.anchor_stiffness(), 0);
  EXPECT_TRUE(problem.breakable(0));
  EXPECT_FALSE(problem.breakable(23));
  EXPECT_DOUBLE_EQ(problem.shape(0).volume, 1.0 / 6);
}

/// What model "B" says of a body's shape.
std::vector<std::string> said_of(const BoardShape& shape,
                                 const std::function<Vec3(const Vec3&)>& bend,
                                 FractureModel model) {
  Scene scene;
  scene.mesh = structured_board(shape);
  for (Vec3& x : scene.mesh.nodes) x = bend(x);
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, -1, -9), Vec3(99, 1e-9, 99)}, Axes{7}});
  scene.fracture.model = model;
  return Problem(std::move(scene)).warnings();
}

TEST(Toughness, IsReadByModelsThatGrowCracksAlone) {
  using enum FractureModel;
  for (const FractureModel model : {none, a, b, p}) {
    Scene scene = good_scene();
    scene.fracture.model = model;
    scene.materials["upper"].energy = 0.1;  // without yield
    const Problem problem(std::move(scene));
    EXPECT_EQ(problem.destructible(23), model == b);
    EXPECT_FALSE(problem.breakable(23));
    EXPECT_TRUE(problem.destructible(0));
    const auto& said = problem.warnings();
    const bool warned = std::ranges::any_of(said, [](const std::string& text) {
      return text.find("material \"upper\" has energy, which model ") == 0 &&
             text.find("does not read") != std::string::npos;
    });
    EXPECT_EQ(warned, model != b);
  }
}

TEST(Toughness, WithoutCrackAndYieldIsAWarning) {
  const auto warned = [](bool yields, bool cracked) {
    Scene scene = good_scene();
    scene.fracture.model = FractureModel::b;
    scene.materials["lower"].toughness = 1;
    if (!yields) scene.materials["lower"].yield.reset();
    if (cracked) scene.cracks.push_back(crack({0}, Vec3(0, 0.5, 0.5), {Vec3(0.5, 0.5, 0.5)}));
    const Problem problem(std::move(scene));
    return std::ranges::any_of(problem.warnings(), [](const std::string& text) {
      return text.find("nothing can break") == 0;
    });
  };
  EXPECT_TRUE(warned(false, false));
  EXPECT_FALSE(warned(true, false));
  EXPECT_FALSE(warned(false, true));
}

TEST(ModelB, WarnsOfABodyThatIsNoBoard) {
  const auto as_it_is = [](const Vec3& x) { return x; };
  const auto wedge = [](const Vec3& x) { return Vec3(x.x(), x.y(), x.z() * (1 - x.x() / 100)); };
  // Half of it half as thick.
  const auto step = [](const Vec3& x) {
    return Vec3(x.x(), x.y(), x.x() > 25 ? x.z() / 2 : x.z());
  };
  const auto tilted = [](const Vec3& x) { return Vec3(x.x(), x.y(), x.z() + x.x() / 2); };
  const auto expect = [](const std::vector<std::string>& said, const std::string& part) {
    ASSERT_EQ(said.size(), 1u) << part;
    EXPECT_NE(said[0].find("flat board of even thickness"), std::string::npos) << said[0];
    EXPECT_NE(said[0].find(part), std::string::npos) << said[0];
  };
  using enum FractureModel;
  const BoardShape board{10, 10, 1, 50, 50, 2}, cube{5, 5, 5, 50, 50, 50},
      slab{10, 10, 2, 50, 50, 12}, thin{10, 10, 2, 50, 50, 10};
  EXPECT_TRUE(said_of(board, as_it_is, b).empty());
  EXPECT_TRUE(said_of(thin, as_it_is, b).empty());
  expect(said_of(cube, as_it_is, b), "it is 50 mm thick and 50 mm wide");
  expect(said_of(slab, as_it_is, b), "it is 12 mm thick and 50 mm wide");
  expect(said_of(board, wedge, b), "uneven, 1.5 mm in the mean and 2 mm");
  expect(said_of(board, step, b), "uneven");
  expect(said_of(board, tilted, b), "thick");
  EXPECT_TRUE(said_of(cube, as_it_is, a).empty());
  EXPECT_TRUE(said_of(cube, as_it_is, none).empty());
}

TEST(ModelB, TakesThePapersBoardsForBoards) {
  for (const char* name : {"board1954", "board1954_notch"}) {
    const std::string path = std::string(SUNDER_SCENES "/meshes/") + name + ".msh";
    EXPECT_EQ(why_no_board(read_msh22(path), {}), std::nullopt) << name;
  }
}

TEST(GoodScene, OverlappingSupportsAdd) {
  Scene scene = good_scene();
  scene.supports.push_back({std::vector<Index>{0, 6}, Axes{4}});
  const Problem problem(std::move(scene));
  EXPECT_EQ(problem.dof(0, 2), kNone);
  EXPECT_EQ(problem.dof(0, 1), 1);
  EXPECT_EQ(problem.dof(6, 0), kNone);
}

// A pull may act on a node that is held on other axes only.
TEST(GoodScene, PullBesideAHeldAxis) {
  Scene scene = good_scene();
  scene.supports.push_back({std::vector<Index>{0}, Axes{4}});
  scene.instruments.push_back(pull(std::vector<Index>{0}, Vec3(0, -1, 0)));
  EXPECT_EQ(Problem(std::move(scene)).instrument_nodes()[0].nodes, std::vector<Index>{0});
}

TEST(Messages, ShowNumbersThatAreWrong) {
  const auto refused = [](auto&& spoil) {
    Scene scene = good_scene();
    spoil(scene.materials["lower"]);
    try {
      const Problem problem(std::move(scene));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  expect_parts(refused([](Material& m) { m.poisson = 0.5000001; }), {"poisson = 0.5000001;"});
  expect_parts(refused([](Material& m) { m.young = -kNan; }), {"young = not a number;"});
  expect_parts(refused([](Material& m) { m.young = -kInf; }), {"young = -infinity;"});
  Scene scene = good_scene();
  scene.mesh.volumes[0].name = std::string(300, 'n');
  scene.materials.erase("lower");
  try {
    const Problem problem(std::move(scene));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_LT(std::string(error.what()).size(), 250U) << error.what();
    expect_parts(error.what(), {"nnn...\"", "has no material"});
  }
}

TEST(Messages, CountInTheSingularToo) {
  EXPECT_EQ(count_of(1, "node"), "1 node");
  EXPECT_EQ(count_of(2, "node"), "2 nodes");
  EXPECT_EQ(count_of(0, "body", "bodies"), "0 bodies");
  EXPECT_EQ(name_list({"a", "b"}), "\"a\", \"b\"");
  EXPECT_EQ(name_list(std::vector<std::string>(100, "a")).substr(30), "\"a\", \"a\" and 92 more");
  EXPECT_EQ(place(Vec3(1.0 / 3, -2, 1e9)), "[0.333333, -2, 1e+09]");
}

TEST(Selections, AreSortedAndUnique) {
  Scene scene = good_scene();
  scene.removals.push_back({0, std::vector<Index>{9, 3, 9}});
  scene.removals.push_back({0, Box{Vec3(0, 0, 0), Vec3(1, 1, 1)}});
  scene.removals.push_back({0, VolumeName{"upper"}});
  const Problem problem(std::move(scene));
  EXPECT_EQ(problem.removal_elements()[0], (std::vector<Index>{3, 9}));
  EXPECT_EQ(problem.removal_elements()[1], (std::vector<Index>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(problem.removal_elements()[2].front(), 12);
  EXPECT_EQ(problem.removal_elements()[2].size(), 12u);
}

TEST(Selections, BoxesAreClosedAndSurfacesNameNodes) {
  Scene scene = good_scene();
  scene.mesh.surfaces.push_back({"skin", 1, {{2, 1, 0}, {2, 0, 9}}});
  scene.instruments.push_back(pull(SurfaceName{"skin"}, Vec3(0, -1, 0)));
  scene.instruments.push_back(pull(Box{Vec3(0, 0, 0), Vec3(1, 0, 0)}, Vec3(0, -1, 0)));
  scene.instruments.push_back(pull(Ball{Vec3(0, 0, 0), 1}, Vec3(0, -1, 0)));
  scene.instruments[1].name = "b";
  scene.instruments[2].name = "c";
  const Problem problem(std::move(scene));
  EXPECT_EQ(problem.instrument_nodes()[0].nodes, (std::vector<Index>{0, 1, 2, 9}));
  EXPECT_EQ(problem.instrument_nodes()[1].nodes, (std::vector<Index>{0, 1}));
  EXPECT_EQ(problem.instrument_nodes()[2].nodes, (std::vector<Index>{0, 1, 3, 9}));
}

TEST(Ramp, RisesLinearlyAndClamps) {
  const Ramp ramp{0.2, 0.6};
  EXPECT_EQ(ramp.factor(0.1), 0);
  EXPECT_DOUBLE_EQ(ramp.factor(0.4), 0.5);
  EXPECT_EQ(ramp.factor(0.7), 1);
  const Ramp step{0.5, 0.5};
  EXPECT_EQ(step.factor(0.49), 0);
  EXPECT_EQ(step.factor(0.5), 1);
}

TEST(UnusedNodes, AreDroppedAndIdsCloseUp) {
  Mesh mesh = good_scene().mesh;
  const auto tets = mesh.tets;
  mesh.nodes.insert(mesh.nodes.begin() + 4, Vec3(7, 7, 7));
  for (auto& tet : mesh.tets) {
    for (Index& n : tet) n += n >= 4 ? 1 : 0;
  }
  mesh.surfaces.push_back({"skin", 1, {{0, 1, 2}, {0, 4, 5}, {0, 5, 6}}});
  EXPECT_EQ(drop_unused_nodes(mesh), 1);
  EXPECT_EQ(mesh.tets, tets);
  EXPECT_EQ(mesh.surfaces[0].triangles, (std::vector<std::array<Index, 3>>{{0, 1, 2}, {0, 4, 5}}));
  EXPECT_EQ(drop_unused_nodes(mesh), 0);
}

// A cube's free faces: two on each of six sides, normals outward.
TEST(FreeFaces, OfACube) {
  const Mesh mesh = structured_board({1, 1, 1, 1, 1, 1});
  const auto faces = free_faces(mesh);
  EXPECT_EQ(faces.size(), 12u);
  for (const FreeFace& f : faces) {
    const Vec3 a = mesh.nodes[f.nodes[0]], b = mesh.nodes[f.nodes[1]], c = mesh.nodes[f.nodes[2]];
    const Vec3 outward = (a + b + c) / 3 - Vec3::Constant(0.5);
    EXPECT_GT((b - a).cross(c - a).dot(outward), 0);
  }
}

}  // namespace
}  // namespace sunder::test
