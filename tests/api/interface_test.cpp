// SPDX-License-Identifier: Apache-2.0
// Interfaces through the C interface: the body that they make of a host's mesh, how it parts by
// hand values, back and forth, refusals.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include "api/c_interface.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

/// The edges of its elements lean by their thickness over a face's edge, 0.5 %: area goes by the
/// square of that.
constexpr double kFlat = 5e-5;

sunder_interface interface_of(sunder_simulation simulation, std::int32_t index = 0) {
  sunder_interface state = SUNDER_INTERFACE_INIT;
  EXPECT_OK(sunder_simulation_interface_at(simulation, index, &state));
  return state;
}

std::int32_t interfaces_in(sunder_simulation simulation) {
  std::int32_t count = -1;
  EXPECT_OK(sunder_simulation_interface_count(simulation, &count));
  return count;
}

std::vector<sunder_event> rows_of(sunder_simulation simulation) {
  std::int32_t count = 0;
  EXPECT_OK(sunder_simulation_event_count(simulation, &count));
  std::vector<sunder_event> rows(static_cast<std::size_t>(count), SUNDER_EVENT_INIT);
  for (std::int32_t i = 0; i < count; ++i) {
    EXPECT_OK(sunder_simulation_event_at(simulation, i, &rows[static_cast<std::size_t>(i)]));
  }
  return rows;
}

template <class T, class Function>
std::vector<T> filled(sunder_simulation simulation, std::size_t size, Function function) {
  std::vector<T> values(size, T{7});
  EXPECT_OK(function(simulation, values.data(), values.size()));
  return values;
}

std::vector<double> moved(sunder_simulation simulation) {
  return filled<double>(simulation, 3 * kBodyNodes, sunder_simulation_displacement);
}

double pull_of(sunder_simulation simulation) {
  return filled<double>(simulation, 3, sunder_simulation_reactions)[0];
}

std::ptrdiff_t destroyed_in(sunder_simulation simulation) {
  const auto all = filled<std::uint8_t>(simulation, kBodyTets, sunder_simulation_destroyed);
  return std::ranges::count(all, 1);
}

class CInterface : public testing::Test {
 protected:
  ~CInterface() override { EXPECT_OK(sunder_simulation_destroy(simulation)); }
  void steps(int count) {
    for (int i = 0; i < count; ++i) ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  }
  sunder_simulation simulation = joined_cubes();
};

TEST_F(CInterface, MakesABodyWithNodesAndElementsBehindTheMeshs) {
  sunder_engine engine = SUNDER_ENGINE_INIT;
  EXPECT_OK(sunder_simulation_engine(simulation, &engine));
  EXPECT_EQ(engine.nodes, static_cast<std::int64_t>(kBodyNodes));
  EXPECT_EQ(engine.tets, static_cast<std::int64_t>(kBodyTets));
  sunder_body body = SUNDER_BODY_INIT;
  EXPECT_OK(sunder_simulation_body(simulation, &body));
  EXPECT_EQ(body.node_count, static_cast<std::int32_t>(kBodyNodes));
  EXPECT_EQ(body.tet_count, static_cast<std::int32_t>(kBodyTets));
  EXPECT_EQ(body.version, 0);

  const Mesh host = two_cubes();
  const auto x = filled<double>(simulation, 3 * kBodyNodes, sunder_simulation_body_nodes);
  const auto parents = filled<std::int32_t>(simulation, kBodyNodes, sunder_simulation_body_parents);
  const double thickness = interface_of(simulation).thickness;
  for (std::size_t n = 0; n < kBodyNodes; ++n) {
    const Vec3 there(&x[3 * n]);
    const auto parent = static_cast<std::size_t>(parents[n]);
    EXPECT_EQ(n < kHostNodes, parent == n) << n;
    ASSERT_LT(parent, kHostNodes);
    EXPECT_NEAR((there - host.nodes[parent]).norm(), n < kHostNodes ? 0 : thickness,
                kFlat * thickness)
        << n;
    EXPECT_TRUE(n < kHostNodes || host.nodes[parent][0] == 1.0) << n;
  }
  const auto corners =
      filled<std::int32_t>(simulation, 4 * kBodyTets, sunder_simulation_body_corners);
  for (std::size_t i = 0; i < 4 * kHostTets; ++i) {
    EXPECT_EQ(parents[static_cast<std::size_t>(corners[i])], host.tets[i / 4][i % 4]) << i;
  }
}

