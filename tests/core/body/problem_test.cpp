// SPDX-License-Identifier: Apache-2.0
// Bad scenes: each fault is refused with its kind, and with a message that names the place and
// the value.
#include "sunder/problem.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <limits>

#include "body/board_check.hpp"
#include "sunder/board_plane.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"
#include "support/msh_reader.hpp"
#include "support/structured_board.hpp"

namespace sunder {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// 2 x 2 x 1 cells, 24 elements, nodes 0 to 17; held at y = 2.
Scene good_scene() {
  Scene scene;
  scene.source = "scene.toml";
  scene.mesh = test::structured_board(
      {2, 2, 1, 2, 2, 1}, [](const Vec3& x) { return std::string(x.y() < 1 ? "lower" : "upper"); });
  scene.materials["lower"] = {5, 0.4, 2.0};
  scene.materials["upper"] = {8, 0.4, std::nullopt};
  scene.supports.push_back({Box{Vec3(-1, 1.9, -1), Vec3(3, 3, 2)}, Axes{7}});
  return scene;
}

Instrument pull(NodeSelection nodes, const Vec3& force) {
  Instrument tool;
  tool.name = "forceps";
  tool.action = Pull{std::move(nodes), force};
  return tool;
}

Instrument grip(NodeSelection nodes, const Vec3& displacement, Axes axes = {}) {
  Instrument tool;
  tool.name = "clamp";
  tool.action = Grip{std::move(nodes), displacement, axes};
  return tool;
}

Instrument press(int crack) {
  Instrument tool;
  tool.name = "probe";
  tool.action = Press{Vec3(1, 1, 0), CrackSide::upper, crack, Vec3(0, 1, 0)};
  return tool;
}

PresetCrack crack(std::vector<Index> elements, std::optional<Vec3> mouth, std::vector<Vec3> tips) {
  return {ElementSelection(std::move(elements)), mouth, std::move(tips)};
}

struct Fault {
  const char* name;
  std::function<void(Scene&)> spoil;
  InputFault fault;
  std::vector<std::string> message;  // parts that it must contain
};

class BadScene : public ::testing::TestWithParam<Fault> {};

TEST_P(BadScene, IsRefused) {
  Scene scene = good_scene();
  GetParam().spoil(scene);
  try {
    const Problem problem(std::move(scene));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), GetParam().fault) << error.what();
    EXPECT_EQ(error.exit_code(), 3);
    const std::string what = error.what();
    EXPECT_EQ(what.rfind("scene.toml: ", 0), 0u) << what;
    for (const std::string& part : GetParam().message) {
      EXPECT_NE(what.find(part), std::string::npos) << '"' << part << "\" is not in: " << what;
    }
  }
}

const std::vector<Fault> kMaterialFaults = {
    {"YoungZero",
     [](Scene& s) { s.materials["lower"].young = 0; },
     InputFault::out_of_range,
     {"lower", "young = 0", "above 0"}},
    {"YoungNegative",
     [](Scene& s) { s.materials["lower"].young = -5; },
     InputFault::out_of_range,
     {"lower", "young = -5"}},
    {"YoungNan",
     [](Scene& s) { s.materials["upper"].young = kNan; },
     InputFault::out_of_range,
     {"upper", "not a number", "finite"}},
    {"YoungInfinite",
     [](Scene& s) { s.materials["upper"].young = kInf; },
     InputFault::out_of_range,
     {"upper", "inf"}},
    {"PoissonHalf",
     [](Scene& s) { s.materials["lower"].poisson = 0.5; },
     InputFault::out_of_range,
     {"lower", "poisson = 0.5", "below 0.5"}},
    {"PoissonMinusOne",
     [](Scene& s) { s.materials["lower"].poisson = -1; },
     InputFault::out_of_range,
     {"poisson = -1"}},
    {"PoissonNan",
     [](Scene& s) { s.materials["lower"].poisson = kNan; },
     InputFault::out_of_range,
     {"poisson = not a number"}},
    {"YieldZero",
     [](Scene& s) { s.materials["lower"].yield = 0; },
     InputFault::out_of_range,
     {"lower", "yield = 0", "left out"}},
    {"YieldInfinite",
     [](Scene& s) { s.materials["lower"].yield = kInf; },
     InputFault::out_of_range,
     {"yield = inf"}},
    {"VolumeWithoutMaterial",
     [](Scene& s) { s.materials.erase("upper"); },
     InputFault::no_material,
     {"upper", "12 elements"}},
    {"MaterialWithoutVolume",
     [](Scene& s) {
       s.materials["middle"] = {5, 0.4, 1.0};
     },
     InputFault::unknown_name,
     {"middle", "\"lower\"", "\"upper\""}},
};

