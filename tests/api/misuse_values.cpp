// SPDX-License-Identifier: Apache-2.0
// Calls whose values are wrong, or that come at the wrong time.
#include "api/misuse.hpp"

namespace sunder::test {

std::vector<Misuse> values() {
  return {
      {"axes_none", SUNDER_ERROR_VALUE, "axes = 0",
       [](World& w) { return w.add_support([](sunder_support& s) { s.axes = 0; }); }},
      {"axes_unknown", SUNDER_ERROR_VALUE, "axes = 8",
       [](World& w) { return w.add_support([](sunder_support& s) { s.axes = 8; }); }},
      {"selection_unknown", SUNDER_ERROR_VALUE, "selection kind",
       [](World& w) { return w.add_support([](sunder_support& s) { s.nodes.kind = 4; }); }},
      {"ball_of_elements", SUNDER_ERROR_VALUE, "selection kind",
       [](World& w) {
         sunder_selection s{};
         s.kind = SUNDER_SELECT_BALL;
         return sunder_scene_add_removal(w.scene, 0, &s);
       }},
      {"faces_of_elements", SUNDER_ERROR_VALUE, "selection kind",
       [](World& w) {
         sunder_selection s{};
         s.kind = SUNDER_SELECT_FACES;
         return sunder_scene_add_removal(w.scene, 0, &s);
       }},
      {"faces_that_name_no_node", SUNDER_ERROR_INPUT, "names node 5000",
       [](World& w) {
         static constexpr std::int32_t kIds[] = {0, 1, 5000};
         return w.create_with([&] {
           return w.add_support(
               [](sunder_support& s) { s.nodes = {SUNDER_SELECT_FACES, 0, kIds, 3, {}, {}, 0}; });
         });
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
      {"interface_index", SUNDER_ERROR_VALUE, "interface 0 does not exist",
       [](World& w) {
         sunder_interface state = SUNDER_INTERFACE_INIT;
         return sunder_simulation_interface_at(w.simulation, 0, &state);
       }},
      {"interface_of_no_material", SUNDER_ERROR_VALUE, "material 1 does not exist",
       [](World& w) { return sunder_scene_add_interface(w.scene, 0, 1, 1, 1, 1); }},
      {"warning_index", SUNDER_ERROR_VALUE, "warning 99",
       [](World& w) {
         return sunder_simulation_warning_at(w.simulation, 99, nullptr, 0, nullptr);
       }},
      {"tip_index", SUNDER_ERROR_VALUE, "tip 0 does not exist",
       [](World& w) {
         sunder_tip tip = SUNDER_TIP_INIT;
         return sunder_simulation_tip_at(w.simulation, 0, &tip);
       }},
      {"preset_index", SUNDER_ERROR_VALUE, "preset -1",
       [](World&) { return sunder_preset_at(-1, nullptr, 0, nullptr); }},
      {"preset_unknown", SUNDER_ERROR_VALUE, "preset is \"liver\"; allowed: \"aortic-media-axial\"",
       [](World&) {
         sunder_material material = SUNDER_MATERIAL_INIT;
         return sunder_material_preset("liver", &material);
       }},
      {"toughness_infinite", SUNDER_ERROR_VALUE, "toughness",
       [](World& w) {
         sunder_material material = SUNDER_MATERIAL_INIT;
         material.young = 5;
         material.toughness = INFINITY;
         return sunder_scene_add_material(w.scene, &material, nullptr);
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
      {"frames_of_no_field", SUNDER_ERROR_VALUE, "fields = 0",
       [](World& w) {
         sunder_frames frames = nullptr;
         return sunder_frames_create(w.simulation, 0, nullptr, 0, &frames);
       }},
      {"frames_of_a_new_field", SUNDER_ERROR_VALUE, "fields = 17",
       [](World& w) {
         sunder_frames frames = nullptr;
         return sunder_frames_create(w.simulation, 17, nullptr, 0, &frames);
       }},
      {"frames_of_a_node_that_is_not_there", SUNDER_ERROR_VALUE, "nodes 5000",
       [](World& w) {
         sunder_frames frames = nullptr;
         const std::int32_t node = 5000;
         return sunder_frames_create(w.simulation, SUNDER_FRAME_DISPLACEMENT, &node, 1, &frames);
       }},
      {"undo_without_history", SUNDER_ERROR_ORDER, "keeps no history",
       [](World& w) { return sunder_simulation_undo(w.simulation, 1, nullptr, nullptr); }},
      {"save_without_history", SUNDER_ERROR_ORDER, "keeps no history",
       [](World& w) {
         std::int32_t mark = 0;
         return sunder_simulation_save(w.simulation, &mark);
       }},
      {"history_late", SUNDER_ERROR_ORDER, "before the first step",
       [](World& w) {
         EXPECT_OK(sunder_simulation_step(w.simulation, nullptr));
         return sunder_simulation_keep_history(w.simulation, 1);
       }},
      {"history_twice", SUNDER_ERROR_ORDER, "already",
       [](World& w) {
         EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
         return sunder_simulation_keep_history(w.simulation, 1);
       }},
      {"nothing_to_undo", SUNDER_ERROR_ORDER, "there are 0",
       [](World& w) {
         EXPECT_OK(sunder_simulation_keep_history(w.simulation, 1));
         return sunder_simulation_undo(w.simulation, 1, nullptr, nullptr);
       }},
      {"remove_beyond", SUNDER_ERROR_ORDER, "element 96",
       [](World& w) {
         const std::int32_t element = 96;
         return sunder_simulation_remove(w.simulation, &element, 1);
       }},
      {"prepare_beyond", SUNDER_ERROR_ORDER, "element 96 cannot be prepared for",
       [](World& w) {
         const std::int32_t element = 96;
         return sunder_simulation_prepare(w.simulation, &element, 1);
       }},
      {"remove_twice", SUNDER_ERROR_ORDER, "named twice",
       [](World& w) {
         const std::int32_t elements[] = {4, 4};
         return sunder_simulation_remove(w.simulation, elements, 2);
       }},
      {"grasp_of_a_node_beyond", SUNDER_ERROR_ORDER, "node 50 cannot be grasped",
       [](World& w) {
         const std::int32_t node = 50;
         std::int32_t grip = 0;
         return sunder_simulation_grasp(w.simulation, &node, 1, 0, &grip);
       }},
      {"pose_of_none", SUNDER_ERROR_ORDER, "there is no grip 1",
       [](World& w) { return sunder_simulation_pose(w.simulation, 1, w.values, nullptr); }},
      {"release_of_an_instrument", SUNDER_ERROR_ORDER, "instrument 0 cannot let go",
       [](World& w) { return sunder_simulation_release(w.simulation, 0); }},
      {"wrench_of_none", SUNDER_ERROR_ORDER, "there is no grip -1",
       [](World& w) { return sunder_simulation_wrench(w.simulation, -1, w.values, w.values + 3); }},
      {"drop_of_none", SUNDER_ERROR_ORDER, "there is no push 9",
       [](World& w) { return sunder_simulation_drop(w.simulation, 9); }},
      {"push_of_a_node_beyond", SUNDER_ERROR_ORDER, "node 50 cannot be pushed",
       [](World& w) {
         const std::int32_t node = 50;
         std::int32_t push = 0;
         return sunder_simulation_push(w.simulation, &node, 1, w.values, &push);
       }},
      {"push_of_nothing", SUNDER_ERROR_ORDER, "no nodes",
       [](World& w) {
         std::int32_t push = 0;
         return sunder_simulation_push(w.simulation, nullptr, 0, w.values, &push);
       }},
      {"skin_without_one", SUNDER_ERROR_ORDER, "no skin",
       [](World& w) {
         float places[3];
         return sunder_simulation_skin(w.simulation, places, 3, nullptr);
       }},
      {"points_before_the_surface", SUNDER_ERROR_ORDER, "surface",
       [](World& w) {
         return sunder_simulation_surface_points(w.simulation, nullptr, nullptr, 150);
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
      {"max_ms_nan", SUNDER_ERROR_VALUE, "max_ms = nan",
       [](World& w) { return w.set_solver([](sunder_solver_options& s) { s.max_ms = kNaN; }); }},
      {"step_within_nan", SUNDER_ERROR_VALUE, "max_ms = nan",
       [](World& w) { return sunder_simulation_step_within(w.simulation, kNaN, nullptr); }},
      {"step_within_negative", SUNDER_ERROR_VALUE, "max_ms = -1",
       [](World& w) { return sunder_simulation_step_within(w.simulation, -1, nullptr); }},
      {"history_negative", SUNDER_ERROR_VALUE, "quick = -1",
       [](World& w) { return sunder_simulation_keep_history(w.simulation, -1); }},
      {"undo_none", SUNDER_ERROR_VALUE, "actions = 0",
       [](World& w) { return sunder_simulation_undo(w.simulation, 0, nullptr, nullptr); }},
      {"mark_unknown", SUNDER_ERROR_VALUE, "mark 3",
       [](World& w) { return sunder_simulation_restore(w.simulation, 3, nullptr); }},
      {"swept_nan", SUNDER_ERROR_VALUE, "swept[2] = nan",
       [](World& w) {
         double swept[9] = {0, 1, kNaN};
         return sunder_simulation_cut(w.simulation, swept, 9, nullptr);
       }},
      {"near_nan", SUNDER_ERROR_VALUE, "near[1] = nan",
       [](World& w) {
         const double near[3] = {0, kNaN, 0};
         std::int32_t grip = 0;
         return sunder_simulation_grasp_near(w.simulation, near, 1, 0, &grip);
       }},
      {"radius_zero", SUNDER_ERROR_VALUE, "radius = 0",
       [](World& w) {
         std::int32_t grip = 0;
         return sunder_simulation_grasp_near(w.simulation, w.values, 0, 0, &grip);
       }},
      {"radius_nan", SUNDER_ERROR_VALUE, "radius = nan",
       [](World& w) {
         std::int32_t grip = 0;
         return sunder_simulation_grasp_near(w.simulation, w.values, kNaN, 0, &grip);
       }},
      {"prepared_near_nan", SUNDER_ERROR_VALUE, "near[1] = nan",
       [](World& w) {
         const double near[3] = {0, kNaN, 0};
         return sunder_simulation_prepare_near(w.simulation, near, 1, nullptr);
       }},
      {"prepared_radius_zero", SUNDER_ERROR_VALUE, "radius = 0",
       [](World& w) { return sunder_simulation_prepare_near(w.simulation, w.values, 0, nullptr); }},
      {"rigid_as_no_word", SUNDER_ERROR_VALUE, "rigid = 2",
       [](World& w) {
         const std::int32_t node = 7;
         std::int32_t grip = 0;
         return sunder_simulation_grasp(w.simulation, &node, 1, 2, &grip);
       }},
      {"pose_infinite", SUNDER_ERROR_VALUE, "position[0] = inf",
       [](World& w) {
         const double place[3] = {kInfinity, 0, 0};
         return sunder_simulation_pose(w.simulation, 1, place, nullptr);
       }},
      {"quaternion_nan", SUNDER_ERROR_VALUE, "quaternion[3] = nan",
       [](World& w) {
         const double turn[4] = {0, 0, 0, kNaN};
         return sunder_simulation_pose(w.simulation, 1, w.values, turn);
       }},
      {"quaternion_of_no_length", SUNDER_ERROR_VALUE, "length 0",
       [](World& w) { return sunder_simulation_pose(w.simulation, 1, w.values, w.values + 3); }},
      {"push_nan", SUNDER_ERROR_VALUE, "force[2] = nan",
       [](World& w) {
         const std::int32_t node = 7;
         const double force[3] = {0, 0, kNaN};
         std::int32_t push = 0;
         return sunder_simulation_push(w.simulation, &node, 1, force, &push);
       }},
      {"vertices_nan", SUNDER_ERROR_VALUE, "vertices[0] = nan",
       [](World& w) {
         const double vertices[3] = {kNaN, 0, 0};
         return sunder_simulation_set_skin(w.simulation, vertices, 3);
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

}  // namespace sunder::test
