// SPDX-License-Identifier: Apache-2.0
// The misuse table: wrong calls with their status and what their sentence says.
#pragma once

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "api/c_scene.hpp"

namespace sunder::test {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What a wrong call may use: one good object of each kind, and bad handles.
struct World {
  sunder_scene scene = board_scene();
  sunder_scene empty = nullptr;
  sunder_scene gone = nullptr;
  sunder_simulation simulation = board_simulation();  // before its first step
  sunder_plan plan = nullptr;
  Arrays arrays = board_arrays();
  sunder_simulation made = nullptr;
  double values[8] = {};

  World() {
    EXPECT_OK(sunder_plan_create(scene, &plan));
    EXPECT_OK(sunder_scene_create(&empty));
    EXPECT_OK(sunder_scene_create(&gone));
    EXPECT_OK(sunder_scene_destroy(gone));
  }
  ~World() {
    EXPECT_OK(sunder_plan_destroy(plan));
    EXPECT_OK(sunder_scene_destroy(scene));
    EXPECT_OK(sunder_scene_destroy(empty));
    EXPECT_OK(sunder_simulation_destroy(simulation));
    EXPECT_EQ(made, nullptr) << "a wrong call made a handle";
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  sunder_status create(sunder_scene from) { return sunder_simulation_create(from, nullptr, &made); }
  /// Creates after a change to the good scene that is wrong.
  template <class Change>
  sunder_status create_with(Change change) {
    EXPECT_OK(change());
    return create(scene);
  }
  sunder_status set_mesh(const Arrays& a) {
    return sunder_scene_set_mesh(scene, a.nodes.data(), a.nodes.size(), a.tets.data(),
                                 a.tets.size(), nullptr, 0);
  }
  sunder_status add_material(double young, double poisson, double yield) {
    sunder_material m;
    sunder_material_init(&m);
    m.young = young;
    m.poisson = poisson;
    m.yield = yield;
    return sunder_scene_add_material(scene, &m, nullptr);
  }
  template <class Change>
  sunder_status add_instrument(Change change) {
    sunder_instrument i = corner_pull();
    change(i);
    return sunder_scene_add_instrument(scene, &i, nullptr);
  }
  template <class Change>
  sunder_status add_support(Change change) {
    sunder_support s = top_support();
    change(s);
    return sunder_scene_add_support(scene, &s);
  }
  template <class Change>
  sunder_status add_crack(Change change) {
    sunder_preset_crack c = SUNDER_PRESET_CRACK_INIT;
    c.elements = box(4, 4, 5, 5);
    change(c);
    return sunder_scene_add_crack(scene, &c);
  }
  template <class Change>
  sunder_status set_fracture(Change change) {
    sunder_fracture_options f = model(SUNDER_FRACTURE_B);
    change(f);
    return sunder_scene_set_fracture(scene, &f);
  }
  template <class Change>
  sunder_status set_solver(Change change) {
    sunder_solver_options s = on(SUNDER_BACKEND_CPU);
    change(s);
    return sunder_scene_set_solver(scene, &s);
  }
};

template <class Handle>
Handle forged(std::uintptr_t value) {
  return reinterpret_cast<Handle>(value);
}

struct Misuse {
  const char* name;
  sunder_status status;
  const char* says;  // part of the sentence
  std::function<sunder_status(World&)> call;
};

inline void PrintTo(const Misuse& m, std::ostream* out) { *out << m.name; }

// By what is wrong: the call itself ...
std::vector<Misuse> handles();
std::vector<Misuse> null_pointers();
std::vector<Misuse> sizes();
std::vector<Misuse> struct_sizes();
// ... or what it says.
std::vector<Misuse> values();
std::vector<Misuse> scenes();
std::vector<Misuse> order();
std::vector<Misuse> not_finite();
// ... to a live body.
std::vector<Misuse> live_pointers();
std::vector<Misuse> live_counts();
std::vector<Misuse> live_values();

}  // namespace sunder::test
