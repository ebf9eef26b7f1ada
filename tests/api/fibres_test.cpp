// SPDX-License-Identifier: Apache-2.0
// Fibres through the C interface: the body that the same scene in C++ is, and refusals.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "api/c_scene.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

constexpr double kForce = -0.5;  // N

/// board_scene() by a law, without fracture.
Scene in_cpp(MaterialLaw law) {
  Scene scene;
  scene.mesh = structured_board({4, 4, 1, 10, 10, 1});
  scene.materials["board"] = {5, 0.4, {}};
  scene.materials["board"].law = law;
  scene.supports.push_back({Box{{-1, 9.99, -1}, {11, 10.01, 2}}, Axes{7}});
  Instrument pull{"pull", Pull{Box{{9.99, -0.01, -1}, {10.01, 0.01, 2}}, Vec3(0, kForce, 0)}, {}};
  scene.instruments = {pull};
  scene.steps = 1;
  return scene;
}

std::vector<double> moved_in_cpp(const Scene& scene) {
  const auto problem = std::make_shared<const Problem>(scene);
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  simulation.step();
  std::vector<double> u;
  for (const Vec3& x : simulation.displacement()) u.insert(u.end(), x.data(), x.data() + 3);
  return u;
}

class CFibres : public testing::Test {
 protected:
  /// A scene with one material, which fibres are added to.
  void begin(std::int32_t law) {
    EXPECT_OK(sunder_scene_create(&scene));
    const Arrays a = board_arrays();
    EXPECT_OK(sunder_scene_set_mesh(scene, a.nodes.data(), a.nodes.size(), a.tets.data(),
                                    a.tets.size(), nullptr, 0));
    sunder_material tissue = SUNDER_MATERIAL_INIT;
    tissue.young = 5;
    tissue.poisson = 0.4;
    tissue.law = law;
    tissue.toughness = toughness;
    EXPECT_OK(sunder_scene_add_material(scene, &tissue, nullptr));
    const sunder_support support = top_support();
    EXPECT_OK(sunder_scene_add_support(scene, &support));
    const sunder_instrument pull = corner_pull(kForce);
    EXPECT_OK(sunder_scene_add_instrument(scene, &pull, nullptr));
    const auto solver = on(SUNDER_BACKEND_CPU);
    EXPECT_OK(sunder_scene_set_solver(scene, &solver));
    EXPECT_OK(sunder_scene_set_steps(scene, 1));
  }
  ~CFibres() override {
    if (scene) sunder_scene_destroy(scene);
  }
  std::vector<double> moved() const {
    sunder_simulation simulation = nullptr;
    EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
    if (!simulation) return {};
    EXPECT_OK(sunder_simulation_step(simulation, nullptr));
    std::vector<double> u(150);
    EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
    EXPECT_OK(sunder_simulation_destroy(simulation));
    return u;
  }
  void refused(const std::string& says) const {
    sunder_simulation simulation = nullptr;
    EXPECT_EQ(sunder_simulation_create(scene, nullptr, &simulation), SUNDER_ERROR_INPUT);
    EXPECT_NE(std::string(sunder_last_error()).find(says), std::string::npos)
        << sunder_last_error();
  }

  sunder_scene scene = nullptr;
  double toughness = 0;
};

sunder_fibres straight() {
  sunder_fibres f = SUNDER_FIBRES_INIT;
  f.direction[0] = 1;
  f.direction[1] = 2;
  return f;
}

/// A vector for each element; they are the caller's.
sunder_fibres along(const std::vector<double>& vectors) {
  sunder_fibres f = SUNDER_FIBRES_INIT;
  f.run = SUNDER_FIBRES_FIELD;
  f.field = vectors.data();
  f.field_size = vectors.size();
  return f;
}

TEST_F(CFibres, OfLawLinearAreThoseOfCpp) {
  begin(SUNDER_LAW_LINEAR);
  sunder_fibres f = straight();
  f.young_along = 15;
  f.poisson_along = 0.3;
  f.shear_along = 4;
  EXPECT_OK(sunder_scene_add_fibres(scene, 0, &f));
  Scene same = in_cpp(MaterialLaw::linear);
  Fibres family;
  family.direction = Vec3(1, 2, 0);
  family.young_along = 15;
  family.poisson_along = 0.3;
  family.shear_along = 4;
  same.materials["board"].fibres = {family};
  EXPECT_EQ(moved(), moved_in_cpp(same));
}