const std::vector<Fault> kMeshFaults = {
    {"NoTetrahedra",
     [](Scene& s) {
       s.mesh.tets.clear();
       s.mesh.volume_of.clear();
     },
     InputFault::no_tetrahedra,
     {"no tetrahedra"}},
    {"ZeroVolume",
     [](Scene& s) { s.mesh.nodes[4] = s.mesh.nodes[3]; },
     InputFault::degenerate_element,
     {"element ", "zero volume"}},
    {"RepeatedNode",
     [](Scene& s) { s.mesh.tets[5][2] = s.mesh.tets[5][0]; },
     InputFault::degenerate_element,
     {"element 5"}},
    {"NodeOutside",
     [](Scene& s) { s.mesh.tets[3][1] = 18; },
     InputFault::bad_id,
     {"element 3", "node 18", "0 to 17"}},
    {"NodeNegative",
     [](Scene& s) { s.mesh.tets[3][1] = -1; },
     InputFault::bad_id,
     {"element 3", "node -1"}},
    {"CoordinateNan",
     [](Scene& s) { s.mesh.nodes[2].z() = kNan; },
     InputFault::out_of_range,
     {"node 2", "finite"}},
    {"VolumeTwice",
     [](Scene& s) { s.mesh.volumes[1].name = "lower"; },
     InputFault::duplicate_name,
     {"lower", "twice"}},
    {"VolumeOutside",
     [](Scene& s) { s.mesh.volume_of[9] = 2; },
     InputFault::bad_id,
     {"element 9", "volume 2"}},
    {"VolumeMissing", [](Scene& s) { s.mesh.volume_of.pop_back(); }, InputFault::bad_id, {}},
    {"SurfaceNodeOutside",
     [](Scene& s) {
       s.mesh.surfaces.push_back({"skin", 1, {{0, 1, 99}}});
     },
     InputFault::bad_id,
     {"skin", "99"}},
};

void add_second_body(Scene& scene) {
  const Index first = scene.mesh.node_count();
  for (const Vec3& x : {Vec3(9, 0, 0), Vec3(10, 0, 0), Vec3(9, 1, 0), Vec3(9, 0, 1)}) {
    scene.mesh.nodes.push_back(x);
  }
  scene.mesh.tets.push_back({first, first + 1, first + 2, first + 3});
  scene.mesh.volume_of.push_back(0);
}

