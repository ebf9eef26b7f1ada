// SPDX-License-Identifier: Apache-2.0
#include "c/simulation.hpp"

#include <algorithm>
#include <thread>

#include "c/structs.hpp"
#include "sunder/error.hpp"

namespace sunder::c {

SimulationObject::SimulationObject(const SceneObject& scene, const sunder_callbacks& callbacks,
                                   const Create& create, bool again)
    : pipeline_cache(std::make_shared<PipelineCache>(scene.pipeline_cache)),
      callbacks_(callbacks),
      create_(again ? create : Create()),
      steps_(scene.scene.steps) {
  enter(SUNDER_PHASE_CHECK);
  const auto problem = scene.problem();
  enter(SUNDER_PHASE_PREPARE);
  CreatedBackend created = create(problem, needs_of(*problem), pipeline_cache);
  creation_warnings_ = std::move(created.warnings);
  simulation_ = std::make_unique<Simulation>(problem, std::move(created.backend));
  simulation_->attribute_events(scene.attribution);
  simulation_->observe_events([this](std::span<const DestroyedElement>) {
    ++events_;
    return tell(SUNDER_PHASE_STEP, events_) && !cancelled_.load();
  });
  const BackendInfo info = simulation_->backend().info();
  log(SUNDER_LOG_INFO, "backend " + info.backend + " " + info.precision + " on " + info.device +
                           ", route " + info.route + ": " + info.why);
  log_warnings();
}

StepReport SimulationObject::step(std::optional<double> dt) {
  return take_step([&] { return dt ? simulation_->step(*dt) : simulation_->step(); });
}

StepReport SimulationObject::step_within(double max_ms) {
  return take_step([&] { return simulation_->step_within(max_ms); });
}

void SimulationObject::keep_history(int quick) {
  Simulation::MakeBackend make;
  if (create_) {
    make = [create = create_, problem = simulation_->shared_problem(),
            needs = simulation_->backend().needs(),
            cache = pipeline_cache] { return create(problem, needs, cache).backend; };
  }
  simulation_->keep_history(std::move(make), quick);
}

Surface& SimulationObject::follow_surface() {
  if (surface) {
    surface->update();
  } else {
    surface = std::make_unique<Surface>(*simulation_);
  }
  return *surface;
}

sunder_surface to_c(const Surface& surface) {
  auto out = sized<sunder_surface>();
  out.triangle_count = static_cast<std::int32_t>(surface.triangles().size());
  out.node_count = static_cast<std::int32_t>(surface.node_count());
  out.version = surface.version();
  return out;
}

void SimulationObject::draw_on(std::shared_ptr<VulkanSurface> surface) {
  if (surface) draws_on_host_ = true;
  vulkan_surface_ = std::move(surface);  // what was before goes here
  draws_on_host_ = vulkan_surface_ != nullptr;
}

template <class Step>
StepReport SimulationObject::take_step(Step&& step) {
  events_ = 0;
  StepReport report;
  try {
    report = step();
  } catch (const NumericalError& error) {
    log(SUNDER_LOG_ERROR, error.what());
    throw;
  }
  if (simulation_->interrupted()) cancelled_.store(false);
  log_warnings();
  return report;
}

std::vector<std::string> SimulationObject::warnings() const {
  std::vector<std::string> all = creation_warnings_;
  for (std::string& text : simulation_->warnings()) all.push_back(std::move(text));
  return all;
}

/// False: the host has destroyed the simulation, and what callbacks use may be gone.
template <class Call>
bool SimulationObject::call_back(Call&& call) const {
  int none = kIdle;
  if (!calling_.compare_exchange_strong(none, kInside)) return false;
  const struct Leave {
    std::atomic<int>& calling;
    ~Leave() { calling.store(kIdle); }
  } leave{calling_};
  call();
  return true;
}

bool SimulationObject::silence(std::chrono::steady_clock::time_point until) {
  int was = kIdle;
  while (!calling_.compare_exchange_strong(was, kSilent) && was != kSilent) {
    if (std::chrono::steady_clock::now() > until) return false;
    was = kIdle;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return true;
}

void SimulationObject::log(std::int32_t level, const std::string& text) const {
  if (!callbacks_.log) return;
  static_cast<void>(call_back([&] { callbacks_.log(callbacks_.log_user, level, text.c_str()); }));
}

/// Findings that are new. Those that count steps change their text with every step; they are told
/// again only beside a new one.
void SimulationObject::log_warnings() {
  if (!callbacks_.log) return;
  const auto all = warnings();
  const bool more = all.size() > warning_count_;
  warning_count_ = all.size();
  for (const std::string& text : all) {
    if (told_.insert(text).second && more) log(SUNDER_LOG_WARNING, text);
  }
}

bool SimulationObject::tell(std::int32_t phase, int events) const {
  if (!callbacks_.progress) return true;
  auto progress = sized<sunder_progress>();
  progress.phase = phase;
  progress.steps = steps_;
  progress.events = events;
  if (simulation_) {
    progress.step = simulation_->steps_done();
    progress.destroyed = static_cast<std::int32_t>(std::ranges::count(
        simulation_->destroyed(), false, [](const DestroyedElement& d) { return d.lives; }));
  }
  std::int32_t answer = 0;
  return call_back([&] { answer = callbacks_.progress(callbacks_.progress_user, &progress); }) &&
         answer == 0;
}

void SimulationObject::enter(std::int32_t phase) const {
  if (!tell(phase, 0)) throw Failure(SUNDER_ERROR_CANCELLED, "the creation was cancelled");
}

}  // namespace sunder::c