TEST_F(CFibres, TwoFamiliesRoundAnAxisAndAlongAFieldAreThoseOfCpp) {
  begin(SUNDER_LAW_NEO_HOOKEAN);
  sunder_fibres round = SUNDER_FIBRES_INIT;
  round.run = SUNDER_FIBRES_AROUND;
  round.direction[2] = 1;
  round.point[0] = -3;
  round.k1 = 2;  // with k2 = 0
  round.dispersion = 0.1;
  EXPECT_OK(sunder_scene_add_fibres(scene, 0, &round));
  std::vector<double> vectors;
  std::vector<Vec3> field;
  for (std::size_t e = 0; e < 96; ++e) {
    field.emplace_back(1, 0.01 * static_cast<double>(e), 0.5);
    vectors.insert(vectors.end(), field.back().data(), field.back().data() + 3);
  }
  sunder_fibres helix = along(vectors);
  helix.k1 = 1;
  helix.k2 = 3;
  EXPECT_OK(sunder_scene_add_fibres(scene, 0, &helix));
  vectors.assign(vectors.size(), NAN);  // copied before the call returned
  Scene same = in_cpp(MaterialLaw::neo_hookean);
  Fibres first;
  first.direction = AroundAxis{Vec3(-3, 0, 0), Vec3(0, 0, 1)};
  first.k1 = 2;
  first.k2 = 0;
  first.dispersion = 0.1;
  Fibres second;
  second.direction = FieldName{"helix"};
  second.k1 = 1;
  second.k2 = 3;
  same.mesh.fields["helix"] = field;
  same.materials["board"].fibres = {first, second};
  EXPECT_EQ(moved(), moved_in_cpp(same));
}

TEST_F(CFibres, ThatGuideCracksAreRead) {
  toughness = 1;
  begin(SUNDER_LAW_LINEAR);
  auto fracture = model(SUNDER_FRACTURE_B);
  fracture.sif = SUNDER_SIF_FIELD;
  EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
  sunder_fibres f = straight();
  f.toughness_across = -2;
  EXPECT_OK(sunder_scene_add_fibres(scene, 0, &f));
  refused("toughness_across = -2; it must be finite and above 0 MPa sqrt(mm)");
}

TEST_F(CFibres, OfAFieldForAnotherMeshAreRefused) {
  begin(SUNDER_LAW_LINEAR);
  const std::vector<double> vectors(9, 1.0);
  sunder_fibres f = along(vectors);
  f.young_along = 15;
  f.shear_along = 4;
  EXPECT_OK(sunder_scene_add_fibres(scene, 0, &f));
  refused("which has 3 vectors for 96 elements");
}

TEST_F(CFibres, WhatCannotBeIsRefusedAtOnce) {
  begin(SUNDER_LAW_LINEAR);
  const auto add = [&](const std::function<void(sunder_fibres&)>& change, std::int32_t of = 0) {
    sunder_fibres f = straight();
    change(f);
    return sunder_scene_add_fibres(scene, of, &f);
  };
  EXPECT_EQ(add([](auto&) {}, 1), SUNDER_ERROR_VALUE);
  EXPECT_NE(std::string(sunder_last_error()).find("material 1 does not exist"), std::string::npos);
  EXPECT_EQ(add([](auto& f) { f.run = 3; }), SUNDER_ERROR_VALUE);
  EXPECT_EQ(add([](auto& f) { f.direction[1] = NAN; }), SUNDER_ERROR_VALUE);
  EXPECT_EQ(add([](auto& f) { f.k1 = INFINITY; }), SUNDER_ERROR_VALUE);
  EXPECT_EQ(add([](auto& f) { f.run = SUNDER_FIBRES_FIELD; }), SUNDER_ERROR_NULL);
  const std::vector<double> vectors(8, 1.0);
  EXPECT_EQ(add([&](auto& f) { f = along(vectors); }), SUNDER_ERROR_SIZE);
  EXPECT_NE(std::string(sunder_last_error()).find("3 numbers for each element"), std::string::npos);
  // Nothing of it has come into the scene.
  EXPECT_EQ(moved(), moved_in_cpp(in_cpp(MaterialLaw::linear)));
}

}  // namespace
}  // namespace sunder::test
