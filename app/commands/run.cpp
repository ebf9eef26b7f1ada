// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <utility>

#include "app/commands/commands.hpp"
#include "app/commands/interrupt.hpp"
#include "app/commands/progress.hpp"
#include "app/commands/results.hpp"
#include "app/commands/waiting.hpp"
#include "app/output/text.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"

namespace sunder::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void add_new(std::vector<std::string>& to, const std::vector<std::string>& from) {
  for (const std::string& text : from)
    if (std::find(to.begin(), to.end(), text) == to.end()) to.push_back(text);
}

std::string of_steps(int step, const Problem& problem) {
  return std::to_string(step) + " of " + std::to_string(problem.scene().steps);
}

/// A picture to be taken within a step.
struct Snapshot {
  int wanted = 0;  ///< number of destroyed elements that was asked for
  State state;
};

/// One run: the simulation, what it has told so far, and where that is written.
class Run {
 public:
  Run(const RunArguments& arguments, const OpenedScene& scene, std::filesystem::path folder)
      : problem_(*scene.problem),
        record_(problem_),
        simulation_(make_simulation(scene, !arguments.quiet)),
        writer_(std::move(folder), problem_, arguments.series),
        progress_(problem_.scene().steps, !arguments.quiet),
        wanted_(arguments.snapshots) {
    std::sort(wanted_.begin(), wanted_.end());
    wanted_.erase(std::unique(wanted_.begin(), wanted_.end()), wanted_.end());
  }

  /// Steps until done, interrupted or failed; then the result files. Returns the exit code.
  int carry_out();
  [[nodiscard]] const RunRecord& record() const { return record_; }
  [[nodiscard]] const ResultWriter& writer() const { return writer_; }

 private:
  std::unique_ptr<Simulation> make_simulation(const OpenedScene& scene, bool shown);
  void step();
  void take_snapshots();
  void note_before_rupture();
  void note_rupture(std::span<const DestroyedElement> event);
  void write_snapshots();
  void close();

  const InterruptGuard guard_;  // before any file appears
  const Problem& problem_;
  RunRecord record_;
  std::unique_ptr<Simulation> simulation_;
  ResultWriter writer_;
  Progress progress_;
  std::vector<int> wanted_;      ///< snapshots still to come, ascending
  std::vector<Snapshot> taken_;  ///< in this step
  RuptureState now_;             ///< of the last frame before the first rupture
};

std::unique_ptr<Simulation> Run::make_simulation(const OpenedScene& scene, bool shown) {
  record_.warnings = scene.warnings;
  const Waiting waiting("preparing " + grouped(problem_.dof_count()) + " unknowns", shown);
  CreatedBackend created = create_backend(scene.problem, needs_of(problem_));
  record_.left_out = created.backend->needs().left_out;
  add_new(record_.warnings, created.warnings);
  created.backend->time_passes(true);
  return std::make_unique<Simulation>(scene.problem, std::move(created.backend));
}

/// Within a step, whenever the fields fit what is destroyed.
void Run::take_snapshots() {
  const auto destroyed = static_cast<int>(simulation_->destroyed().size());
  while (!wanted_.empty() && wanted_.front() <= destroyed) {
    taken_.push_back({wanted_.front(), capture(*simulation_, simulation_->steps_done())});
    wanted_.erase(wanted_.begin());
  }
}

/// Within a step, before the decision: what the first rupture would be told with.
void Run::note_before_rupture() {
  if (record_.at_first_rupture || problem_.scene().fracture.model == FractureModel::none) return;
  now_ = {};
  const Backend& backend = simulation_->backend();
  if (backend.needs().stress) now_.deformation = simulation_->backend().deformation();
  const std::vector<Vec3> u = simulation_->displacement();
  const auto destroyed = backend.destroyed();
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (destroyed[e]) continue;
    for (Index n : problem_.mesh().tets[e]) {
      now_.displacement_max = std::max(now_.displacement_max, u[n].norm());
    }
  }
}

void Run::note_rupture(std::span<const DestroyedElement> event) {
  if (record_.at_first_rupture || event.empty()) return;
  if (event.front().cause == Cause::mss || event.front().cause == Cause::sif) {
    record_.at_first_rupture = now_;
  }
}

void Run::write_snapshots() {
  for (const Snapshot& snapshot : taken_) writer_.snapshot(snapshot.wanted, snapshot.state);
  taken_.clear();
}

void Run::step() {
  const int number = simulation_->steps_done();
  const StepReport report = simulation_->step();
  record_.last = capture(*simulation_, number);
  write_snapshots();
  if (simulation_->interrupted()) {
    record_.unfinished = report;
    return;
  }
  record_.steps.push_back(report);
  writer_.step_done(report, record_.last, simulation_->tips());
  progress_.update(simulation_->steps_done(), report.destroyed);
}

