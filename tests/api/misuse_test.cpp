// SPDX-License-Identifier: Apache-2.0
// The misuse table: every wrong call gives its status and a sentence, none ends the process. Run
// under the address and undefined behaviour sanitizers.
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

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

void PrintTo(const Misuse& m, std::ostream* out) { *out << m.name; }

std::vector<Misuse> handles() {
  return {
      {"scene_null", SUNDER_ERROR_HANDLE, "scene", [](World&) { return sunder_scene_destroy({}); }},
      {"scene_forged", SUNDER_ERROR_HANDLE, "scene",
       [](World&) { return sunder_scene_destroy(forged<sunder_scene>(0xdeadbeef)); }},
      {"scene_all_ones", SUNDER_ERROR_HANDLE, "scene",
       [](World&) { return sunder_scene_set_steps(forged<sunder_scene>(UINTPTR_MAX), 1); }},
      {"scene_destroyed_twice", SUNDER_ERROR_HANDLE, "destroyed",
       [](World& w) { return sunder_scene_destroy(w.gone); }},
      {"scene_used_after_destroy", SUNDER_ERROR_HANDLE, "destroyed",
       [](World& w) { return w.create(w.gone); }},
      {"simulation_for_scene", SUNDER_ERROR_HANDLE, "scene",
       [](World& w) { return sunder_scene_destroy(reinterpret_cast<sunder_scene>(w.simulation)); }},
      {"scene_for_simulation", SUNDER_ERROR_HANDLE, "simulation",
       [](World& w) {
         return sunder_simulation_step(reinterpret_cast<sunder_simulation>(w.scene), nullptr);
       }},
      {"scene_for_plan", SUNDER_ERROR_HANDLE, "plan",
       [](World& w) { return sunder_plan_destroy(reinterpret_cast<sunder_plan>(w.scene)); }},
      {"step_null", SUNDER_ERROR_HANDLE, "simulation",
       [](World&) { return sunder_simulation_step(nullptr, nullptr); }},
      {"cancel_null", SUNDER_ERROR_HANDLE, "simulation",
       [](World&) { return sunder_simulation_cancel(nullptr); }},
      {"error_of_null", SUNDER_ERROR_HANDLE, "handle",
       [](World&) { return sunder_error_of(nullptr, nullptr, 0, nullptr); }},
      {"grips_null", SUNDER_ERROR_HANDLE, "grips",
       [](World& w) { return sunder_grips_forces(nullptr, w.values, w.values, 3); }},
      {"simulation_for_grips", SUNDER_ERROR_HANDLE, "grips",
       [](World& w) { return sunder_grips_destroy(reinterpret_cast<sunder_grips>(w.simulation)); }},
      {"pointer_to_something_else", SUNDER_ERROR_HANDLE, "simulation",
       [](World& w) { return sunder_simulation_destroy(reinterpret_cast<sunder_simulation>(&w)); }},
  };
}

