// SPDX-License-Identifier: Apache-2.0
// Wrong calls to a live body: grasp, cut, go back, draw, feel, take finished frames, share bodies.
#include "api/misuse.hpp"

namespace sunder::test {
namespace {

constexpr std::size_t kHuge[] = {std::size_t{9} << 40, SIZE_MAX / 9 * 9};

/// A call with counts that no array has, of which nothing can be read.
template <class Call>
sunder_status with_huge(Call call) {
  sunder_status last = SUNDER_OK;
  for (const std::size_t count : kHuge) {
    last = call(count);
    if (last != SUNDER_ERROR_SIZE) return last;
  }
  return last;
}

/// Grips and finished frames of the good simulation, which go with the call.
template <class Call>
sunder_status with_grips(World& w, Call call) {
  EXPECT_OK(sunder_simulation_step(w.simulation, nullptr));
  sunder_grips grips = nullptr;
  EXPECT_OK(sunder_grips_create(w.simulation, &grips));
  const sunder_status status = call(grips);
  EXPECT_OK(sunder_grips_destroy(grips));
  return status;
}

template <class Call>
sunder_status with_frames(World& w, std::uint32_t fields, bool taken, Call call) {
  sunder_frames frames = nullptr;
  EXPECT_OK(sunder_frames_create(w.simulation, fields, nullptr, 0, &frames));
  if (taken) {
    sunder_frame frame = SUNDER_FRAME_INIT;
    EXPECT_OK(sunder_frames_take(frames, &frame));
  }
  const sunder_status status = call(frames);
  EXPECT_OK(sunder_frames_destroy(frames));
  return status;
}

template <class Call>
sunder_status with_bodies(Call call) {
  sunder_bodies bodies = nullptr;
  EXPECT_OK(sunder_bodies_create(1, &bodies));
  const sunder_status status = call(bodies);
  EXPECT_OK(sunder_bodies_destroy(bodies));
  return status;
}

/// What the good simulation tells after a step, damaged by `change`, told to it again.
template <class Change>
sunder_status load_changed(World& w, Change change) {
  EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
  EXPECT_OK(sunder_simulation_step(w.simulation, nullptr));
  std::size_t length = 0;
  EXPECT_OK(sunder_simulation_store(w.simulation, nullptr, 0, &length));
  std::vector<std::uint8_t> bytes(length);
  EXPECT_OK(sunder_simulation_store(w.simulation, bytes.data(), length, &length));
  change(bytes);
  return sunder_simulation_load(w.simulation, bytes.data(), bytes.size());
}

constexpr std::int32_t kNode = 7;

}  // namespace

std::vector<Misuse> live_pointers() {
  return {
      {"grip_near_null", SUNDER_ERROR_NULL, "grip",
       [](World& w) {
         return sunder_simulation_grasp_near(w.simulation, w.values, 1, 0, nullptr);
       }},
      {"held_nodes_null", SUNDER_ERROR_NULL, "nodes",
       [](World& w) {
         std::int32_t grip = 0;
         std::size_t count = 0;
         EXPECT_OK(sunder_simulation_grasp(w.simulation, &kNode, 1, 0, &grip));
         return sunder_simulation_held_nodes(w.simulation, grip, nullptr, 1, &count);
       }},
      {"grip_place_null", SUNDER_ERROR_NULL, "position",
       [](World& w) { return sunder_simulation_grip_place(w.simulation, 1, nullptr); }},
      {"wrench_force_null", SUNDER_ERROR_NULL, "force",
       [](World& w) { return sunder_simulation_wrench(w.simulation, 1, nullptr, w.values); }},
      {"push_null", SUNDER_ERROR_NULL, "push",
       [](World& w) { return sunder_simulation_push(w.simulation, &kNode, 1, w.values, nullptr); }},
      {"pushed_null", SUNDER_ERROR_NULL, "nodes",
       [](World& w) {
         std::int32_t push = 0;
         return sunder_simulation_push(w.simulation, nullptr, 2, w.values, &push);
       }},
      {"moved_null", SUNDER_ERROR_NULL, "nodes",
       [](World& w) { return sunder_simulation_move(w.simulation, 1, nullptr, 2, w.values); }},
      {"moved_force_null", SUNDER_ERROR_NULL, "force",
       [](World& w) { return sunder_simulation_move(w.simulation, 1, &kNode, 1, nullptr); }},
      {"store_bytes_null", SUNDER_ERROR_NULL, "bytes",
       [](World& w) {
         EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
         std::size_t length = 0;
         return sunder_simulation_store(w.simulation, nullptr, 8, &length);
       }},
      {"triangles_null", SUNDER_ERROR_NULL, "triangles",
       [](World& w) {
         sunder_surface surface = SUNDER_SURFACE_INIT;
         std::size_t count = 0;
         EXPECT_OK(sunder_simulation_surface(w.simulation, &surface));
         return sunder_simulation_surface_changes(w.simulation, 0, nullptr, 99, &count);
       }},
      {"skin_places_null", SUNDER_ERROR_NULL, "places",
       [](World& w) {
         EXPECT_OK(sunder_simulation_set_skin(w.simulation, w.values, 3));
         return sunder_simulation_skin(w.simulation, nullptr, 3, nullptr);
       }},
      {"turn_null", SUNDER_ERROR_NULL, "turn",
       [](World& w) { return sunder_simulation_turn(w.simulation, 0, nullptr); }},
      {"velocity_null", SUNDER_ERROR_NULL, "values",
       [](World& w) { return sunder_simulation_velocity(w.simulation, nullptr, 150); }},
      {"given_velocity_null", SUNDER_ERROR_NULL, "values",
       [](World& w) { return sunder_simulation_set_velocity(w.simulation, nullptr, 150); }},
      {"stress_null", SUNDER_ERROR_NULL, "values",
       [](World& w) { return sunder_simulation_stress(w.simulation, nullptr, 576); }},
      {"reactions_null", SUNDER_ERROR_NULL, "values",
       [](World& w) { return sunder_simulation_reactions(w.simulation, nullptr, 3); }},
      {"body_parents_null", SUNDER_ERROR_NULL, "values",
       [](World& w) { return sunder_simulation_body_parents(w.simulation, nullptr, 50); }},
      {"tip_count_null", SUNDER_ERROR_NULL, "count",
       [](World& w) { return sunder_simulation_measure_tips(w.simulation, nullptr); }},
      {"lend_destroyed_to_nobody", SUNDER_ERROR_NULL, "values",
       [](World& w) {
         std::size_t size = 0;
         return sunder_simulation_lend_destroyed(w.simulation, nullptr, &size);
       }},
      {"gravity_null", SUNDER_ERROR_NULL, "gravity",
       [](World& w) { return sunder_scene_set_gravity(w.scene, nullptr); }},
      {"felt_hands_null", SUNDER_ERROR_NULL, "hands",
       [](World& w) {
         return with_grips(w, [](sunder_grips grips) {
           return sunder_grips_feel(grips, nullptr, nullptr, 0, nullptr, 2, nullptr);
         });
       }},
      {"frame_null", SUNDER_ERROR_NULL, "frame",
       [](World& w) {
         return with_frames(w, SUNDER_FRAME_STRESS, false, [](sunder_frames frames) {
           return sunder_frames_take(frames, nullptr);
         });
       }},
      {"frame_values_null", SUNDER_ERROR_NULL, "values",
       [](World& w) {
         return with_frames(w, SUNDER_FRAME_STRESS, true, [](sunder_frames frames) {
           return sunder_frames_stress(frames, nullptr, 576);
         });
       }},
      {"bodies_null", SUNDER_ERROR_NULL, "bodies",
       [](World&) { return sunder_bodies_create(1, nullptr); }},
      {"simulation_of_bodies_null", SUNDER_ERROR_NULL, "simulation",
       [](World& w) {
         return with_bodies([&](sunder_bodies bodies) {
           return sunder_simulation_create_of(w.scene, bodies, nullptr, nullptr);
         });
       }},
  };
}

std::vector<Misuse> live_counts() {
  return {
      {"removed_huge", SUNDER_ERROR_SIZE, "elements",
       [](World& w) {
         return with_huge(
             [&](std::size_t n) { return sunder_simulation_remove(w.simulation, &kNode, n); });
       }},
      {"prepared_huge", SUNDER_ERROR_SIZE, "elements",
       [](World& w) {
         return with_huge(
             [&](std::size_t n) { return sunder_simulation_prepare(w.simulation, &kNode, n); });
       }},
      {"swept_huge", SUNDER_ERROR_SIZE, "swept",
       [](World& w) {
         return with_huge([&](std::size_t n) {
           return sunder_simulation_cut(w.simulation, w.values, n, nullptr);
         });
       }},
      {"grasped_huge", SUNDER_ERROR_SIZE, "nodes",
       [](World& w) {
         std::int32_t grip = 0;
         return with_huge([&](std::size_t n) {
           return sunder_simulation_grasp(w.simulation, &kNode, n, 0, &grip);
         });
       }},
      {"pushed_huge", SUNDER_ERROR_SIZE, "nodes",
       [](World& w) {
         std::int32_t push = 0;
         return with_huge([&](std::size_t n) {
           return sunder_simulation_push(w.simulation, &kNode, n, w.values, &push);
         });
       }},
      {"moved_huge", SUNDER_ERROR_SIZE, "nodes",
       [](World& w) {
         std::int32_t push = 0;
         EXPECT_OK(sunder_simulation_push(w.simulation, &kNode, 1, w.values, &push));
         return with_huge([&](std::size_t n) {
           return sunder_simulation_move(w.simulation, push, &kNode, n, w.values);
         });
       }},
      {"vertices_huge", SUNDER_ERROR_SIZE, "vertices",
       [](World& w) {
         return with_huge(
             [&](std::size_t n) { return sunder_simulation_set_skin(w.simulation, w.values, n); });
       }},
      {"frames_nodes_huge", SUNDER_ERROR_SIZE, "nodes",
       [](World& w) {
         sunder_frames frames = nullptr;
         return with_huge([&](std::size_t n) {
           return sunder_frames_create(w.simulation, SUNDER_FRAME_DISPLACEMENT, &kNode, n, &frames);
         });
       }},
      {"felt_hands_huge", SUNDER_ERROR_SIZE, "hands",
       [](World& w) {
         return with_grips(w, [](sunder_grips grips) {
           sunder_hand hand = SUNDER_HAND_INIT;
           return with_huge([&](std::size_t n) {
             return sunder_grips_feel(grips, nullptr, nullptr, 0, &hand, n, nullptr);
           });
         });
       }},
      {"felt_forces_too_many", SUNDER_ERROR_SIZE, "must have 3",
       [](World& w) {
         return with_grips(w, [&](sunder_grips grips) {
           return sunder_grips_feel(grips, w.values, w.values, 8, nullptr, 0, nullptr);
         });
       }},
      {"velocity_too_short", SUNDER_ERROR_SIZE, "must have 150",
       [](World& w) { return sunder_simulation_velocity(w.simulation, w.values, 3); }},
      {"given_velocity_too_short", SUNDER_ERROR_SIZE, "must have 150",
       [](World& w) { return sunder_simulation_set_velocity(w.simulation, w.values, 3); }},
      {"store_too_short", SUNDER_ERROR_SIZE, "bytes has room for 8",
       [](World& w) {
         EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
         std::size_t length = 0;
         return sunder_simulation_store(w.simulation, w.values, 8, &length);
       }},
      {"held_nodes_too_short", SUNDER_ERROR_SIZE, "nodes has room for 1",
       [](World& w) {
         const std::int32_t nodes[] = {7, 8};
         std::int32_t grip = 0, held = -1;
         std::size_t count = 0;
         EXPECT_OK(sunder_simulation_grasp(w.simulation, nodes, 2, 0, &grip));
         const auto status = sunder_simulation_held_nodes(w.simulation, grip, &held, 1, &count);
         EXPECT_EQ(held, -1);
         EXPECT_EQ(count, 2U);
         return status;
       }},
      {"frame_values_too_short", SUNDER_ERROR_SIZE, "must have 150",
       [](World& w) {
         return with_frames(w, SUNDER_FRAME_DISPLACEMENT, true, [&](sunder_frames frames) {
           return sunder_frames_displacement(frames, w.values, 8);
         });
       }},
      {"frame_yield_ratio_too_short", SUNDER_ERROR_SIZE, "must have 96",
       [](World& w) {
         return with_frames(w, SUNDER_FRAME_YIELD_RATIO, true, [&](sunder_frames frames) {
           return sunder_frames_yield_ratio(frames, w.values, 8);
         });
       }},
      {"grasp_of_nothing", SUNDER_ERROR_ORDER, "no nodes",
       [](World& w) {
         std::int32_t grip = 0;
         return sunder_simulation_grasp(w.simulation, nullptr, 0, 0, &grip);
       }},
      {"move_to_nothing", SUNDER_ERROR_ORDER, "no nodes",
       [](World& w) {
         std::int32_t push = 0;
         EXPECT_OK(sunder_simulation_push(w.simulation, &kNode, 1, w.values, &push));
         return sunder_simulation_move(w.simulation, push, nullptr, 0, w.values);
       }},
      {"recording_of_no_bytes", SUNDER_ERROR_INPUT, "recording",
       [](World& w) {
         EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
         return sunder_simulation_load(w.simulation, w.values, 0);
       }},
      {"recording_cut_off", SUNDER_ERROR_INPUT, "recording",
       [](World& w) { return load_changed(w, [](auto& bytes) { bytes.pop_back(); }); }},
      {"recording_too_long", SUNDER_ERROR_INPUT, "recording",
       [](World& w) { return load_changed(w, [](auto& bytes) { bytes.push_back(0); }); }},
      {"recording_of_zeros", SUNDER_ERROR_INPUT, "recording",
       [](World& w) {
         return load_changed(w, [](auto& bytes) { std::fill(bytes.begin(), bytes.end(), 0); });
       }},
      {"bodies_fewer_than_none", SUNDER_ERROR_VALUE, "most is -1",
       [](World&) {
         sunder_bodies bodies = nullptr;
         return sunder_bodies_create(-1, &bodies);
       }},
  };
}

std::vector<Misuse> live_values() {
  return {
      {"turn_nan", SUNDER_ERROR_VALUE, "turn[0] = nan",
       [](World& w) {
         w.values[0] = kNaN;
         return sunder_simulation_turn(w.simulation, 0, w.values);
       }},
      {"turn_of_no_rigid_grip", SUNDER_ERROR_VALUE, "no rigid grip",
       [](World& w) { return sunder_simulation_turn(w.simulation, 0, w.values); }},
      {"step_within_infinite", SUNDER_ERROR_VALUE, "max_ms = inf",
       [](World& w) { return sunder_simulation_step_within(w.simulation, kInfinity, nullptr); }},
      {"step_by_in_statics", SUNDER_ERROR_ORDER, "motion",
       [](World& w) { return sunder_simulation_step_by(w.simulation, kNaN, nullptr); }},
      {"velocity_in_statics", SUNDER_ERROR_ORDER, "motion",
       [](World& w) {
         std::vector<double> values(150);
         return sunder_simulation_velocity(w.simulation, values.data(), values.size());
       }},
      {"velocity_lent_in_statics", SUNDER_ERROR_ORDER, "motion",
       [](World& w) {
         const double* at = w.values;
         std::size_t size = 5;
         const auto status =
             sunder_simulation_lend(w.simulation, SUNDER_FIELD_VELOCITY, &at, &size);
         EXPECT_TRUE(at == w.values && size == 5) << "both are left alone";
         return status;
       }},
      {"lend_a_field_below_none", SUNDER_ERROR_VALUE, "field -1",
       [](World& w) {
         const double* at = nullptr;
         std::size_t size = 0;
         return sunder_simulation_lend(w.simulation, -1, &at, &size);
       }},
      {"gravity_nan", SUNDER_ERROR_VALUE, "gravity[1] = nan",
       [](World& w) {
         w.values[1] = kNaN;
         return sunder_scene_set_gravity(w.scene, w.values);
       }},
      {"moved_nan", SUNDER_ERROR_VALUE, "force[0] = nan",
       [](World& w) {
         w.values[0] = kNaN;
         return sunder_simulation_move(w.simulation, 1, &kNode, 1, w.values);
       }},
      {"near_infinite", SUNDER_ERROR_VALUE, "near[2] = inf",
       [](World& w) {
         std::int32_t grip = 0;
         w.values[2] = kInfinity;
         return sunder_simulation_grasp_near(w.simulation, w.values, 1, 0, &grip);
       }},
      {"radius_negative", SUNDER_ERROR_VALUE, "radius = -1",
       [](World& w) {
         std::int32_t grip = 0;
         return sunder_simulation_grasp_near(w.simulation, w.values, -1, 0, &grip);
       }},
      {"prepared_near_infinite", SUNDER_ERROR_VALUE, "near[2] = inf",
       [](World& w) {
         w.values[2] = kInfinity;
         return sunder_simulation_prepare_near(w.simulation, w.values, 1, nullptr);
       }},
      {"prepared_radius_negative", SUNDER_ERROR_VALUE, "radius = -1",
       [](World& w) {
         return sunder_simulation_prepare_near(w.simulation, w.values, -1, nullptr);
       }},
      {"undo_negative", SUNDER_ERROR_VALUE, "actions = -1",
       [](World& w) { return sunder_simulation_undo(w.simulation, -1, nullptr, nullptr); }},
      {"redo_none", SUNDER_ERROR_VALUE, "actions = 0",
       [](World& w) { return sunder_simulation_redo(w.simulation, 0, nullptr); }},
      {"undo_more_than_there_can_be", SUNDER_ERROR_ORDER, "there are 0",
       [](World& w) {
         EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
         return sunder_simulation_undo(w.simulation, INT32_MAX, nullptr, nullptr);
       }},
      {"redo_more_than_there_can_be", SUNDER_ERROR_ORDER, "there are 0",
       [](World& w) {
         EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
         return sunder_simulation_redo(w.simulation, INT32_MAX, nullptr);
       }},
      {"redo_without_history", SUNDER_ERROR_ORDER, "keeps no history",
       [](World& w) { return sunder_simulation_redo(w.simulation, 1, nullptr); }},
      {"store_without_history", SUNDER_ERROR_ORDER, "keeps no history",
       [](World& w) {
         std::size_t length = 0;
         return sunder_simulation_store(w.simulation, nullptr, 0, &length);
       }},
      {"load_without_history", SUNDER_ERROR_ORDER, "keeps no history",
       [](World& w) { return sunder_simulation_load(w.simulation, w.values, 8); }},
      {"mark_negative", SUNDER_ERROR_VALUE, "mark -1",
       [](World& w) { return sunder_simulation_restore(w.simulation, -1, nullptr); }},
      {"forget_unknown", SUNDER_ERROR_VALUE, "mark 0",
       [](World& w) { return sunder_simulation_forget(w.simulation, 0); }},
      {"restore_forgotten", SUNDER_ERROR_VALUE, "mark 1",
       [](World& w) {
         std::int32_t mark = 0;
         EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
         EXPECT_OK(sunder_simulation_save(w.simulation, &mark));
         EXPECT_OK(sunder_simulation_forget(w.simulation, mark));
         return sunder_simulation_restore(w.simulation, mark, nullptr);
       }},
      {"remove_below_none", SUNDER_ERROR_ORDER, "element -1",
       [](World& w) {
         const std::int32_t element = -1;
         return sunder_simulation_remove(w.simulation, &element, 1);
       }},
      {"prepare_below_none", SUNDER_ERROR_ORDER, "element -1",
       [](World& w) {
         const std::int32_t element = -1;
         return sunder_simulation_prepare(w.simulation, &element, 1);
       }},
      {"grasp_below_none", SUNDER_ERROR_ORDER, "node -1",
       [](World& w) {
         const std::int32_t node = -1;
         std::int32_t grip = 0;
         return sunder_simulation_grasp(w.simulation, &node, 1, 0, &grip);
       }},
      {"push_below_none", SUNDER_ERROR_ORDER, "node -2147483648",
       [](World& w) {
         const std::int32_t node = INT32_MIN;
         std::int32_t push = 0;
         return sunder_simulation_push(w.simulation, &node, 1, w.values, &push);
       }},
      {"held_nodes_of_none", SUNDER_ERROR_ORDER, "there is no grip",
       [](World& w) {
         std::size_t count = 0;
         return sunder_simulation_held_nodes(w.simulation, INT32_MAX, nullptr, 0, &count);
       }},
      {"place_of_none", SUNDER_ERROR_ORDER, "there is no grip",
       [](World& w) { return sunder_simulation_grip_place(w.simulation, INT32_MIN, w.values); }},
      {"move_of_none", SUNDER_ERROR_ORDER, "there is no push",
       [](World& w) { return sunder_simulation_move(w.simulation, 1, &kNode, 1, w.values); }},
      {"frame_not_taken", SUNDER_ERROR_ORDER, "no frame was taken",
       [](World& w) {
         return with_frames(w, SUNDER_FRAME_STRESS, false, [&](sunder_frames frames) {
           return sunder_frames_stress(frames, w.values, 8);
         });
       }},
      {"frame_without_destroyed", SUNDER_ERROR_ORDER, "made without",
       [](World& w) {
         return with_frames(w, SUNDER_FRAME_STRESS, true, [](sunder_frames frames) {
           std::uint8_t byte = 0;
           return sunder_frames_destroyed(frames, &byte, 1);
         });
       }},
      {"frames_of_a_node_below_none", SUNDER_ERROR_VALUE, "nodes -1",
       [](World& w) {
         const std::int32_t node = -1;
         sunder_frames frames = nullptr;
         return sunder_frames_create(w.simulation, SUNDER_FRAME_DISPLACEMENT, &node, 1, &frames);
       }},
      {"bodies_on_another_backend", SUNDER_ERROR_DEVICE, "",
       [](World& w) {
         const auto solver = on(SUNDER_BACKEND_VULKAN);
         EXPECT_OK(sunder_scene_set_solver(w.scene, &solver));
         return with_bodies([&](sunder_bodies bodies) {
           return sunder_simulation_create_of(w.scene, bodies, nullptr, &w.made);
         });
       }},
      {"callbacks_of_bodies_size_unset", SUNDER_ERROR_STRUCT_SIZE, "callbacks",
       [](World& w) {
         return with_bodies([&](sunder_bodies bodies) {
           const sunder_callbacks callbacks{};
           return sunder_simulation_create_of(w.scene, bodies, &callbacks, &w.made);
         });
       }},
      {"dynamics_size_unset", SUNDER_ERROR_STRUCT_SIZE, "dynamics",
       [](World& w) {
         const sunder_dynamics dynamics{};
         return sunder_scene_set_dynamics(w.scene, &dynamics);
       }},
      {"time_step_nan", SUNDER_ERROR_VALUE, "time_step = nan",
       [](World& w) {
         sunder_dynamics dynamics = SUNDER_DYNAMICS_INIT;
         dynamics.time_step = kNaN;
         return sunder_scene_set_dynamics(w.scene, &dynamics);
       }},
  };
}

}  // namespace sunder::test