const std::vector<Fault> kSupportFaults = {
    {"NoSupport",
     [](Scene& s) { s.supports.clear(); },
     InputFault::unsupported_body,
     {"element 0", "6 rigid modes"}},
    {"Rollers",
     [](Scene& s) { s.supports[0].axes = Axes{2}; },
     InputFault::unsupported_body,
     {"3 rigid modes"}},
    {"Hinge",
     [](Scene& s) {
       s.supports[0].nodes = std::vector<Index>{0, 1};
     },
     InputFault::unsupported_body,
     {"1 rigid mode is left"}},
    {"SecondBodyDrivenNotHeld",
     [](Scene& s) {
       add_second_body(s);
       s.instruments.push_back(pull(std::vector<Index>{18}, Vec3(0, -1, 0)));
     },
     InputFault::unsupported_body,
     {"element 24", "body 1 of 2", "6 rigid modes are left"}},
    {"GripHoldsTooLittle",
     [](Scene& s) {
       s.supports.clear();
       s.instruments.push_back(grip(std::vector<Index>{0}, Vec3::Zero()));
     },
     InputFault::unsupported_body,
     {"3 rigid modes"}},
    {"EverythingHeld",
     [](Scene& s) {
       s.supports[0].nodes = Box{Vec3(-1, -1, -1), Vec3(3, 3, 3)};
     },
     InputFault::unsupported_body,
     {"every node is held"}},
    {"SupportSelectsNothing",
     [](Scene& s) {
       s.supports[0].nodes = Box{Vec3(7, 7, 7), Vec3(8, 8, 8)};
     },
     InputFault::empty_selection,
     {"fixed 0", "no node"}},
    {"SupportWithoutAxes",
     [](Scene& s) { s.supports[0].axes = Axes{0}; },
     InputFault::out_of_range,
     {"fixed 0", "axis"}},
    {"SupportNodeOutside",
     [](Scene& s) { s.supports[0].nodes = std::vector<Index>{18}; },
     InputFault::bad_id,
     {"fixed 0", "node 18", "0 to 17"}},
    {"SupportBoxBackwards",
     [](Scene& s) {
       s.supports[0].nodes = Box{Vec3(3, 3, 3), Vec3(-1, -1, -1)};
     },
     InputFault::out_of_range,
     {"fixed 0", "box"}},
    {"SupportBoxNan",
     [](Scene& s) {
       s.supports[0].nodes = Box{Vec3(kNan, 0, 0), Vec3(1, 1, 1)};
     },
     InputFault::out_of_range,
     {"fixed 0", "box"}},
    {"SupportBallNegative",
     [](Scene& s) {
       s.supports[0].nodes = Ball{Vec3(0, 0, 0), -1};
     },
     InputFault::out_of_range,
     {"fixed 0", "radius"}},
    {"SupportUnknownSurface",
     [](Scene& s) { s.supports[0].nodes = SurfaceName{"skin"}; },
     InputFault::unknown_name,
     {"fixed 0", "skin", "no named surfaces"}},
};

const std::vector<Fault> kInstrumentFaults = {
    {"PullOnUnusedNode",
     [](Scene& s) {
       s.mesh.nodes.emplace_back(5, 5, 5);
       s.instruments.push_back(pull(std::vector<Index>{0, 18}, Vec3(0, -1, 0)));
     },
     InputFault::bad_id,
     {"forceps", "node 18", "no element uses"}},
    {"PullOnGrippedNode",
     [](Scene& s) {
       s.instruments.push_back(grip(std::vector<Index>{0}, Vec3(0, 1, 0)));
       s.instruments.push_back(pull(std::vector<Index>{0}, Vec3(1, 0, 0)));
     },
     InputFault::load_on_held_node,
     {"forceps", "node 0", "along x", "clamp"}},
    {"ForceNan",
     [](Scene& s) { s.instruments.push_back(pull(std::vector<Index>{0}, Vec3(0, kNan, 0))); },
     InputFault::out_of_range,
     {"forceps", "force", "finite"}},
    {"PullSelectsNothing",
     [](Scene& s) {
       s.instruments.push_back(pull(Ball{Vec3(9, 9, 9), 1}, Vec3(0, 1, 0)));
     },
     InputFault::empty_selection,
     {"forceps"}},
    {"GripOnSupport",
     [](Scene& s) { s.instruments.push_back(grip(std::vector<Index>{6}, Vec3(0, 1, 0))); },
     InputFault::conflicting_supports,
     {"clamp", "node 6", "x", "support"}},
    {"TwoGripsOnOneNode",
     [](Scene& s) {
       s.instruments.push_back(grip(std::vector<Index>{0, 1}, Vec3(0, 1, 0)));
       s.instruments.push_back(grip(std::vector<Index>{1, 2}, Vec3(0, 1, 0)));
       s.instruments.back().name = "second";
     },
     InputFault::conflicting_supports,
     {"second", "node 1", "clamp"}},
    {"GripWithoutAxes",
     [](Scene& s) { s.instruments.push_back(grip(std::vector<Index>{0}, Vec3(0, 1, 0), Axes{0})); },
     InputFault::out_of_range,
     {"clamp", "axis"}},
    {"GripInfinite",
     [](Scene& s) { s.instruments.push_back(grip(std::vector<Index>{0}, Vec3(kInf, 0, 0))); },
     InputFault::out_of_range,
     {"clamp", "displacement"}},
    {"NameTwice",
     [](Scene& s) {
       s.instruments.push_back(pull(std::vector<Index>{0}, Vec3(0, 1, 0)));
       s.instruments.push_back(pull(std::vector<Index>{1}, Vec3(0, 1, 0)));
     },
     InputFault::duplicate_name,
     {"forceps", "twice"}},
    {"RampBackwards",
     [](Scene& s) {
       s.instruments.push_back(pull(std::vector<Index>{0}, Vec3(0, 1, 0)));
       s.instruments.back().ramp = Ramp{0.8, 0.2};
     },
     InputFault::out_of_range,
     {"forceps", "[0.8, 0.2]"}},
    {"PressOnMissingCrack",
     [](Scene& s) { s.instruments.push_back(press(0)); },
     InputFault::unknown_name,
     {"probe", "crack 0"}},
    {"PressUnderModelA",
     [](Scene& s) {
       s.fracture.model = FractureModel::a;
       s.instruments.push_back(press(0));
     },
     InputFault::unknown_name,
     {"probe", "keeps no cracks"}},
    {"PressOnNegativeCrack",
     [](Scene& s) {
       s.fracture.model = FractureModel::b;
       s.instruments.push_back(press(-1));
     },
     InputFault::unknown_name,
     {"probe", "crack -1"}},
};