std::vector<Misuse> null_pointers() {
  return {
      {"scene_create_null", SUNDER_ERROR_NULL, "scene",
       [](World&) { return sunder_scene_create(nullptr); }},
      {"mesh_nodes_null", SUNDER_ERROR_NULL, "nodes",
       [](World& w) {
         return sunder_scene_set_mesh(w.scene, nullptr, 12, w.arrays.tets.data(), 4, nullptr, 0);
       }},
      {"mesh_tets_null", SUNDER_ERROR_NULL, "tets",
       [](World& w) {
         return sunder_scene_set_mesh(w.scene, w.arrays.nodes.data(), 12, nullptr, 4, nullptr, 0);
       }},
      {"material_null", SUNDER_ERROR_NULL, "material",
       [](World& w) { return sunder_scene_add_material(w.scene, nullptr, nullptr); }},
      {"support_null", SUNDER_ERROR_NULL, "support",
       [](World& w) { return sunder_scene_add_support(w.scene, nullptr); }},
      {"instrument_null", SUNDER_ERROR_NULL, "instrument",
       [](World& w) { return sunder_scene_add_instrument(w.scene, nullptr, nullptr); }},
      {"crack_null", SUNDER_ERROR_NULL, "crack",
       [](World& w) { return sunder_scene_add_crack(w.scene, nullptr); }},
      {"removal_null", SUNDER_ERROR_NULL, "elements",
       [](World& w) { return sunder_scene_add_removal(w.scene, 0, nullptr); }},
      {"fracture_null", SUNDER_ERROR_NULL, "fracture",
       [](World& w) { return sunder_scene_set_fracture(w.scene, nullptr); }},
      {"solver_null", SUNDER_ERROR_NULL, "solver",
       [](World& w) { return sunder_scene_set_solver(w.scene, nullptr); }},
      {"ids_null", SUNDER_ERROR_NULL, "ids",
       [](World& w) {
         return w.add_support([](sunder_support& s) {
           s.nodes.kind = SUNDER_SELECT_IDS;
           s.nodes.ids = nullptr;
           s.nodes.id_count = 3;
         });
       }},
      {"simulation_create_null", SUNDER_ERROR_NULL, "simulation",
       [](World& w) { return sunder_simulation_create(w.scene, nullptr, nullptr); }},
      {"plan_create_null", SUNDER_ERROR_NULL, "plan",
       [](World& w) { return sunder_plan_create(w.scene, nullptr); }},
      {"plan_engine_null", SUNDER_ERROR_NULL, "engine",
       [](World& w) { return sunder_plan_engine(w.plan, nullptr); }},
      {"engine_null", SUNDER_ERROR_NULL, "engine",
       [](World& w) { return sunder_simulation_engine(w.simulation, nullptr); }},
      {"displacement_null", SUNDER_ERROR_NULL, "values",
       [](World& w) {
         return sunder_simulation_displacement(w.simulation, nullptr, w.arrays.nodes.size());
       }},
      {"event_count_null", SUNDER_ERROR_NULL, "count",
       [](World& w) { return sunder_simulation_event_count(w.simulation, nullptr); }},
      {"warning_count_null", SUNDER_ERROR_NULL, "count",
       [](World& w) { return sunder_simulation_warning_count(w.simulation, nullptr); }},
      {"crack_count_null", SUNDER_ERROR_NULL, "count",
       [](World& w) { return sunder_simulation_crack_count(w.simulation, nullptr); }},
      {"drive_null", SUNDER_ERROR_NULL, "value",
       [](World& w) { return sunder_simulation_drive(w.simulation, 0, nullptr); }},
      {"grips_create_null", SUNDER_ERROR_NULL, "grips",
       [](World& w) { return sunder_grips_create(w.simulation, nullptr); }},
      {"device_count_null", SUNDER_ERROR_NULL, "count",
       [](World&) { return sunder_device_count(nullptr); }},
      {"device_null", SUNDER_ERROR_NULL, "device",
       [](World&) { return sunder_device_at(0, nullptr); }},
      {"text_buffer_null", SUNDER_ERROR_NULL, "text buffer",
       [](World& w) { return sunder_plan_buffer(w.plan, 0, nullptr, nullptr, 10, nullptr); }},
  };
}