// Whoever has the mesh's sizes is told the body's.
TEST_F(CInterface, TakesArraysOfTheBodysSizeAlone) {
  steps(1);
  std::vector<double> values(6 * kBodyTets);
  const auto refused = [&](sunder_status status, std::size_t size) {
    EXPECT_EQ(status, SUNDER_ERROR_SIZE);
    const std::string says = "must have " + std::to_string(size);
    EXPECT_NE(std::string(sunder_last_error()).find(says), std::string::npos)
        << sunder_last_error();
  };
  const auto nodes = static_cast<size_t>(3 * kHostNodes);
  refused(sunder_simulation_displacement(simulation, values.data(), nodes), 3 * kBodyNodes);
  refused(sunder_simulation_body_displacement(simulation, values.data(), nodes), 3 * kBodyNodes);
  refused(sunder_simulation_body_nodes(simulation, values.data(), nodes), 3 * kBodyNodes);
  refused(sunder_simulation_stress(simulation, values.data(), 6 * kHostTets), 6 * kBodyTets);
  refused(sunder_simulation_max_shear(simulation, values.data(), kHostTets), kBodyTets);
  refused(sunder_simulation_yield_ratio(simulation, values.data(), kHostTets), kBodyTets);
  const double* lent = nullptr;
  size_t size = 0;
  EXPECT_OK(sunder_simulation_lend(simulation, SUNDER_FIELD_DISPLACEMENT, &lent, &size));
  EXPECT_EQ(size, 3 * kBodyNodes);
  sunder_frames frames = nullptr;
  ASSERT_OK(sunder_frames_create(simulation, SUNDER_FRAME_DISPLACEMENT, nullptr, 0, &frames));
  sunder_frame frame = SUNDER_FRAME_INIT;
  EXPECT_OK(sunder_frames_take(frames, &frame));
  EXPECT_EQ(frame.node_count, static_cast<std::int32_t>(kBodyNodes));
  EXPECT_OK(sunder_frames_displacement(frames, values.data(), 3 * kBodyNodes));
  EXPECT_OK(sunder_frames_destroy(frames));
  sunder_surface surface = SUNDER_SURFACE_INIT;
  EXPECT_OK(sunder_simulation_surface(simulation, &surface));
  EXPECT_EQ(surface.node_count, static_cast<std::int32_t>(kBodyNodes));
}

// Of cohesive springs: k = strength^2 / (2 energy), parted at 2 energy / strength.
TEST_F(CInterface, SaysWhatItIs) {
  ASSERT_EQ(interfaces_in(simulation), 1);
  const sunder_interface state = interface_of(simulation);
  EXPECT_EQ(state.materials[0], 0);
  EXPECT_EQ(state.materials[1], 1);
  EXPECT_EQ(state.first_element, static_cast<std::int32_t>(kHostTets));
  EXPECT_EQ(state.element_count, static_cast<std::int32_t>(kBodyTets - kHostTets));
  EXPECT_EQ(state.strength, kStrength);
  EXPECT_EQ(state.energy, kEnergy);
  EXPECT_EQ(state.shear_ratio, 1);
  EXPECT_NEAR(state.area, 1, kFlat);
  EXPECT_GT(state.thickness, 0);
  EXPECT_LE(state.thickness, 0.02) << "thin against its faces";
  // Thin, but not of no thickness: a few hundredths off the straight line.
  EXPECT_NEAR(state.stiffness, 0.4, 0.04);
  EXPECT_NEAR(state.opening, 0.5, 0.05);
  EXPECT_EQ(state.parted, 0);
  EXPECT_EQ(state.spent, 0);
}