const std::vector<Fault> kFractureFaults = {
    {"CrackElementOutside",
     [](Scene& s) { s.cracks.push_back(crack({24}, Vec3(2, 1, 0), {Vec3(1, 1, 0)})); },
     InputFault::bad_id,
     {"crack 0", "element 24", "0 to 23"}},
    {"CracksOverlap",
     [](Scene& s) {
       s.cracks.push_back(crack({0, 1}, Vec3(2, 1, 0), {Vec3(1, 1, 0)}));
       s.cracks.push_back(crack({1, 2}, Vec3(2, 1, 0), {Vec3(1, 1, 0)}));
     },
     InputFault::bad_id,
     {"crack 1", "element 1", "crack 0"}},
    {"MouthAndTwoTips",
     [](Scene& s) {
       s.cracks.push_back(crack({0}, Vec3(2, 1, 0), {Vec3(1, 1, 0), Vec3(0, 1, 0)}));
     },
     InputFault::missing_key,
     {"crack 0", "one tip"}},
    {"NoMouthOneTip",
     [](Scene& s) { s.cracks.push_back(crack({0}, std::nullopt, {Vec3(1, 1, 0)})); },
     InputFault::missing_key,
     {"crack 0", "two tips"}},
    {"CrackWithoutLength",
     [](Scene& s) { s.cracks.push_back(crack({0}, Vec3(1, 1, 0), {Vec3(1, 1, 0)})); },
     InputFault::out_of_range,
     {"crack 0", "length"}},
    {"TipNan",
     [](Scene& s) { s.cracks.push_back(crack({0}, Vec3(1, 1, 0), {Vec3(kNan, 1, 0)})); },
     InputFault::out_of_range,
     {"crack 0", "tip"}},
    {"CrackUnknownVolume",
     [](Scene& s) {
       s.cracks.push_back({VolumeName{"notch"}, Vec3(2, 1, 0), {Vec3(1, 1, 0)}});
     },
     InputFault::unknown_name,
     {"crack 0", "notch", "lower"}},
    {"RemovalAfterTheEnd",
     [](Scene& s) {
       s.steps = 3;
       s.removals.push_back({3, std::vector<Index>{0}});
     },
     InputFault::out_of_range,
     {"destroy 0", "step 3", "0 to 2"}},
    {"RemovalBeforeTheStart",
     [](Scene& s) {
       s.removals.push_back({-1, std::vector<Index>{0}});
     },
     InputFault::out_of_range,
     {"destroy 0", "step -1"}},
    {"RemovalOfNothing",
     [](Scene& s) {
       s.removals.push_back({0, Box{Vec3(8, 8, 8), Vec3(9, 9, 9)}});
     },
     InputFault::empty_selection,
     {"destroy 0", "no element"}},
    {"RemovalElementOutside",
     [](Scene& s) {
       s.removals.push_back({0, std::vector<Index>{0, -7}});
     },
     InputFault::bad_id,
     {"destroy 0", "element -7"}},
    {"AlphaZero", [](Scene& s) { s.fracture.alpha = 0; }, InputFault::out_of_range, {"alpha = 0"}},
    {"AlphaOne", [](Scene& s) { s.fracture.alpha = 1; }, InputFault::out_of_range, {"alpha = 1"}},
    {"AlphaNan",
     [](Scene& s) { s.fracture.alpha = kNan; },
     InputFault::out_of_range,
     {"alpha = not a number"}},
    {"MaxEventsZero",
     [](Scene& s) { s.fracture.max_events = 0; },
     InputFault::out_of_range,
     {"max_events = 0"}},
    {"NormalZero",
     [](Scene& s) { s.fracture.plane_normal = Vec3::Zero(); },
     InputFault::out_of_range,
     {"plane_normal"}},
    {"ToleranceZero",
     [](Scene& s) { s.solver.tolerance = 0; },
     InputFault::out_of_range,
     {"tolerance = 0"}},
    {"ToleranceNan",
     [](Scene& s) { s.solver.tolerance = kNan; },
     InputFault::out_of_range,
     {"tolerance = not a number"}},
    {"StepsZero", [](Scene& s) { s.steps = 0; }, InputFault::out_of_range, {"steps = 0"}},
};