std::vector<Misuse> sizes() {
  return {
      {"nodes_not_triples", SUNDER_ERROR_SIZE, "nodes has 13",
       [](World& w) {
         return sunder_scene_set_mesh(w.scene, w.arrays.nodes.data(), 13, w.arrays.tets.data(), 4,
                                      nullptr, 0);
       }},
      {"tets_not_quadruples", SUNDER_ERROR_SIZE, "tets has 5",
       [](World& w) {
         return sunder_scene_set_mesh(w.scene, w.arrays.nodes.data(), 12, w.arrays.tets.data(), 5,
                                      nullptr, 0);
       }},
      {"no_nodes", SUNDER_ERROR_SIZE, "nodes has 0",
       [](World& w) {
         return sunder_scene_set_mesh(w.scene, w.arrays.nodes.data(), 0, w.arrays.tets.data(), 4,
                                      nullptr, 0);
       }},
      {"too_many_tets", SUNDER_ERROR_SIZE, "tets",
       [](World& w) {
         return sunder_scene_set_mesh(w.scene, w.arrays.nodes.data(), 12, w.arrays.tets.data(),
                                      std::size_t{1} << 62, nullptr, 0);
       }},
      {"materials_of_too_few", SUNDER_ERROR_SIZE, "material_of has 1",
       [](World& w) {
         const std::int32_t zero = 0;
         return sunder_scene_set_mesh(w.scene, w.arrays.nodes.data(), w.arrays.nodes.size(),
                                      w.arrays.tets.data(), w.arrays.tets.size(), &zero, 1);
       }},
      {"materials_of_null_with_size", SUNDER_ERROR_SIZE, "material_of (null)",
       [](World& w) {
         return sunder_scene_set_mesh(w.scene, w.arrays.nodes.data(), 12, w.arrays.tets.data(), 4,
                                      nullptr, 1);
       }},
      {"ids_too_many", SUNDER_ERROR_SIZE, "32 bits",
       [](World& w) {
         const std::int32_t id = 0;
         return w.add_support([&](sunder_support& s) {
           s.nodes.kind = SUNDER_SELECT_IDS;
           s.nodes.ids = &id;
           s.nodes.id_count = std::size_t{1} << 40;
         });
       }},
      {"displacement_too_short", SUNDER_ERROR_SIZE, "must have 150",
       [](World& w) { return sunder_simulation_displacement(w.simulation, w.values, 3); }},
      {"stress_too_short", SUNDER_ERROR_SIZE, "must have 576",
       [](World& w) { return sunder_simulation_stress(w.simulation, w.values, 6); }},
      {"max_shear_too_short", SUNDER_ERROR_SIZE, "must have 96",
       [](World& w) { return sunder_simulation_max_shear(w.simulation, w.values, 8); }},
      {"yield_ratio_too_short", SUNDER_ERROR_SIZE, "must have 96",
       [](World& w) { return sunder_simulation_yield_ratio(w.simulation, w.values, 8); }},
      {"destroyed_too_short", SUNDER_ERROR_SIZE, "must have 96",
       [](World& w) {
         std::uint8_t byte = 0;
         return sunder_simulation_destroyed(w.simulation, &byte, 1);
       }},
      {"reactions_too_short", SUNDER_ERROR_SIZE, "must have 3",
       [](World& w) { return sunder_simulation_reactions(w.simulation, w.values, 2); }},
      {"support_reaction_too_long", SUNDER_ERROR_SIZE, "must have 3",
       [](World& w) { return sunder_simulation_support_reaction(w.simulation, w.values, 8); }},
      {"zero_size", SUNDER_ERROR_SIZE, "has 0",
       [](World& w) { return sunder_simulation_displacement(w.simulation, w.values, 0); }},
  };
}

std::vector<Misuse> struct_sizes() {
  return {
      {"material_size_unset", SUNDER_ERROR_STRUCT_SIZE, "struct_size = 0",
       [](World& w) {
         const sunder_material m{};
         return sunder_scene_add_material(w.scene, &m, nullptr);
       }},
      {"instrument_size_short", SUNDER_ERROR_STRUCT_SIZE, "struct_size = 8",
       [](World& w) { return w.add_instrument([](sunder_instrument& i) { i.struct_size = 8; }); }},
      {"fracture_size_garbage", SUNDER_ERROR_STRUCT_SIZE, "struct_size",
       [](World& w) {
         return w.set_fracture([](sunder_fracture_options& f) { f.struct_size = 0xffffffff; });
       }},
      {"newer_members_set", SUNDER_ERROR_STRUCT_SIZE, "does not know",
       [](World& w) {
         struct Newer {
           sunder_solver_options known;
           double unknown;
         } newer{on(SUNDER_BACKEND_CPU), 1.0};
         newer.known.struct_size = sizeof newer;
         return sunder_scene_set_solver(w.scene, &newer.known);
       }},
      {"step_size_unset", SUNDER_ERROR_STRUCT_SIZE, "step has struct_size = 0",
       [](World& w) {
         sunder_step step{};
         return sunder_simulation_step(w.simulation, &step);
       }},
      {"engine_size_unset", SUNDER_ERROR_STRUCT_SIZE, "engine",
       [](World& w) {
         sunder_engine engine{};
         return sunder_simulation_engine(w.simulation, &engine);
       }},
      {"device_size_unset", SUNDER_ERROR_STRUCT_SIZE, "device",
       [](World&) {
         sunder_device device{};
         return sunder_device_at(0, &device);
       }},
      {"callbacks_size_unset", SUNDER_ERROR_STRUCT_SIZE, "callbacks",
       [](World& w) {
         const sunder_callbacks callbacks{};
         return sunder_simulation_create(w.scene, &callbacks, &w.made);
       }},
  };
}

