// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/laboratory.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "app/input/scene_toml.hpp"
#include "app/output/text.hpp"
#include "app/reproduce/paper_files.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"

namespace sunder::app::reproduce {
namespace {

using Clock = std::chrono::steady_clock;

void scale_forces(Scene& scene, double factor) {
  for (Instrument& instrument : scene.instruments) {
    if (auto* pull = std::get_if<Pull>(&instrument.action)) pull->force *= factor;
    if (auto* press = std::get_if<Press>(&instrument.action)) press->force *= factor;
  }
}

void grip_instead(Scene& scene, double way) {
  for (Instrument& instrument : scene.instruments) {
    const auto* pull = std::get_if<Pull>(&instrument.action);
    if (!pull) continue;
    Axes along{0};
    for (int axis = 0; axis < 3; ++axis)
      if (pull->force[axis] != 0) along.bits = static_cast<std::uint8_t>(along.bits | 1 << axis);
    const Vec3 moved = way * pull->force.normalized();
    instrument.action = Grip{NodeSelection(pull->nodes), moved, along};
  }
}

int count_fractures(const Simulation& simulation) {
  const auto& rows = simulation.destroyed();
  return static_cast<int>(std::count_if(
      rows.begin(), rows.end(), [](const auto& row) { return row.cause != Cause::preset; }));
}

/// What the plan wants is there.
bool over(const RunPlan& plan, const RunResult& so_far, int fractures) {
  if (plan.until > 0 && fractures >= plan.until) return true;
  if (plan.patience == 0 || so_far.steps.empty()) return false;
  return !so_far.steps.back().unfinished || static_cast<int>(so_far.steps.size()) == plan.patience;
}

/// Takes the snapshots of one run.
struct Snapshooter {
  const Simulation& simulation;
  int& frames;
  std::vector<int> wanted;
  std::vector<State>& taken;

  void operator()() {
    ++frames;
    const int fractures = count_fractures(simulation);
    bool reached = false;
    while (!wanted.empty() && wanted.front() <= fractures) {
      wanted.erase(wanted.begin());
      reached = true;
    }
    if (reached) taken.push_back(capture(simulation, simulation.steps_done()));
  }
};

}  // namespace

std::vector<DestroyedElement> RunResult::fractures() const {
  std::vector<DestroyedElement> rows;
  for (const DestroyedElement& row : destroyed) {
    if (row.cause != Cause::preset) rows.push_back(row);
  }
  return rows;
}

Laboratory::Laboratory(std::string backend, std::function<bool()> stop,
                       std::function<void(const std::string&)> tell)
    : backend_(std::move(backend)), stop_(std::move(stop)), tell_(std::move(tell)) {}

Laboratory Laboratory::with_law(MaterialLaw law) const {
  Laboratory other = *this;
  other.law_ = law;
  if (law != MaterialLaw::linear) other.backend_ = "cpu";
  other.notes_.clear();
  return other;
}

void Laboratory::check_interrupt() const {
  if (stop_()) throw Interrupted();
}

const Mesh& Laboratory::mesh_of(const std::string& file) const {
  const auto known = meshes_.find(file);
  if (known != meshes_.end()) return known->second;
  return meshes_.emplace(file, read_embedded_mesh(file)).first->second;
}

std::shared_ptr<const Mesh> Laboratory::notch(const NotchMesh& wanted) const {
  auto& mesh = made_[notch_geometry(wanted)];
  if (!mesh) mesh = mesh_notch(wanted);
  return mesh;
}

std::shared_ptr<const Mesh> Laboratory::board(const BoardMesh& wanted) const {
  auto& mesh = made_[board_geometry(wanted)];
  if (!mesh) mesh = mesh_board(wanted);
  return mesh;
}

Scene Laboratory::scene(const RunPlan& plan) const {
  std::vector<std::string> overrides = plan.overrides;
  overrides.push_back("solver.backend=" + backend_);
  ParsedScene parsed =
      parse_scene(paper_file(plan.scene + ".toml"), plan.scene + ".toml", overrides);
  parsed.scene.mesh = plan.mesh ? *plan.mesh : mesh_of(parsed.mesh_path);
  scale_forces(parsed.scene, plan.load);
  if (plan.grip) grip_instead(parsed.scene, *plan.grip);
  for (auto& [name, material] : parsed.scene.materials) material.law = law_;
  return std::move(parsed.scene);
}

RunResult Laboratory::run(const RunPlan& plan) const {
  check_interrupt();
  RunResult result;
  result.problem = std::make_shared<const Problem>(scene(plan));
  const Problem& problem = *result.problem;
  result.plane = board_plane(problem.mesh(), problem.scene().fracture.plane_normal);

  const auto start = Clock::now();
  CreatedBackend created = create_backend(result.problem, needs_of(problem));
  result.prepare_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();

  Simulation simulation(result.problem, std::move(created.backend));
  result.last = undeformed(problem);
  int frames = 0;
  simulation.observe_frames(Snapshooter{simulation, frames, plan.snapshots, result.snapshots});
  simulation.observe_events([this](std::span<const DestroyedElement>) { return !stop_(); });
  try {
    while (!simulation.done() && !over(plan, result, count_fractures(simulation))) {
      result.steps.push_back(simulation.step());
      result.frames.push_back(std::exchange(frames, 0));
      if (plan.tips) result.tips.push_back(simulation.tips());
      if (!linear()) result.last = capture(simulation, simulation.steps_done() - 1);
      check_interrupt();
    }
  } catch (const NumericalError& error) {
    if (linear()) throw;
    result.failure = error.what();
  }
  const auto steps = static_cast<int>(result.steps.size());
  const bool enough = plan.until > 0 && count_fractures(simulation) >= plan.until;
  if (plan.patience > 0 && steps == plan.patience && result.steps.back().unfinished && !enough)
    result.failure = "the body does not come to rest within " + counted(steps, "step");
  result.destroyed = simulation.destroyed();
  result.cracks = simulation.cracks();
  result.backend = simulation.backend().info();
  result.warnings = std::move(created.warnings);
  for (std::string& text : simulation.warnings()) result.warnings.push_back(std::move(text));
  if (linear()) {
    result.last = capture(simulation, simulation.steps_done() - 1);
  } else {
    note(plan, result);
  }
  return result;
}

void Laboratory::note(const RunPlan& plan, const RunResult& result) const {
  RunNote note;
  note.scene = plan.scene;
  for (const std::string& text : plan.overrides) {
    if (text == "fracture.sif=formula") note.k = "formula K";
    if (text == "fracture.sif=field") note.k = "field K";
  }
  if (!result.steps.empty())
    note.load = plan.load * (plan.patience > 0 ? 1 : result.steps.back().load_factor);
  note.steps = static_cast<int>(result.steps.size());
  note.all = result.problem->scene().steps;
  note.fractures = static_cast<int>(result.fractures().size());
  for (const StepReport& step : result.steps) note.unfinished += step.unfinished ? 1 : 0;
  note.by_j =
      std::any_of(result.warnings.begin(), result.warnings.end(), [](const std::string& text) {
        return text.find("J, which is measured there too") != std::string::npos;
      });
  note.failure = result.failure;
  notes_.push_back(std::move(note));
}

}  // namespace sunder::app::reproduce