int Run::carry_out() {
  simulation_->observe_frames([this] {
    take_snapshots();
    note_before_rupture();
  });
  simulation_->observe_events([this](std::span<const DestroyedElement> event) {
    note_rupture(event);
    progress_.update(simulation_->steps_done(), static_cast<int>(simulation_->destroyed().size()));
    return !InterruptGuard::requested();
  });
  try {
    while (!simulation_->done() && !InterruptGuard::requested()) step();
  } catch (const NumericalError& error) {
    record_.failure = error.what();
  }
  record_.interrupted = simulation_->interrupted() || (!simulation_->done() && !record_.failure);
  progress_.finish();
  close();
  const std::string so_far = ": results so far are in " + writer_.folder().string();
  if (record_.failure)
    throw NumericalError(*record_.failure + " (in step " +
                         of_steps(simulation_->steps_done() + 1, problem_) + ")" + so_far);
  if (!record_.interrupted) return 0;
  std::cerr << "sunder: interrupted " << (simulation_->interrupted() ? "in step " : "after step ")
            << of_steps(simulation_->steps_done(), problem_) << so_far << "\n";
  return kInterruptedExit;
}

void Run::close() {
  write_snapshots();
  record_.backend = simulation_->backend().info();
  if (simulation_->backend().prepares() && problem_.scene().solver.prepare) {
    record_.preparation = simulation_->backend().preparation();
  }
  record_.destroyed = simulation_->destroyed();
  record_.cracks = simulation_->cracks();
  add_new(record_.warnings, simulation_->warnings());
  for (const int count : wanted_)
    add_new(record_.warnings, {"no snapshot at " + counted(count, "destroyed element") + ": only " +
                               std::to_string(record_.destroyed.size()) + " were destroyed"});
  writer_.finish(record_);
}

void print_first_rupture(const RunRecord& run) {
  const DestroyedElement* first = run.first_rupture();
  if (!first) {
    std::cout << "  no rupture\n";
    return;
  }
  std::cout << "  first rupture: element " << first->element << " (" << to_string(first->cause)
            << ") in step " << first->step << ", load factor " << rounded(first->load_factor, 4)
            << "\n";
  if (!run.at_first_rupture) return;
  const Mesh& mesh = run.problem.mesh();
  Vec3 low = mesh.nodes.front(), high = low;
  for (const Vec3& x : mesh.nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  std::cout << "  at the first rupture: largest displacement "
            << rounded(run.at_first_rupture->displacement_max, 2) << " mm of a body "
            << rounded((high - low).maxCoeff(), 3) << " mm long";
  if (const auto& d = run.at_first_rupture->deformation) {
    std::cout << ", strain " << rounded(d->strain, 2) << ", rotation "
              << rounded(d->rotation_deg, 2) << " deg";
  }
  std::cout << "\n";
}

void print_summary(const RunRecord& run, const ResultWriter& writer, double seconds) {
  const Problem& problem = run.problem;
  std::cout << problem.scene().title << "\n  " << grouped(problem.tet_count()) << " tetrahedra, "
            << grouped(problem.dof_count()) << " unknowns, model "
            << name_of(problem.scene().fracture.model) << ", " << run.backend.backend << " "
            << run.backend.precision << ", route " << run.backend.route << " ("
            << run.backend.update << ")\n  "
            << counted(static_cast<long long>(run.steps.size()), "step") << " in "
            << rounded(seconds, 3)
            << " s: " << counted(static_cast<long long>(run.destroyed.size()), "element")
            << " destroyed in " << counted(run.event_count(), "event") << ", "
            << counted(static_cast<long long>(run.cracks.size()), "crack") << "\n";
  print_first_rupture(run);
  const StepReport last = run.last_report();
  std::cout << "  largest yield ratio left " << rounded(last.max_yield_ratio, 4) << ", residual "
            << rounded(last.residual, 2) << ", error " << rounded(last.error, 2) << "\n";
  std::cout << "  results in " << writer.folder().string() << ":";
  for (const std::string& file : writer.files()) std::cout << " " << file;
  std::cout << std::endl;
}

}  // namespace

int run(const RunArguments& arguments) {
  const auto start = Clock::now();
  const OpenedScene scene = open_scene(arguments.scene);
  const std::filesystem::path folder =
      arguments.out.value_or(std::filesystem::path("out") / arguments.scene.scene.stem());
  Run run(arguments, scene, folder);
  const int exit_code = run.carry_out();
  if (!arguments.quiet)
    for (const std::string& warning : run.record().warnings)
      std::cerr << "sunder: warning: " << warning << "\n";
  print_summary(run.record(), run.writer(), seconds_since(start));
  return exit_code;
}

}  // namespace sunder::app