std::vector<Misuse> values() {
  return {
      {"axes_none", SUNDER_ERROR_VALUE, "axes = 0",
       [](World& w) { return w.add_support([](sunder_support& s) { s.axes = 0; }); }},
      {"axes_unknown", SUNDER_ERROR_VALUE, "axes = 8",
       [](World& w) { return w.add_support([](sunder_support& s) { s.axes = 8; }); }},
      {"selection_unknown", SUNDER_ERROR_VALUE, "selection kind",
       [](World& w) { return w.add_support([](sunder_support& s) { s.nodes.kind = 3; }); }},
      {"ball_of_elements", SUNDER_ERROR_VALUE, "selection kind",
       [](World& w) {
         sunder_selection s{};
         s.kind = SUNDER_SELECT_BALL;
         return sunder_scene_add_removal(w.scene, 0, &s);
       }},
      {"instrument_kind_unknown", SUNDER_ERROR_VALUE, "instrument kind = 3",
       [](World& w) { return w.add_instrument([](sunder_instrument& i) { i.kind = 3; }); }},
      {"side_unknown", SUNDER_ERROR_VALUE, "side",
       [](World& w) {
         return w.add_instrument([](sunder_instrument& i) {
           i.kind = SUNDER_PRESSURE;
           i.side = -1;
         });
       }},
      {"model_unknown", SUNDER_ERROR_VALUE, "model = 7",
       [](World& w) { return w.set_fracture([](sunder_fracture_options& f) { f.model = 7; }); }},
      {"sif_unknown", SUNDER_ERROR_VALUE, "sif",
       [](World& w) { return w.set_fracture([](sunder_fracture_options& f) { f.sif = -2; }); }},
      {"backend_unknown", SUNDER_ERROR_VALUE, "backend = 9",
       [](World& w) { return w.set_solver([](sunder_solver_options& s) { s.backend = 9; }); }},
      {"device_negative", SUNDER_ERROR_VALUE, "device = -2",
       [](World& w) { return w.set_solver([](sunder_solver_options& s) { s.device = -2; }); }},
      {"route_unknown", SUNDER_ERROR_VALUE, "route",
       [](World& w) { return w.set_solver([](sunder_solver_options& s) { s.route = 5; }); }},
      {"precision_unknown", SUNDER_ERROR_VALUE, "precision",
       [](World& w) { return w.set_solver([](sunder_solver_options& s) { s.precision = 3; }); }},
      {"steps_zero", SUNDER_ERROR_VALUE, "steps = 0",
       [](World& w) { return sunder_scene_set_steps(w.scene, 0); }},
      {"event_index", SUNDER_ERROR_VALUE, "event 0 does not exist",
       [](World& w) {
         sunder_event event{};
         event.struct_size = sizeof event;
         return sunder_simulation_event_at(w.simulation, 0, &event);
       }},
      {"crack_index", SUNDER_ERROR_VALUE, "crack -1",
       [](World& w) { return sunder_simulation_crack_path(w.simulation, -1, w.values, 8); }},
      {"warning_index", SUNDER_ERROR_VALUE, "warning 99",
       [](World& w) {
         return sunder_simulation_warning_at(w.simulation, 99, nullptr, 0, nullptr);
       }},
      {"plan_buffer_index", SUNDER_ERROR_VALUE, "buffer 1000",
       [](World& w) { return sunder_plan_buffer(w.plan, 1000, nullptr, nullptr, 0, nullptr); }},
      {"device_index", SUNDER_ERROR_VALUE, "device 1000",
       [](World&) {
         sunder_device device{};
         device.struct_size = sizeof device;
         return sunder_device_at(1000, &device);
       }},
      {"drive_index", SUNDER_ERROR_VALUE, "instrument 1",
       [](World& w) { return sunder_simulation_drive(w.simulation, 1, w.values); }},
  };
}

