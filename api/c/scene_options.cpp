// SPDX-License-Identifier: Apache-2.0
#include "c/names.hpp"
#include "c/scene.hpp"
#include "c/scene_words.hpp"
#include "c/structs.hpp"

namespace {

using namespace sunder::c;

sunder_fracture_options fracture_defaults() {
  const sunder::FractureOptions defaults;
  auto options = sized<sunder_fracture_options>();
  options.alpha = defaults.alpha;
  options.max_events = defaults.max_events;
  options.averaging = defaults.averaging;
  return options;
}

sunder_solver_options solver_defaults() {
  const sunder::SolverOptions defaults;
  auto options = sized<sunder_solver_options>();
  options.device = defaults.device;
  options.tolerance = defaults.tolerance;
  return options;
}

sunder::FractureOptions to_fracture(const sunder_fracture_options& given) {
  sunder::FractureOptions f;
  f.model = word<sunder::FractureModel>(given.model, "fracture", "model", "fracture model");
  require_finite(given.alpha, "alpha");
  f.alpha = given.alpha;
  f.yield_measure = word<sunder::YieldMeasure>(given.yield_measure, "fracture", "yield_measure");
  f.sigma0 = word<sunder::RemoteStress>(given.sigma0, "fracture", "sigma0");
  f.crack_length = word<sunder::CrackLength>(given.crack_length, "fracture", "crack_length");
  f.birth = word<sunder::CrackBirth>(given.birth, "fracture", "birth");
  f.sif = word<sunder::SifSource>(given.sif, "fracture", "sif");
  f.max_events = given.max_events;
  require_finite(given.averaging, "averaging");
  f.averaging = given.averaging;
  f.crack = word<sunder::CrackWay>(given.crack, "fracture", "crack");
  f.max_new_nodes = given.max_new_nodes;
  f.contact = given.contact != 0;
  f.stress = word<sunder::StressMeasure>(given.stress, "fracture", "stress");
  if (given.has_plane_normal) {
    require_finite(given.plane_normal, 3, "plane_normal");
    f.plane_normal = sunder::Vec3(given.plane_normal);
  }
  return f;
}

sunder::SolverOptions to_solver(const sunder_solver_options& given) {
  sunder::SolverOptions s;
  s.backend = backend_name(choice<sunder_backend>(given.backend, 3, "backend"));
  if (given.device < -1) {
    throw Failure(SUNDER_ERROR_VALUE, "device = " + std::to_string(given.device) +
                                          " is neither an index nor -1 (let the library choose)");
  }
  s.device = given.device;
  s.route = word<sunder::Route>(given.route, "solver", "route");
  s.update = word<sunder::Update>(given.update, "solver", "update");
  s.precision = word<sunder::Precision>(given.precision, "solver", "precision");
  require_finite(given.tolerance, "tolerance");
  s.tolerance = given.tolerance;
  s.prepare = given.no_preparation == 0;
  return s;
}

sunder::Dynamics to_dynamics(const sunder_dynamics& given) {
  sunder::Dynamics d;
  d.time_step = given.time_step;
  d.mass_damping = given.mass_damping;
  d.stiffness_damping = given.stiffness_damping;
  d.max_iterations = given.max_iterations;
  d.felt_inertia = given.felt_inertia != 0;
  require_finite(given.time_step, "time_step");
  require_finite(given.mass_damping, "mass_damping");
  require_finite(given.stiffness_damping, "stiffness_damping");
  return d;
}

}  // namespace

extern "C" {

void sunder_fracture_options_init(sunder_fracture_options* options) {
  if (options) *options = fracture_defaults();
}

sunder_status sunder_scene_set_fracture(sunder_scene scene,
                                        const sunder_fracture_options* options) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    const auto given = read_struct(options, fracture_defaults(), "fracture options");
    object.scene.fracture = to_fracture(given);
    object.attribution = given.attribution != 0;
  });
}

void sunder_solver_options_init(sunder_solver_options* options) {
  if (options) *options = solver_defaults();
}

sunder_status sunder_scene_set_solver(sunder_scene scene, const sunder_solver_options* options) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    object.scene.solver = to_solver(read_struct(options, solver_defaults(), "solver options"));
  });
}

sunder_status sunder_scene_set_steps(sunder_scene scene, int32_t steps) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    if (steps < 1) {
      throw Failure(SUNDER_ERROR_VALUE, "steps = " + std::to_string(steps) + " is below 1");
    }
    object.scene.steps = steps;
  });
}

sunder_status sunder_scene_set_gravity(sunder_scene scene, const double gravity[3]) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    require(gravity, "gravity");
    require_finite(gravity, 3, "gravity");
    object.scene.gravity = sunder::Vec3(gravity);
  });
}

void sunder_dynamics_init(sunder_dynamics* dynamics) {
  if (dynamics) *dynamics = sized<sunder_dynamics>();
}

sunder_status sunder_scene_set_dynamics(sunder_scene scene, const sunder_dynamics* dynamics) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    object.scene.dynamics.reset();
    if (!dynamics) return;
    object.scene.dynamics =
        to_dynamics(read_struct(dynamics, sized<sunder_dynamics>(), "dynamics"));
  });
}

sunder_status sunder_scene_set_stress(sunder_scene scene, int32_t wanted) {
  return call<SceneObject>(scene,
                           [&](SceneObject& object) { object.scene.output.stress = wanted != 0; });
}

}  // extern "C"
