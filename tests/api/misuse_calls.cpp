// SPDX-License-Identifier: Apache-2.0
// Calls that are wrong by themselves: handles, pointers, sizes.
#include "api/misuse.hpp"

namespace sunder::test {

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
      {"frames_null", SUNDER_ERROR_HANDLE, "frames",
       [](World& w) { return sunder_frames_displacement(nullptr, w.values, 3); }},
      {"simulation_for_frames", SUNDER_ERROR_HANDLE, "frames",
       [](World& w) {
         return sunder_frames_destroy(reinterpret_cast<sunder_frames>(w.simulation));
       }},
      {"body_of_a_scene", SUNDER_ERROR_HANDLE, "simulation",
       [](World& w) {
         sunder_body body = SUNDER_BODY_INIT;
         return sunder_simulation_body(reinterpret_cast<sunder_simulation>(w.scene), &body);
       }},
      {"simulation_for_grips", SUNDER_ERROR_HANDLE, "grips",
       [](World& w) { return sunder_grips_destroy(reinterpret_cast<sunder_grips>(w.simulation)); }},
      {"release_null", SUNDER_ERROR_HANDLE, "simulation",
       [](World&) { return sunder_simulation_release(nullptr, 1); }},
      {"undo_null", SUNDER_ERROR_HANDLE, "simulation",
       [](World&) { return sunder_simulation_undo(nullptr, 1, nullptr, nullptr); }},
      {"surface_of_a_scene", SUNDER_ERROR_HANDLE, "simulation",
       [](World& w) {
         sunder_surface surface = SUNDER_SURFACE_INIT;
         return sunder_simulation_surface(reinterpret_cast<sunder_simulation>(w.scene), &surface);
       }},
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
      {"fibres_null", SUNDER_ERROR_NULL, "fibres",
       [](World& w) { return sunder_scene_add_fibres(w.scene, 0, nullptr); }},
      {"interface_count_null", SUNDER_ERROR_NULL, "count",
       [](World& w) { return sunder_simulation_interface_count(w.simulation, nullptr); }},
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
      {"body_null", SUNDER_ERROR_NULL, "body",
       [](World& w) { return sunder_simulation_body(w.simulation, nullptr); }},
      {"body_nodes_null", SUNDER_ERROR_NULL, "values",
       [](World& w) { return sunder_simulation_body_nodes(w.simulation, nullptr, 150); }},
      {"body_corners_null", SUNDER_ERROR_NULL, "values",
       [](World& w) { return sunder_simulation_body_corners(w.simulation, nullptr, 384); }},
      {"body_displacement_null", SUNDER_ERROR_NULL, "values",
       [](World& w) { return sunder_simulation_body_displacement(w.simulation, nullptr, 150); }},
      {"removed_null", SUNDER_ERROR_NULL, "elements",
       [](World& w) { return sunder_simulation_remove(w.simulation, nullptr, 3); }},
      {"prepared_null", SUNDER_ERROR_NULL, "elements",
       [](World& w) { return sunder_simulation_prepare(w.simulation, nullptr, 3); }},
      {"prepared_near_null", SUNDER_ERROR_NULL, "near",
       [](World& w) { return sunder_simulation_prepare_near(w.simulation, nullptr, 1, nullptr); }},
      {"swept_null", SUNDER_ERROR_NULL, "swept",
       [](World& w) { return sunder_simulation_cut(w.simulation, nullptr, 9, nullptr); }},
      {"grip_null", SUNDER_ERROR_NULL, "grip",
       [](World& w) {
         const std::int32_t node = 7;
         return sunder_simulation_grasp(w.simulation, &node, 1, 0, nullptr);
       }},
      {"grasped_null", SUNDER_ERROR_NULL, "nodes",
       [](World& w) {
         std::int32_t grip = 0;
         return sunder_simulation_grasp(w.simulation, nullptr, 1, 0, &grip);
       }},
      {"near_null", SUNDER_ERROR_NULL, "near",
       [](World& w) {
         std::int32_t grip = 0;
         return sunder_simulation_grasp_near(w.simulation, nullptr, 1, 0, &grip);
       }},
      {"pose_null", SUNDER_ERROR_NULL, "position",
       [](World& w) { return sunder_simulation_pose(w.simulation, 1, nullptr, nullptr); }},
      {"wrench_null", SUNDER_ERROR_NULL, "torque",
       [](World& w) { return sunder_simulation_wrench(w.simulation, 1, w.values, nullptr); }},
      {"push_force_null", SUNDER_ERROR_NULL, "force",
       [](World& w) {
         const std::int32_t node = 7;
         std::int32_t push = 0;
         return sunder_simulation_push(w.simulation, &node, 1, nullptr, &push);
       }},
      {"held_count_null", SUNDER_ERROR_NULL, "count",
       [](World& w) { return sunder_simulation_held_nodes(w.simulation, 1, nullptr, 0, nullptr); }},
      {"mark_null", SUNDER_ERROR_NULL, "mark",
       [](World& w) { return sunder_simulation_save(w.simulation, nullptr); }},
      {"store_length_null", SUNDER_ERROR_NULL, "length",
       [](World& w) { return sunder_simulation_store(w.simulation, nullptr, 0, nullptr); }},
      {"load_null", SUNDER_ERROR_NULL, "bytes",
       [](World& w) { return sunder_simulation_load(w.simulation, nullptr, 9); }},
      {"surface_null", SUNDER_ERROR_NULL, "surface",
       [](World& w) { return sunder_simulation_surface(w.simulation, nullptr); }},
      {"surface_changes_null", SUNDER_ERROR_NULL, "count",
       [](World& w) {
         return sunder_simulation_surface_changes(w.simulation, 0, nullptr, 0, nullptr);
       }},
      {"skin_vertices_null", SUNDER_ERROR_NULL, "vertices",
       [](World& w) { return sunder_simulation_set_skin(w.simulation, nullptr, 3); }},
      {"warning_count_null", SUNDER_ERROR_NULL, "count",
       [](World& w) { return sunder_simulation_warning_count(w.simulation, nullptr); }},
      {"crack_count_null", SUNDER_ERROR_NULL, "count",
       [](World& w) { return sunder_simulation_crack_count(w.simulation, nullptr); }},
      {"drive_null", SUNDER_ERROR_NULL, "value",
       [](World& w) { return sunder_simulation_drive(w.simulation, 0, nullptr); }},
      {"frames_create_null", SUNDER_ERROR_NULL, "frames",
       [](World& w) {
         return sunder_frames_create(w.simulation, SUNDER_FRAME_DESTROYED, nullptr, 0, nullptr);
       }},
      {"frames_nodes_null", SUNDER_ERROR_NULL, "nodes",
       [](World& w) {
         sunder_frames frames = nullptr;
         return sunder_frames_create(w.simulation, SUNDER_FRAME_DISPLACEMENT, nullptr, 2, &frames);
       }},
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
      {"swept_not_triangles", SUNDER_ERROR_SIZE, "swept has 8",
       [](World& w) { return sunder_simulation_cut(w.simulation, w.values, 8, nullptr); }},
      {"vertices_not_triples", SUNDER_ERROR_SIZE, "vertices has 7",
       [](World& w) { return sunder_simulation_set_skin(w.simulation, w.values, 7); }},
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
      {"faces_not_triples", SUNDER_ERROR_SIZE, "id_count = 4; it must be 3 for each face",
       [](World& w) {
         const std::int32_t ids[] = {0, 1, 5, 6};
         return w.add_support(
             [&](sunder_support& s) { s.nodes = {SUNDER_SELECT_FACES, 0, ids, 4, {}, {}, 0}; });
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
      {"no_bodies", SUNDER_ERROR_VALUE, "most is 0; allowed is 1 or more",
       [](World&) {
         sunder_bodies bodies = nullptr;
         return sunder_bodies_create(0, &bodies);
       }},
      {"simulation_of_no_bodies", SUNDER_ERROR_HANDLE, "set of bodies",
       [](World& w) { return sunder_simulation_create_of(w.scene, nullptr, nullptr, &w.made); }},
      {"lend_no_such_field", SUNDER_ERROR_VALUE, "field 5 does not exist",
       [](World& w) {
         const double* at = nullptr;
         std::size_t size = 0;
         return sunder_simulation_lend(w.simulation, 5, &at, &size);
       }},
      {"lend_to_nobody", SUNDER_ERROR_NULL, "values is null",
       [](World& w) {
         std::size_t size = 0;
         return sunder_simulation_lend(w.simulation, SUNDER_FIELD_STRESS, nullptr, &size);
       }},
      {"lend_without_a_size", SUNDER_ERROR_NULL, "size is null",
       [](World& w) {
         const std::uint8_t* at = nullptr;
         return sunder_simulation_lend_destroyed(w.simulation, &at, nullptr);
       }},
      {"reactions_too_short", SUNDER_ERROR_SIZE, "must have 3",
       [](World& w) { return sunder_simulation_reactions(w.simulation, w.values, 2); }},
      {"support_reaction_too_long", SUNDER_ERROR_SIZE, "must have 3",
       [](World& w) { return sunder_simulation_support_reaction(w.simulation, w.values, 8); }},
      {"body_nodes_too_short", SUNDER_ERROR_SIZE, "must have 150",
       [](World& w) { return sunder_simulation_body_nodes(w.simulation, w.values, 3); }},
      {"body_corners_too_short", SUNDER_ERROR_SIZE, "must have 384",
       [](World& w) {
         std::int32_t id = 0;
         return sunder_simulation_body_corners(w.simulation, &id, 1);
       }},
      {"body_parents_too_short", SUNDER_ERROR_SIZE, "must have 50",
       [](World& w) {
         std::int32_t id = 0;
         return sunder_simulation_body_parents(w.simulation, &id, 1);
       }},
      {"body_displacement_too_short", SUNDER_ERROR_SIZE, "must have 150",
       [](World& w) { return sunder_simulation_body_displacement(w.simulation, w.values, 3); }},
      {"crack_faces_where_none_is_open", SUNDER_ERROR_SIZE, "must have 0",
       [](World& w) {
         std::int32_t ids[7] = {};
         return sunder_simulation_crack_faces(w.simulation, ids, 7);
       }},
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
      {"body_size_unset", SUNDER_ERROR_STRUCT_SIZE, "body has struct_size = 0",
       [](World& w) {
         sunder_body body{};
         return sunder_simulation_body(w.simulation, &body);
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

}  // namespace sunder::test