std::vector<Misuse> scenes() {
  return {
      {"scene_empty", SUNDER_ERROR_INPUT, "no tetrahedra",
       [](World& w) { return w.create(w.empty); }},
      {"node_id_outside", SUNDER_ERROR_INPUT, "names node 5000",
       [](World& w) {
         return w.create_with([&] {
           w.arrays.tets[7] = 5000;
           return w.set_mesh(w.arrays);
         });
       }},
      {"material_index_outside", SUNDER_ERROR_INPUT, "volume",
       [](World& w) {
         return w.create_with([&] {
           const std::vector<std::int32_t> of(w.arrays.tets.size() / 4, 3);
           return sunder_scene_set_mesh(w.scene, w.arrays.nodes.data(), w.arrays.nodes.size(),
                                        w.arrays.tets.data(), w.arrays.tets.size(), of.data(),
                                        of.size());
         });
       }},
      {"young_negative", SUNDER_ERROR_INPUT, "young = -1",
       [](World& w) { return w.create_with([&] { return w.add_material(-1, 0.4, 0); }); }},
      {"poisson_half", SUNDER_ERROR_INPUT, "poisson = 0.5",
       [](World& w) { return w.create_with([&] { return w.add_material(5, 0.5, 0); }); }},
      {"alpha_zero", SUNDER_ERROR_INPUT, "alpha",
       [](World& w) {
         return w.create_with(
             [&] { return w.set_fracture([](sunder_fracture_options& f) { f.alpha = 0; }); });
       }},
      {"support_selects_nothing", SUNDER_ERROR_INPUT, "fixed 1",
       [](World& w) {
         return w.create_with([&] {
           return w.add_support([](sunder_support& s) { s.nodes = box(90, 90, 91, 91); });
         });
       }},
      {"instrument_named_twice", SUNDER_ERROR_INPUT, "forceps",
       [](World& w) {
         return w.create_with(
             [&] { return w.add_instrument([](sunder_instrument& i) { i.name = "forceps"; }); });
       }},
      {"ramp_backwards", SUNDER_ERROR_INPUT, "ramp",
       [](World& w) {
         return w.create_with([&] {
           return w.add_instrument([](sunder_instrument& i) {
             i.has_ramp = 1;
             i.ramp[0] = 1;
           });
         });
       }},
      {"removal_step_outside", SUNDER_ERROR_INPUT, "step 4",
       [](World& w) {
         return w.create_with([&] {
           const std::int32_t id = 1;
           sunder_selection s{};
           s.ids = &id;
           s.id_count = 1;
           return sunder_scene_add_removal(w.scene, 4, &s);
         });
       }},
      {"plan_of_empty_scene", SUNDER_ERROR_INPUT, "no tetrahedra",
       [](World& w) {
         sunder_plan plan = nullptr;
         const sunder_status status = sunder_plan_create(w.empty, &plan);
         EXPECT_EQ(plan, nullptr);
         return status;
       }},
      {"device_missing", SUNDER_ERROR_DEVICE, "",
       [](World& w) {
         return w.create_with([&] {
           return w.set_solver([](sunder_solver_options& s) {
             s.backend = SUNDER_BACKEND_VULKAN;
             s.device = 77;
           });
         });
       }},
      {"dropped_condensed_eager", SUNDER_ERROR_DEVICE,
       "use update deferred or auto, or route inverse",
       [](World& w) {
         return w.create_with([&] {
           return w.set_solver([](sunder_solver_options& s) {
             s.backend = SUNDER_BACKEND_CPU;
             s.route = SUNDER_ROUTE_CONDENSED;
             s.update = SUNDER_UPDATE_EAGER;
           });
         });
       }},
      {"dropped_eager_fp32", SUNDER_ERROR_DEVICE, "use precision fp64 or auto",
       [](World& w) {
         return w.create_with([&] {
           return w.set_solver([](sunder_solver_options& s) {
             s.backend = SUNDER_BACKEND_CPU;
             s.precision = SUNDER_PRECISION_FP32;
             s.update = SUNDER_UPDATE_EAGER;
           });
         });
       }},
  };
}

