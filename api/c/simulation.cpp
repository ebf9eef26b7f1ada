// SPDX-License-Identifier: Apache-2.0
// Create, step, drive, cancel.
#include "c/simulation.hpp"

#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "c/engine.hpp"
#include "c/simulation_create.hpp"

namespace {

using namespace sunder::c;

/// How long destroying waits for what is going on: it returns within 50 ms.
constexpr std::chrono::milliseconds kPatience{30};
/// Unknowns of a body of which nothing that goes on takes long enough for a thread to let it go.
constexpr sunder::Index kQuick = 300;

sunder_step to_step(const sunder::StepReport& report) {
  auto step = sized<sunder_step>();
  step.step = report.step;
  step.load_factor = report.load_factor;
  step.events = report.events;
  step.destroyed = report.destroyed;
  step.iterations = report.iterations;
  step.back_solves = report.back_solves;
  step.unfinished = report.unfinished ? 1 : 0;
  step.polished = report.polished ? 1 : 0;
  step.compliance = report.compliance;
  step.residual = report.residual;
  step.error = report.error;
  step.max_yield_ratio = report.max_yield_ratio;
  step.ms_load = report.times.load;
  step.ms_solve = report.times.solve;
  step.ms_stress = report.times.stress;
  step.ms_decide = report.times.decide;
  step.ms_update = report.times.update;
  step.ms_total = report.times.total;
  if (report.deformation) {
    step.measured = 1;
    step.strain_max = report.deformation->strain;
    step.rotation_max_deg = report.deformation->rotation_deg;
    step.inverted = report.deformation->inverted;
  }
  step.capped = report.capped ? 1 : 0;
  step.out_of_time = report.out_of_time ? 1 : 0;
  step.new_bases = report.new_bases.count;
  step.ms_new_bases = report.new_bases.waited_ms;
  if (report.motion) {
    step.moves = 1;
    step.time = report.motion->time;
    step.kinetic = report.motion->kinetic;
    step.strain_energy = report.motion->strain_energy;
    step.work = report.motion->work;
    step.dissipated = report.motion->dissipated();
    for (int axis = 0; axis < 3; ++axis) {
      step.momentum[axis] = report.motion->momentum[axis];
      step.angular_momentum[axis] = report.motion->angular_momentum[axis];
    }
  }
  return step;
}

template <class Step>
void take_step(SimulationObject& object, sunder_step* step, Step&& take) {
  if (step) static_cast<void>(stated_size(step, "step"));
  const sunder::StepReport report = take();
  if (step) write_struct(step, to_step(report), "step");
  if (object.simulation().interrupted()) {
    throw Failure(SUNDER_ERROR_CANCELLED, "step " + std::to_string(report.step) +
                                              " was cancelled after its event " +
                                              std::to_string(report.events));
  }
}

}  // namespace

namespace sunder::c {

void require_motion(const SimulationObject& object, const char* what) {
  if (object.problem().moves()) return;
  throw Failure(SUNDER_ERROR_ORDER, std::string(what) +
                                        " needs a scene in motion: call sunder_scene_set_dynamics "
                                        "before the simulation is made");
}

void create_simulation(const SceneObject& scene, const sunder_callbacks* callbacks,
                       const SimulationObject::Create& create, bool again,
                       sunder_simulation* simulation) {
  require(simulation, "simulation");
  auto given = sized<sunder_callbacks>();
  if (callbacks) given = read_struct(callbacks, given, "callbacks");
  *simulation = new_handle<sunder_simulation>(
      std::make_shared<SimulationObject>(scene, given, create, again));
}

}  // namespace sunder::c

extern "C" {

sunder_status sunder_simulation_create(sunder_scene scene, const sunder_callbacks* callbacks,
                                       sunder_simulation* simulation) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    create_simulation(
        object, callbacks,
        [](std::shared_ptr<const sunder::Problem> problem, sunder::Needs needs,
           std::shared_ptr<sunder::PipelineCache> cache) {
          return sunder::create_backend(std::move(problem), std::move(needs), std::move(cache));
        },
        true, simulation);
  });
}

sunder_status sunder_simulation_destroy(sunder_simulation simulation) {
  return guarded([&] {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    auto object = find<SimulationObject>(simulation, SimulationObject::kName);
    bool idle = object->take();
    // Its device goes right after: nothing may use it any more.
    while (!idle && !object->owns_device() && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
      idle = object->take();
    }
    if ((!idle && !object->owns_device()) || !object->silence(until)) {
      if (idle) object->release();
      throw Failure(SUNDER_ERROR_BUSY, "the handle is in use by another call");
    }
    if (object->close()) refuse_handle(SimulationObject::kName);
    object->gone->store(true);
    object->cancel();
    forget(simulation);
    const bool quick = object->problem().dof_count() <= kQuick;
    if (idle && object->owns_device() && !quick) dispose(std::move(object), until);
  });
}

sunder_status sunder_simulation_engine(sunder_simulation simulation, sunder_engine* engine) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    write_struct(engine, describe(object.problem(), object.simulation().backend().info()),
                 "engine");
  });
}

sunder_status sunder_simulation_step(sunder_simulation simulation, sunder_step* step) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    take_step(object, step, [&] { return object.step(std::nullopt); });
  });
}

sunder_status sunder_simulation_step_within(sunder_simulation simulation, double max_ms,
                                            sunder_step* step) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    if (!(max_ms >= 0) || !std::isfinite(max_ms)) {
      throw Failure(SUNDER_ERROR_VALUE,
                    "max_ms = " + std::to_string(max_ms) + " is not a time in ms, nor 0 for none");
    }
    take_step(object, step, [&] { return object.step_within(max_ms); });
  });
}

sunder_status sunder_simulation_step_by(sunder_simulation simulation, double dt,
                                        sunder_step* step) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require_motion(object, "a step of time");
    if (!(dt > 0) || !std::isfinite(dt)) {
      throw Failure(SUNDER_ERROR_VALUE,
                    "dt = " + std::to_string(dt) + " is not a time in seconds above 0");
    }
    take_step(object, step, [&] { return object.step(dt); });
  });
}

sunder_status sunder_simulation_cancel(sunder_simulation simulation) {
  return guarded([&] { find<SimulationObject>(simulation, SimulationObject::kName)->cancel(); });
}

sunder_status sunder_simulation_drive(sunder_simulation simulation, int32_t instrument,
                                      const double value[3]) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(value, "value");
    const auto& instruments = object.problem().scene().instruments;
    require_index(instrument, static_cast<std::int64_t>(instruments.size()), "instrument");
    require_finite(value, 3, "value");
    object.simulation().drive(static_cast<std::size_t>(instrument), sunder::Vec3(value));
  });
}

sunder_status sunder_simulation_turn(sunder_simulation simulation, int32_t instrument,
                                     const double turn[3]) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(turn, "turn");
    const auto& instruments = object.problem().scene().instruments;
    require_index(instrument, static_cast<std::int64_t>(instruments.size()), "instrument");
    require_finite(turn, 3, "turn");
    const auto i = static_cast<std::size_t>(instrument);
    const auto* grip = std::get_if<sunder::Grip>(&instruments[i].action);
    if (!grip || !grip->rigid) {
      throw Failure(SUNDER_ERROR_VALUE, "instrument " + std::to_string(instrument) +
                                            " is no rigid grip and does not turn");
    }
    object.simulation().turn(i, sunder::Vec3(turn));
  });
}

}  // extern "C"