TEST_F(CInterface, PartsByItsLawAndTellsTheEnergy) {
  steps(2);  // 0.4 mm: of 0.58, for the cubes stretch by strength / 2.5 MPa/mm beside the opening
  EXPECT_EQ(interface_of(simulation).parted, 0);
  EXPECT_TRUE(rows_of(simulation).empty());
  EXPECT_NEAR(pull_of(simulation), 0.4 / (1 / 0.4 + 1 / 2.5), 0.01);
  steps(2);  // 0.8 mm
  const auto rows = rows_of(simulation);
  ASSERT_EQ(rows.size(), kBodyTets - kHostTets);
  double sum = 0;
  for (const sunder_event& row : rows) {
    EXPECT_EQ(row.cause, SUNDER_CAUSE_INTERFACE);
    EXPECT_EQ(row.lives, 0);
    EXPECT_EQ(row.crack, -1);
    EXPECT_EQ(row.has_sif, 0);
    EXPECT_GE(row.element, static_cast<std::int32_t>(kHostTets));
    EXPECT_GE(row.ratio, 1);
    EXPECT_GT(row.energy, 0);
    sum += row.energy;
  }
  const sunder_interface state = interface_of(simulation);
  EXPECT_NEAR(state.parted, state.area, 1e-12);
  EXPECT_NEAR(state.spent, kEnergy, 0.02 * kEnergy) << "of 1 mm^2";
  EXPECT_NEAR(state.spent, sum, 1e-15);
  EXPECT_NEAR(pull_of(simulation), 0, 1e-4) << "nothing holds the cube any more";
}

TEST_F(CInterface, ComesTogetherAgainByUndo) {
  ASSERT_OK(sunder_simulation_keep_history(simulation, 8));
  steps(2);
  const auto before = moved(simulation);
  steps(2);
  const auto after = moved(simulation);
  const auto torn = interface_of(simulation);
  std::int32_t events = 0;
  ASSERT_OK(sunder_simulation_undo(simulation, 1, &events, nullptr));
  EXPECT_GT(events, 0);
  EXPECT_EQ(moved(simulation), before) << "bit by bit";
  EXPECT_EQ(interface_of(simulation).parted, 0);
  EXPECT_EQ(interface_of(simulation).spent, 0);
  EXPECT_EQ(destroyed_in(simulation), 0);
  ASSERT_OK(sunder_simulation_redo(simulation, 1, &events));
  EXPECT_EQ(moved(simulation), after);
  EXPECT_EQ(interface_of(simulation).spent, torn.spent);
  EXPECT_EQ(destroyed_in(simulation), torn.element_count);
}

// What a host takes out has parted, and not by the law.
TEST_F(CInterface, IsCutByRemovingItsElements) {
  steps(1);
  const sunder_interface whole = interface_of(simulation);
  std::vector<std::int32_t> elements(static_cast<std::size_t>(whole.element_count));
  std::iota(elements.begin(), elements.end(), whole.first_element);
  ASSERT_OK(sunder_simulation_remove(simulation, elements.data(), elements.size()));
  const sunder_interface cut = interface_of(simulation);
  EXPECT_NEAR(cut.parted, cut.area, 1e-12);
  EXPECT_EQ(cut.spent, 0);
  EXPECT_EQ(rows_of(simulation)[0].cause, SUNDER_CAUSE_SCRIPT);
  EXPECT_EQ(rows_of(simulation)[0].energy, 0);
}

TEST_F(CInterface, IsThatOfCpp) {
  Scene scene;
  scene.mesh = two_cubes();
  for (const char* name : {"left", "right"}) {
    scene.materials[name] = {5, 0, {}};
    scene.materials[name].law = MaterialLaw::neo_hookean;
  }
  scene.interfaces = {{{"left", "right"}, kStrength, kEnergy, 1}};
  scene.supports.push_back({Box{{-0.1, -1, -1}, {0.1, 2, 2}}, Axes{7}});
  Instrument grip{"grip", Grip{Box{{1.9, -1, -1}, {2.1, 2, 2}}, Vec3(kPull, 0, 0), Axes{7}}, {}};
  grip.ramp = Ramp{0, 1};
  scene.instruments = {grip};
  scene.fracture.model = FractureModel::a;
  scene.steps = 4;
  const auto problem = std::make_shared<const Problem>(scene);
  Simulation same(problem, cpu_reference::create(problem, needs_of(*problem)));
  for (int i = 0; i < 4; ++i) same.step();
  steps(4);
  std::vector<double> u;
  for (const Vec3& x : same.displacement()) u.insert(u.end(), x.data(), x.data() + 3);
  EXPECT_EQ(moved(simulation), u);
}