std::vector<Misuse> order() {
  return {
      {"support_reaction_before_step", SUNDER_ERROR_ORDER, "before the first",
       [](World& w) { return sunder_simulation_support_reaction(w.simulation, w.values, 3); }},
      {"grips_without_grip", SUNDER_ERROR_ORDER, "holds nodes",
       [](World& w) {
         sunder_grips grips = nullptr;
         return sunder_grips_create(w.simulation, &grips);
       }},
      {"step_when_done", SUNDER_ERROR_ORDER, "all steps",
       [](World& w) {
         for (int i = 0; i < 4; ++i) EXPECT_OK(sunder_simulation_step(w.simulation, nullptr));
         return sunder_simulation_step(w.simulation, nullptr);
       }},
      {"stress_left_out", SUNDER_ERROR_ORDER, "stress was left out",
       [](World& w) {
         EXPECT_OK(w.set_fracture([](sunder_fracture_options& f) { f.model = 0; }));
         EXPECT_OK(sunder_scene_set_stress(w.scene, 0));
         sunder_simulation quiet = nullptr;
         EXPECT_OK(sunder_simulation_create(w.scene, nullptr, &quiet));
         std::vector<double> stress(576);
         const sunder_status status = sunder_simulation_stress(quiet, stress.data(), stress.size());
         const std::string text = sunder_last_error();
         EXPECT_OK(sunder_simulation_destroy(quiet));
         EXPECT_EQ(text, sunder_last_error()) << "success leaves the last error";
         return status;
       }},
  };
}

