// SPDX-License-Identifier: Apache-2.0
// Bad scenes: each fault is refused with its kind, and with a message that names the place and
// the value.
#include "sunder/problem.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "core/body/small_scene.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

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
    {"ToughnessZero",
     [](Scene& s) { s.materials["lower"].toughness = 0; },
     InputFault::out_of_range,
     {"lower", "toughness = 0", "above 0 MPa sqrt(mm)"}},
    {"ToughnessNan",
     [](Scene& s) { s.materials["upper"].toughness = kNan; },
     InputFault::out_of_range,
     {"upper", "toughness = ", "finite"}},
    {"EnergyNegative",
     [](Scene& s) { s.materials["lower"].energy = -0.1; },
     InputFault::out_of_range,
     {"lower", "energy = -0.1", "above 0 N/mm"}},
    {"ToughnessAndEnergy",
     [](Scene& s) { s.materials["lower"].toughness = s.materials["lower"].energy = 1; },
     InputFault::out_of_range,
     {"lower", "toughness and energy", "one of them"}},
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

}  // namespace
}  // namespace sunder::test