TEST_F(CInterface, KnowsTheRecordingOfAnother) {
  ASSERT_OK(sunder_simulation_keep_history(simulation, 8));
  steps(1);
  size_t length = 0;
  ASSERT_OK(sunder_simulation_store(simulation, nullptr, 0, &length));
  std::vector<char> bytes(length);
  ASSERT_OK(sunder_simulation_store(simulation, bytes.data(), length, &length));
  const auto load = [&](double shear_ratio) {
    const sunder_simulation other = joined_cubes(shear_ratio);
    EXPECT_OK(sunder_simulation_keep_history(other, 8));
    const sunder_status status = sunder_simulation_load(other, bytes.data(), bytes.size());
    EXPECT_OK(sunder_simulation_destroy(other));
    return status;
  };
  EXPECT_EQ(load(1), SUNDER_OK);
  EXPECT_EQ(load(2), SUNDER_ERROR_INPUT);
}

/// A scene without an interface yet.
class CInterfaceInput : public testing::Test {
 protected:
  ~CInterfaceInput() override { EXPECT_OK(sunder_scene_destroy(scene)); }
  sunder_status add(std::int32_t first, std::int32_t second, double strength = kStrength,
                    double energy = kEnergy, double shear_ratio = 1) {
    return sunder_scene_add_interface(scene, first, second, strength, energy, shear_ratio);
  }
  void refused(const std::string& says) const {
    sunder_simulation simulation = nullptr;
    EXPECT_EQ(sunder_simulation_create(scene, nullptr, &simulation), SUNDER_ERROR_INPUT);
    EXPECT_NE(std::string(sunder_last_error()).find(says), std::string::npos)
        << sunder_last_error();
    EXPECT_EQ(simulation, nullptr);
  }
  sunder_scene scene = cubes_scene();
};