/// A number that is not finite is noticed by the call that hands it over, and by none that does not
/// read it.
std::vector<Misuse> not_finite() {
  return {
      {"node_nan", SUNDER_ERROR_VALUE, "nodes[4] = nan",
       [](World& w) {
         w.arrays.nodes[4] = kNaN;
         return w.set_mesh(w.arrays);
       }},
      {"node_infinite", SUNDER_ERROR_VALUE, "nodes[149] = -inf",
       [](World& w) {
         w.arrays.nodes[149] = -kInfinity;
         return w.set_mesh(w.arrays);
       }},
      {"young_nan", SUNDER_ERROR_VALUE, "young = nan",
       [](World& w) { return w.add_material(kNaN, 0.4, 0); }},
      {"poisson_nan", SUNDER_ERROR_VALUE, "poisson = nan",
       [](World& w) { return w.add_material(5, -kNaN, 0); }},
      {"yield_infinite", SUNDER_ERROR_VALUE, "yield = inf",
       [](World& w) { return w.add_material(5, 0.4, kInfinity); }},
      {"box_min_nan", SUNDER_ERROR_VALUE, "support: min[2] = nan",
       [](World& w) { return w.add_support([](sunder_support& s) { s.nodes.min[2] = kNaN; }); }},
      {"box_max_infinite", SUNDER_ERROR_VALUE, "support: max[0] = inf",
       [](World& w) {
         return w.add_support([](sunder_support& s) { s.nodes.max[0] = kInfinity; });
       }},
      {"ball_centre_nan", SUNDER_ERROR_VALUE, "instrument: min[1] = nan",
       [](World& w) {
         return w.add_instrument([](sunder_instrument& i) {
           i.nodes.kind = SUNDER_SELECT_BALL;
           i.nodes.min[1] = kNaN;
         });
       }},
      {"ball_radius_nan", SUNDER_ERROR_VALUE, "instrument: radius = nan",
       [](World& w) {
         return w.add_instrument([](sunder_instrument& i) {
           i.nodes.kind = SUNDER_SELECT_BALL;
           i.nodes.radius = kNaN;
         });
       }},
      {"force_nan", SUNDER_ERROR_VALUE, "value[2] = nan",
       [](World& w) { return w.add_instrument([](sunder_instrument& i) { i.value[2] = kNaN; }); }},
      {"grip_infinite", SUNDER_ERROR_VALUE, "value[0] = inf",
       [](World& w) {
         return w.add_instrument([](sunder_instrument& i) {
           i.kind = SUNDER_DISPLACEMENT;
           i.value[0] = kInfinity;
         });
       }},
      {"pressed_place_nan", SUNDER_ERROR_VALUE, "at[0] = nan",
       [](World& w) {
         return w.add_instrument([](sunder_instrument& i) {
           i.kind = SUNDER_PRESSURE;
           i.at[0] = kNaN;
         });
       }},
      {"ramp_nan", SUNDER_ERROR_VALUE, "ramp[1] = nan",
       [](World& w) {
         return w.add_instrument([](sunder_instrument& i) {
           i.has_ramp = 1;
           i.ramp[1] = kNaN;
         });
       }},
      {"mouth_nan", SUNDER_ERROR_VALUE, "mouth[1] = nan",
       [](World& w) {
         return w.add_crack([](sunder_preset_crack& c) {
           c.has_mouth = 1;
           c.mouth[1] = kNaN;
         });
       }},
      {"first_tip_nan", SUNDER_ERROR_VALUE, "tips[0][0] = nan",
       [](World& w) {
         return w.add_crack([](sunder_preset_crack& c) {
           c.has_mouth = 1;
           c.tips[0][0] = kNaN;
         });
       }},
      {"second_tip_nan", SUNDER_ERROR_VALUE, "tips[1][2] = nan",
       [](World& w) { return w.add_crack([](sunder_preset_crack& c) { c.tips[1][2] = kNaN; }); }},
      {"crack_box_nan", SUNDER_ERROR_VALUE, "crack: max[0] = nan",
       [](World& w) {
         return w.add_crack([](sunder_preset_crack& c) { c.elements.max[0] = kNaN; });
       }},
      {"removal_box_nan", SUNDER_ERROR_VALUE, "removal: min[0] = nan",
       [](World& w) {
         sunder_selection s = box(0, 0, 1, 1);
         s.min[0] = kNaN;
         return sunder_scene_add_removal(w.scene, 0, &s);
       }},
      {"alpha_nan", SUNDER_ERROR_VALUE, "alpha = nan",
       [](World& w) { return w.set_fracture([](sunder_fracture_options& f) { f.alpha = kNaN; }); }},
      {"plane_normal_nan", SUNDER_ERROR_VALUE, "plane_normal[2] = nan",
       [](World& w) {
         return w.set_fracture([](sunder_fracture_options& f) {
           f.has_plane_normal = 1;
           f.plane_normal[2] = kNaN;
         });
       }},
      {"tolerance_infinite", SUNDER_ERROR_VALUE, "tolerance = inf",
       [](World& w) {
         return w.set_solver([](sunder_solver_options& s) { s.tolerance = kInfinity; });
       }},
      {"drive_nan", SUNDER_ERROR_VALUE, "value[1] = nan",
       [](World& w) {
         w.values[1] = kNaN;
         return sunder_simulation_drive(w.simulation, 0, w.values);
       }},
      {"drive_infinite", SUNDER_ERROR_VALUE, "value[0] = -inf",
       [](World& w) {
         w.values[0] = -kInfinity;
         return sunder_simulation_drive(w.simulation, 0, w.values);
       }},
  };
}

