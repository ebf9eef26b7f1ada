// SPDX-License-Identifier: Apache-2.0
// Every function that takes a handle, with handles that are none and with one in use: each says so
// in a sentence and touches nothing. The table is held against the headers: none is left out.
#include <atomic>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <thread>

#include "api/c_scene.hpp"
#include "sunder/sunder_vulkan.h"

namespace sunder::test {
namespace {

/// What a call may read and write. Filled with one byte, which no refused call changes.
struct CallRoom {
  std::int32_t ids[8];
  double numbers[16];
  float floats[8];
  std::uint8_t bytes[16];
  char text[16];
  std::size_t size;
  std::uint64_t large;
  const double* lent;
  const std::uint8_t* lent_bytes;
  sunder_scene scene;
  sunder_simulation made;
  sunder_plan plan;
  sunder_grips grips;
  sunder_frames frames;
  sunder_bodies bodies;
  sunder_engine engine;
  sunder_step step;
  sunder_body body;
  sunder_event event;
  sunder_crack crack;
  sunder_tip tip;
  sunder_interface state;
  sunder_surface surface;
  sunder_triangle triangle;
  sunder_hand hand;
  sunder_felt felt;
  sunder_frame frame;
  sunder_material material;
  sunder_support support;
  sunder_instrument instrument;
  sunder_preset_crack preset;
  sunder_fibres fibres;
  sunder_selection selection;
  sunder_fracture_options fracture;
  sunder_solver_options solver;
  sunder_dynamics dynamics;
  sunder_vulkan_host host;
  sunder_vulkan_display display;
  sunder_vulkan_signals signals;
  sunder_vulkan_surface buffers;
};

struct EveryCall {
  const char* name;
  const char* kind;
  std::function<sunder_status(void*, CallRoom&)> call;
};

/// A function with its handle and what else it takes, out of the room `r`.
#define SUNDER_CALL(kind, function, ...)                                                              \
  EveryCall {                                                                                         \
#function, #kind,                                                                                 \
        [](void* handle,                                                                              \
           [[maybe_unused]] CallRoom&                                                                 \
               r) { return function(static_cast<sunder_##kind>(handle) __VA_OPT__(, )                 \
                                        __VA_ARGS__); } \
  }

std::vector<EveryCall> calls_of_simulations() {
  return {
      SUNDER_CALL(simulation, sunder_simulation_cancel),
      SUNDER_CALL(simulation, sunder_simulation_destroy),
      SUNDER_CALL(simulation, sunder_simulation_engine, &r.engine),
      SUNDER_CALL(simulation, sunder_simulation_step, &r.step),
      SUNDER_CALL(simulation, sunder_simulation_step_by, 1, &r.step),
      SUNDER_CALL(simulation, sunder_simulation_step_within, 1, &r.step),
      SUNDER_CALL(simulation, sunder_simulation_warm_up),
      SUNDER_CALL(simulation, sunder_simulation_drive, 0, r.numbers),
      SUNDER_CALL(simulation, sunder_simulation_turn, 0, r.numbers),
      SUNDER_CALL(simulation, sunder_simulation_displacement, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_velocity, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_set_velocity, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_stress, r.numbers, 6),
      SUNDER_CALL(simulation, sunder_simulation_max_shear, r.numbers, 1),
      SUNDER_CALL(simulation, sunder_simulation_yield_ratio, r.numbers, 1),
      SUNDER_CALL(simulation, sunder_simulation_destroyed, r.bytes, 1),
      SUNDER_CALL(simulation, sunder_simulation_reactions, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_support_reaction, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_lend, SUNDER_FIELD_STRESS, &r.lent, &r.size),
      SUNDER_CALL(simulation, sunder_simulation_lend_destroyed, &r.lent_bytes, &r.size),
      SUNDER_CALL(simulation, sunder_simulation_body, &r.body),
      SUNDER_CALL(simulation, sunder_simulation_body_nodes, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_body_corners, r.ids, 4),
      SUNDER_CALL(simulation, sunder_simulation_body_parents, r.ids, 1),
      SUNDER_CALL(simulation, sunder_simulation_body_displacement, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_crack_faces, r.ids, 7),
      SUNDER_CALL(simulation, sunder_simulation_event_count, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_event_at, 0, &r.event),
      SUNDER_CALL(simulation, sunder_simulation_crack_count, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_crack_at, 0, &r.crack),
      SUNDER_CALL(simulation, sunder_simulation_crack_path, 0, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_crack_elements, 0, r.ids, 1),
      SUNDER_CALL(simulation, sunder_simulation_measure_tips, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_tip_at, 0, &r.tip),
      SUNDER_CALL(simulation, sunder_simulation_interface_count, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_interface_at, 0, &r.state),
      SUNDER_CALL(simulation, sunder_simulation_warning_count, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_warning_at, 0, r.text, 16, &r.size),
      SUNDER_CALL(simulation, sunder_simulation_remove, r.ids, 1),
      SUNDER_CALL(simulation, sunder_simulation_cut, r.numbers, 9, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_prepare, r.ids, 1),
      SUNDER_CALL(simulation, sunder_simulation_prepare_near, r.numbers, 1, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_grasp, r.ids, 1, 0, r.ids + 1),
      SUNDER_CALL(simulation, sunder_simulation_grasp_near, r.numbers, 1, 0, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_held_nodes, 1, r.ids, 8, &r.size),
      SUNDER_CALL(simulation, sunder_simulation_grip_place, 1, r.numbers),
      SUNDER_CALL(simulation, sunder_simulation_pose, 1, r.numbers, r.numbers + 3),
      SUNDER_CALL(simulation, sunder_simulation_wrench, 1, r.numbers, r.numbers + 3),
      SUNDER_CALL(simulation, sunder_simulation_release, 1),
      SUNDER_CALL(simulation, sunder_simulation_push, r.ids, 1, r.numbers, r.ids + 1),
      SUNDER_CALL(simulation, sunder_simulation_move, 1, r.ids, 1, r.numbers),
      SUNDER_CALL(simulation, sunder_simulation_drop, 1),
      SUNDER_CALL(simulation, sunder_simulation_keep_history, 1),
      SUNDER_CALL(simulation, sunder_simulation_history, r.ids, r.ids + 1),
      SUNDER_CALL(simulation, sunder_simulation_undo, 1, r.ids, r.ids + 1),
      SUNDER_CALL(simulation, sunder_simulation_redo, 1, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_save, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_restore, 1, r.ids),
      SUNDER_CALL(simulation, sunder_simulation_forget, 1),
      SUNDER_CALL(simulation, sunder_simulation_store, r.bytes, 16, &r.size),
      SUNDER_CALL(simulation, sunder_simulation_load, r.bytes, 16),
      SUNDER_CALL(simulation, sunder_simulation_surface, &r.surface),
      SUNDER_CALL(simulation, sunder_simulation_surface_changes, 0, &r.triangle, 1, &r.size),
      SUNDER_CALL(simulation, sunder_simulation_surface_points, r.floats, r.floats + 3, 3),
      SUNDER_CALL(simulation, sunder_simulation_set_skin, r.numbers, 3),
      SUNDER_CALL(simulation, sunder_simulation_skin, r.floats, 3, r.bytes),
      SUNDER_CALL(simulation, sunder_grips_create, &r.grips),
      SUNDER_CALL(simulation, sunder_frames_create, SUNDER_FRAME_STRESS, r.ids, 1, &r.frames),
      SUNDER_CALL(simulation, sunder_vulkan_get_display, &r.display),
      SUNDER_CALL(simulation, sunder_vulkan_record, r.bytes),
      SUNDER_CALL(simulation, sunder_vulkan_submit, &r.signals),
      SUNDER_CALL(simulation, sunder_vulkan_pipeline_cache, r.bytes, 16, &r.size),
      SUNDER_CALL(simulation, sunder_vulkan_lend_surface, &r.host, &r.buffers),
      SUNDER_CALL(simulation, sunder_vulkan_record_surface, r.bytes, &r.surface),
  };
}

std::vector<EveryCall> calls_of_scenes() {
  return {
      SUNDER_CALL(scene, sunder_scene_destroy),
      SUNDER_CALL(scene, sunder_scene_set_mesh, r.numbers, 12, r.ids, 4, nullptr, 0),
      SUNDER_CALL(scene, sunder_scene_add_material, &r.material, r.ids),
      SUNDER_CALL(scene, sunder_scene_add_support, &r.support),
      SUNDER_CALL(scene, sunder_scene_add_instrument, &r.instrument, r.ids),
      SUNDER_CALL(scene, sunder_scene_add_crack, &r.preset),
      SUNDER_CALL(scene, sunder_scene_add_removal, 0, &r.selection),
      SUNDER_CALL(scene, sunder_scene_add_fibres, 0, &r.fibres),
      SUNDER_CALL(scene, sunder_scene_add_interface, 0, 0, 1, 1, 1),
      SUNDER_CALL(scene, sunder_scene_set_fracture, &r.fracture),
      SUNDER_CALL(scene, sunder_scene_set_solver, &r.solver),
      SUNDER_CALL(scene, sunder_scene_set_steps, 1),
      SUNDER_CALL(scene, sunder_scene_set_gravity, r.numbers),
      SUNDER_CALL(scene, sunder_scene_set_dynamics, &r.dynamics),
      SUNDER_CALL(scene, sunder_scene_set_live, 1),
      SUNDER_CALL(scene, sunder_scene_set_stress, 1),
      SUNDER_CALL(scene, sunder_plan_create, &r.plan),
      SUNDER_CALL(scene, sunder_simulation_create, nullptr, &r.made),
      SUNDER_CALL(scene, sunder_simulation_create_of, r.bodies, nullptr, &r.made),
      SUNDER_CALL(scene, sunder_vulkan_create, &r.host, nullptr, &r.made),
      SUNDER_CALL(scene, sunder_vulkan_set_pipeline_cache, r.bytes, 16),
  };
}

std::vector<EveryCall> other_calls() {
  return {
      SUNDER_CALL(plan, sunder_plan_destroy),
      SUNDER_CALL(plan, sunder_plan_engine, &r.engine),
      SUNDER_CALL(plan, sunder_plan_counts, r.ids, r.ids + 1),
      SUNDER_CALL(plan, sunder_plan_buffer, 0, &r.large, r.text, 16, &r.size),
      SUNDER_CALL(plan, sunder_plan_left_out, 0, r.text, 16, &r.size),
      SUNDER_CALL(grips, sunder_grips_destroy),
      SUNDER_CALL(grips, sunder_grips_forces, r.numbers, r.numbers + 3, 3),
      SUNDER_CALL(grips, sunder_grips_feel, r.numbers, r.numbers + 3, 3, &r.hand, 1, &r.felt),
      SUNDER_CALL(grips, sunder_grips_blend, 1),
      SUNDER_CALL(frames, sunder_frames_destroy),
      SUNDER_CALL(frames, sunder_frames_take, &r.frame),
      SUNDER_CALL(frames, sunder_frames_displacement, r.numbers, 3),
      SUNDER_CALL(frames, sunder_frames_stress, r.numbers, 6),
      SUNDER_CALL(frames, sunder_frames_yield_ratio, r.numbers, 1),
      SUNDER_CALL(frames, sunder_frames_destroyed, r.bytes, 1),
      SUNDER_CALL(bodies, sunder_bodies_destroy),
  };
}

std::vector<EveryCall> every_call() {
  std::vector<EveryCall> all = calls_of_simulations();
  for (const auto& part : {calls_of_scenes(), other_calls()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

CallRoom untouched() {
  CallRoom room;
  std::memset(static_cast<void*>(&room), 0xa5, sizeof room);
  return room;
}

/// Nothing but the status and a sentence, which says `part`.
void expect_refused(const EveryCall& of, void* handle, sunder_status status,
                    const std::string& part) {
  static_cast<void>(sunder_scene_create(nullptr));  // another sentence
  CallRoom room = untouched();
  const CallRoom before = room;
  EXPECT_EQ(of.call(handle, room), status) << of.name;
  EXPECT_NE(std::string(sunder_last_error()).find(part), std::string::npos)
      << of.name << ": " << sunder_last_error();
  EXPECT_EQ(std::memcmp(&room, &before, sizeof room), 0) << of.name << " touched something";
}

/// One living handle of each kind.
struct Living {
  sunder_scene scene = board_scene();
  sunder_simulation simulation = nullptr;
  sunder_plan plan = nullptr;
  sunder_grips grips = nullptr;
  sunder_frames frames = nullptr;
  sunder_bodies bodies = nullptr;

  Living() {
    EXPECT_OK(sunder_scene_set_live(scene, 1));
    EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
    EXPECT_OK(sunder_plan_create(scene, &plan));
    EXPECT_OK(sunder_grips_create(simulation, &grips));
    EXPECT_OK(sunder_frames_create(simulation, SUNDER_FRAME_DESTROYED, nullptr, 0, &frames));
    EXPECT_OK(sunder_bodies_create(1, &bodies));
  }
  ~Living() { end(); }
  Living(const Living&) = delete;
  Living& operator=(const Living&) = delete;
  void end() {
    if (!scene) return;
    EXPECT_OK(sunder_bodies_destroy(bodies));
    EXPECT_OK(sunder_frames_destroy(frames));
    EXPECT_OK(sunder_grips_destroy(grips));
    EXPECT_OK(sunder_plan_destroy(plan));
    EXPECT_OK(sunder_simulation_destroy(simulation));
    EXPECT_OK(sunder_scene_destroy(scene));
    scene = nullptr;
  }
  [[nodiscard]] std::vector<std::pair<std::string, void*>> handles() const {
    return {{"scene", scene}, {"simulation", simulation}, {"plan", plan},
            {"grips", grips}, {"frames", frames},         {"bodies", bodies}};
  }
};

TEST(CEveryCall, RefusesWhatIsNoHandleOfItsKind) {
  Living living;
  const auto handles = living.handles();
  for (const EveryCall& of : every_call()) {
    SCOPED_TRACE(of.name);
    for (const std::uintptr_t forged :
         {std::uintptr_t{0}, std::uintptr_t{1}, std::uintptr_t{0xdeadbeef}, ~std::uintptr_t{0}}) {
      expect_refused(of, reinterpret_cast<void*>(forged), SUNDER_ERROR_HANDLE, of.kind);
    }
    for (const auto& [kind, handle] : handles) {
      if (kind != of.kind) expect_refused(of, handle, SUNDER_ERROR_HANDLE, of.kind);
    }
  }
  living.end();
  for (const EveryCall& of : every_call()) {
    for (const auto& [kind, handle] : handles) {
      expect_refused(of, handle, SUNDER_ERROR_HANDLE, of.kind);
    }
  }
}

// Within a callback, and by another thread while the callback goes on.
TEST(CEveryCall, FindsASimulationInAStepBusy) {
  struct Host {
    sunder_simulation simulation = nullptr;
    bool tried = false;
    static void refuse_all(sunder_simulation simulation) {
      for (const EveryCall& of : calls_of_simulations()) {
        if (std::string(of.name) == "sunder_simulation_cancel") continue;  // for any moment
        expect_refused(of, simulation, SUNDER_ERROR_BUSY, "in use by another call");
      }
    }
    static std::int32_t inside(void* user, const sunder_progress* p) {
      auto& host = *static_cast<Host*>(user);
      if (p->phase != SUNDER_PHASE_STEP || host.tried) return 0;
      host.tried = true;
      refuse_all(host.simulation);
      std::thread(refuse_all, host.simulation).join();
      return 0;
    }
  } host;
  sunder_callbacks callbacks = SUNDER_CALLBACKS_INIT;
  callbacks.progress = Host::inside;
  callbacks.progress_user = &host;
  const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 4, -400);
  ASSERT_OK(sunder_simulation_create(scene, &callbacks, &host.simulation));
  ASSERT_OK(sunder_scene_destroy(scene));
  ASSERT_OK(sunder_simulation_step(host.simulation, nullptr)) << "as if nobody had called";
  EXPECT_TRUE(host.tried);
  EXPECT_OK(sunder_simulation_destroy(host.simulation));
}

TEST(CEveryCall, FindsASceneBusyThatASimulationIsMadeOf) {
  struct Host {
    sunder_scene scene = board_scene();
    int phases = 0;
    static std::int32_t inside(void* user, const sunder_progress*) {
      auto& host = *static_cast<Host*>(user);
      ++host.phases;
      for (const EveryCall& of : calls_of_scenes()) {
        expect_refused(of, host.scene, SUNDER_ERROR_BUSY, "in use by another call");
      }
      return 0;
    }
  } host;
  sunder_callbacks callbacks = SUNDER_CALLBACKS_INIT;
  callbacks.progress = Host::inside;
  callbacks.progress_user = &host;
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(host.scene, &callbacks, &simulation));
  EXPECT_EQ(host.phases, 2);
  EXPECT_OK(sunder_simulation_destroy(simulation));
  EXPECT_OK(sunder_scene_destroy(host.scene));
}

// A function that the headers get is to be in the table.
TEST(CEveryCall, IsOneOfTheHeaders) {
  std::string text;
  for (const char* name : {"sunder.h", "sunder_vulkan.h"}) {
    std::ifstream file(std::string(SUNDER_SOURCE) + "/api/sunder/" + name);
    ASSERT_TRUE(file) << name;
    text.append(std::istreambuf_iterator<char>(file), {});
  }
  const std::regex declaration(
      "SUNDER_API sunder_status\\s+(sunder_\\w+)\\(\\s*"
      "(sunder_(scene|simulation|plan|grips|frames|bodies) )");
  std::set<std::string> declared, called;
  for (std::sregex_iterator it(text.begin(), text.end(), declaration), end; it != end; ++it) {
    declared.insert((*it)[1]);
  }
  for (const EveryCall& of : every_call()) called.insert(of.name);
  EXPECT_GE(declared.size(), 100U);
  EXPECT_EQ(called, declared);
}

}  // namespace
}  // namespace sunder::test