const auto kName = [](const auto& p) { return p.param.name; };
INSTANTIATE_TEST_SUITE_P(Material, BadScene, ::testing::ValuesIn(kMaterialFaults), kName);
INSTANTIATE_TEST_SUITE_P(Mesh, BadScene, ::testing::ValuesIn(kMeshFaults), kName);
INSTANTIATE_TEST_SUITE_P(Support, BadScene, ::testing::ValuesIn(kSupportFaults), kName);
INSTANTIATE_TEST_SUITE_P(Instrument, BadScene, ::testing::ValuesIn(kInstrumentFaults), kName);
INSTANTIATE_TEST_SUITE_P(Fracture, BadScene, ::testing::ValuesIn(kFractureFaults), kName);

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
std::vector<std::string> said_of(const test::BoardShape& shape,
                                 const std::function<Vec3(const Vec3&)>& bend,
                                 FractureModel model) {
  Scene scene;
  scene.mesh = test::structured_board(shape);
  for (Vec3& x : scene.mesh.nodes) x = bend(x);
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, -1, -9), Vec3(99, 1e-9, 99)}, Axes{7}});
  scene.fracture.model = model;
  return Problem(std::move(scene)).warnings();
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
  const test::BoardShape board{10, 10, 1, 50, 50, 2}, cube{5, 5, 5, 50, 50, 50},
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
    EXPECT_EQ(why_no_board(test::read_msh22(path), {}), std::nullopt) << name;
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

/// The one warning of a scene.
std::string only_warning(const Problem& problem) {
  EXPECT_EQ(problem.warnings().size(), 1U);
  return problem.warnings().empty() ? "" : problem.warnings().front();
}

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << '"' << part << "\" is not in: " << text;
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
  const Mesh mesh = test::structured_board({1, 1, 1, 1, 1, 1});
  const auto faces = free_faces(mesh);
  EXPECT_EQ(faces.size(), 12u);
  for (const FreeFace& f : faces) {
    const Vec3 a = mesh.nodes[f.nodes[0]], b = mesh.nodes[f.nodes[1]], c = mesh.nodes[f.nodes[2]];
    const Vec3 outward = (a + b + c) / 3 - Vec3::Constant(0.5);
    EXPECT_GT((b - a).cross(c - a).dot(outward), 0);
  }
}

}  // namespace
}  // namespace sunder