TEST(CNotFinite, IsNoMatterWhereItIsNotRead) {
  World w;
  EXPECT_OK(w.add_instrument([](sunder_instrument& i) {
    std::fill_n(i.at, 3, kNaN);
    std::fill_n(i.ramp, 2, kNaN);
  }));
  EXPECT_OK(w.add_support([](sunder_support& s) {
    static const std::int32_t ids[] = {0};
    s.nodes.kind = SUNDER_SELECT_IDS;
    s.nodes.ids = ids;
    s.nodes.id_count = 1;
    s.nodes.radius = s.nodes.min[0] = s.nodes.max[1] = kNaN;
  }));
  EXPECT_OK(w.set_fracture([](sunder_fracture_options& f) { f.plane_normal[0] = kNaN; }));
  EXPECT_OK(w.add_crack([](sunder_preset_crack& c) {
    c.has_mouth = 1;
    c.tips[1][0] = kNaN;
  }));
}

std::vector<Misuse> all() {
  std::vector<Misuse> list;
  for (const auto& part : {handles(), null_pointers(), sizes(), struct_sizes(), values(),
                           not_finite(), scenes(), order()}) {
    list.insert(list.end(), part.begin(), part.end());
  }
  return list;
}

class CMisuse : public testing::TestWithParam<Misuse> {};

TEST_P(CMisuse, GivesAStatusAndASentence) {
  World world;
  const sunder_status status = GetParam().call(world);
  EXPECT_EQ(status, GetParam().status) << sunder_status_text(status);
  const std::string text = sunder_last_error();
  EXPECT_FALSE(text.empty());
  EXPECT_NE(text.find(GetParam().says), std::string::npos) << text;
  for (const char* word :
       {"()", "::", "Problem", "Backend", "Needs", "Simulation", "Error", "std"}) {
    EXPECT_EQ(text.find(word), std::string::npos) << "a caller in C has none of C++: " << text;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, CMisuse, testing::ValuesIn(all()),
                         [](const auto& test) { return std::string(test.param.name); });

// What a host's mesh may hold beside the body: nodes that nothing uses keep their ids and stay in
// place, elements of a left-handed host are turned; one warning each, the fields as without.
TEST(COddMesh, IsUsedWithAWarning) {
  World world;
  const auto field = [&](const Arrays& arrays, std::int32_t* warnings) {
    EXPECT_OK(world.set_mesh(arrays));
    sunder_simulation simulation = nullptr;
    EXPECT_OK(sunder_simulation_create(world.scene, nullptr, &simulation));
    sunder_step step{};
    step.struct_size = sizeof step;
    EXPECT_OK(sunder_simulation_step(simulation, &step));
    std::vector<double> u(arrays.nodes.size());
    EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
    EXPECT_OK(sunder_simulation_warning_count(simulation, warnings));
    EXPECT_OK(sunder_simulation_destroy(simulation));
    return u;
  };
  std::int32_t plain = 0, odd = 0;
  const std::vector<double> expected = field(world.arrays, &plain);
  Arrays arrays = world.arrays;
  arrays.nodes.insert(arrays.nodes.end(), {1e6, 0, 0});
  for (std::size_t t = 0; t < arrays.tets.size(); t += 4)
    std::swap(arrays.tets[t], arrays.tets[t + 1]);
  const std::vector<double> u = field(arrays, &odd);
  EXPECT_EQ(odd, plain + 1);
  double largest = 0;
  for (const double x : expected) largest = std::max(largest, std::abs(x));
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LE(std::abs(u[i] - expected[i]), 1e-9 * largest) << i;
  for (std::size_t i = expected.size(); i < u.size(); ++i) EXPECT_EQ(u[i], 0);
}

TEST(CMisuseTable, HasAtLeastAHundredCalls) { EXPECT_GE(all().size(), 100u); }

}  // namespace
}  // namespace sunder::test