// The right cube is pulled by its face y = 0, whose nodes at x = 1 mm lie twice: ids are of the
// left cube, and faces say whose they are.
TEST_F(CInterfaceInput, IsPulledOnOneSideByFaces) {
  const std::int32_t face[] = {1, 2, 8, 1, 8, 7};  // (1,0,0), (2,0,0), (2,0,1), (1,0,1)
  sunder_selection nodes = SUNDER_SELECTION_INIT;
  nodes.kind = SUNDER_SELECT_FACES;
  nodes.ids = face;
  nodes.id_count = 6;
  const sunder_instrument grip = pulled(nodes, 0, 0.05);
  ASSERT_OK(sunder_scene_add_instrument(scene, &grip, nullptr));
  ASSERT_OK(add(0, 1));
  ASSERT_OK(sunder_scene_set_steps(scene, 1));
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  const auto u = moved(simulation);
  const auto parents = filled<std::int32_t>(simulation, kBodyNodes, sunder_simulation_body_parents);
  int pulled = 0;
  for (std::size_t n = 0; n < kBodyNodes; ++n) {
    const bool of_face = n == 2 || n == 8 || (n >= kHostNodes && parents[n] % 6 == 1);
    EXPECT_EQ(std::abs(u[3 * n + 1] - 0.05) < 1e-12 && std::abs(u[3 * n]) < 1e-12, of_face) << n;
    pulled += of_face ? 1 : 0;
  }
  EXPECT_EQ(pulled, 4);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

TEST_F(CInterfaceInput, IsRefusedAtOnceWhereItCannotBe) {
  EXPECT_EQ(add(0, 2), SUNDER_ERROR_VALUE);
  EXPECT_NE(std::string(sunder_last_error()).find("material 2 does not exist"), std::string::npos);
  EXPECT_EQ(add(-1, 0), SUNDER_ERROR_VALUE);
  EXPECT_EQ(add(0, 1, NAN), SUNDER_ERROR_VALUE);
  EXPECT_EQ(add(0, 1, kStrength, INFINITY), SUNDER_ERROR_VALUE);
  EXPECT_EQ(add(0, 1, kStrength, kEnergy, -INFINITY), SUNDER_ERROR_VALUE);
  EXPECT_STREQ(sunder_last_error(), "shear_ratio = -inf is not a finite number");
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_EQ(interfaces_in(simulation), 0) << "nothing of it has come into the scene";
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

// A host knows the sizes of its arrays before it runs.
TEST_F(CInterfaceInput, IsInThePlan) {
  ASSERT_OK(add(0, 1));
  sunder_plan plan = nullptr;
  ASSERT_OK(sunder_plan_create(scene, &plan));
  sunder_engine engine = SUNDER_ENGINE_INIT;
  EXPECT_OK(sunder_plan_engine(plan, &engine));
  EXPECT_EQ(engine.nodes, static_cast<std::int64_t>(kBodyNodes));
  EXPECT_EQ(engine.tets, static_cast<std::int64_t>(kBodyTets));
  EXPECT_OK(sunder_plan_destroy(plan));
}

TEST_F(CInterfaceInput, IsCheckedWhenASimulationIsMade) {
  ASSERT_OK(add(0, 1, 0));
  refused("between \"left\" and \"right\") has strength = 0; it must be finite and above 0 MPa");
}

TEST_F(CInterfaceInput, NeedsTwoMaterials) {
  ASSERT_OK(add(1, 1));
  refused("has the same volume on both sides");
}

TEST_F(CInterfaceInput, NeedsFacesInCommon) {
  const sunder_material other = SUNDER_MATERIAL_INIT;
  std::int32_t nowhere = 0;
  ASSERT_OK(sunder_scene_add_material(scene, &other, &nowhere));
  ASSERT_OK(add(0, nowhere));
  refused("the two volumes share no face");
}

TEST_F(CInterfaceInput, LiesThereOnce) {
  ASSERT_OK(add(0, 1));
  ASSERT_OK(add(1, 0));
  refused("lies where interface 0 does");
}

TEST_F(CInterfaceInput, HasANameOfItsOwn) {
  sunder_material other = SUNDER_MATERIAL_INIT;
  other.name = "interface-0";
  ASSERT_OK(sunder_scene_add_material(scene, &other, nullptr));
  ASSERT_OK(add(0, 1));
  refused("material \"interface-0\" has the name of what interface 0 is made of");
}

TEST_F(CInterfaceInput, DoesNotGoWithModelB) {
  const auto fracture = model(SUNDER_FRACTURE_B);
  ASSERT_OK(sunder_scene_set_fracture(scene, &fracture));
  ASSERT_OK(add(0, 1));
  refused("does not go with model \"B\"");
}

// The host has vectors for its own elements; the interface's are none of its business.
TEST_F(CInterfaceInput, LeavesFibresOfAFieldToTheHostsElements) {
  const auto create = [&](std::size_t elements) {
    const sunder_scene with = cubes_scene();
    const std::vector<double> vectors(3 * elements, 1.0);
    sunder_fibres fibres = SUNDER_FIBRES_INIT;
    fibres.run = SUNDER_FIBRES_FIELD;
    fibres.field = vectors.data();
    fibres.field_size = vectors.size();
    fibres.k1 = 1;
    EXPECT_OK(sunder_scene_add_fibres(with, 0, &fibres));
    EXPECT_OK(sunder_scene_add_interface(with, 0, 1, kStrength, kEnergy, 1));
    sunder_simulation simulation = nullptr;
    const sunder_status status = sunder_simulation_create(with, nullptr, &simulation);
    EXPECT_EQ(simulation != nullptr, status == SUNDER_OK);
    if (status == SUNDER_OK) sunder_simulation_destroy(simulation);
    EXPECT_OK(sunder_scene_destroy(with));
    return status;
  };
  EXPECT_EQ(create(kHostTets), SUNDER_OK) << sunder_last_error();
  EXPECT_EQ(create(kHostTets - 2), SUNDER_ERROR_INPUT);
  EXPECT_NE(std::string(sunder_last_error()).find("has 10 vectors"), std::string::npos)
      << sunder_last_error();
}

}  // namespace
}  // namespace sunder::test
