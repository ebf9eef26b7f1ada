// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <optional>
#include <utility>

#include "app/commands/commands.hpp"
#include "app/commands/in_folder.hpp"
#include "app/commands/progress.hpp"
#include "app/commands/results.hpp"
#include "app/commands/waiting.hpp"
#include "app/figure/raster.hpp"
#include "app/inputs/hand.hpp"
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

constexpr const char* kNoPixels =
    "this build makes no PNG (it was built without librsvg): pictures are SVG alone";

/// A picture to be taken within a step.
struct Snapshot {
  int wanted = 0;  ///< number of destroyed elements, or of splits, that was asked for
  State state;
};

// A signal waits so long for an event to be over; then the run is ended without it.
constexpr std::chrono::milliseconds kGrace{500};
// Slow events are put aside within their step: not more often than that, and at a tenth of the
// time.
constexpr double kAsideSeconds = 0.3, kAsideShare = 10;

/// What a run of slow events would write if it were ended now, within a step.
struct Aside {
  StepReport report;
  State state;
  std::vector<DestroyedElement> destroyed;
  std::vector<std::string> warnings;
};

/// One run: the simulation, what it has told so far, and where that is written. Two threads: one
/// computes, and where a signal comes and that does not end by itself, another writes what is in
/// the record. `turn_` is held by the one that is not computing: it guards all but the simulation.
class Run {
 public:
  Run(const RunArguments& arguments, const OpenedScene& scene, ResultFolder& folder,
      Interruption& interruption, Clock::time_point start)
      : interruption_(interruption),
        quiet_(arguments.quiet),
        start_(start),
        problem_(*scene.problem),
        record_(problem_),
        simulation_(make_simulation(scene)),
        hand_(*simulation_, false),
        writer_(folder, problem_, arguments.series),
        progress_(problem_.scene().steps, !quiet_,
                  cracks_split(problem_.scene()) ? "splits" : "destroyed"),
        wanted_(arguments.snapshots) {
    if (folder.warning()) record_.warnings.push_back(*folder.warning());
    if (!draws_pixels()) record_.warnings.emplace_back(kNoPixels);
    of_setup_ = record_.warnings;
    std::sort(wanted_.begin(), wanted_.end());
    wanted_.erase(std::unique(wanted_.begin(), wanted_.end()), wanted_.end());
    if (!scene.recording.empty()) open_recording(scene);
    if (scene.inputs) inputs_.emplace(*scene.inputs, hand_, problem_.scene().steps);
    note();
  }

  /// Steps until done, interrupted or failed; then the result files. Returns the exit code.
  int carry_out();

 private:
  std::unique_ptr<Simulation> make_simulation(const OpenedScene& scene);
  void open_recording(const OpenedScene& scene);
  void observe();
  void begin();
  void compute();
  void step();
  [[nodiscard]] bool reach_step();
  void note();
  void take_snapshots();
  void note_before_rupture();
  void note_rupture(std::span<const DestroyedElement> event);
  void put_aside();
  void write_snapshots();
  [[nodiscard]] std::string no_snapshot(int wanted) const;
  void tell_stopped();
  int end();
  int end_without_computing();
  void print_summary() const;

  Interruption& interruption_;
  const bool quiet_;
  const Clock::time_point start_;
  const Problem& problem_;
  RunRecord record_;
  std::unique_ptr<Simulation> simulation_;
  Hand hand_;
  std::optional<Replay> inputs_;  ///< none, and no recording: the scene's steps alone
  bool recorded_ = false;         ///< a recording is played
  std::mutex turn_;
  ResultWriter writer_;
  Progress progress_;
  std::vector<std::string> of_setup_;  ///< warnings
  std::vector<int> wanted_;            ///< snapshots still to come, ascending
  std::vector<Snapshot> taken_;        ///< in this step
  std::optional<Aside> aside_;         ///< in this step
  RuptureState now_;                   ///< of the last frame before the first rupture
  bool told_stopped_ = false, inputs_done_ = false;
  Clock::time_point put_aside_ = Clock::now();
  double aside_seconds_ = 0;  ///< that putting aside took
};

std::unique_ptr<Simulation> Run::make_simulation(const OpenedScene& scene) {
  record_.warnings = scene.warnings;
  const Waiting waiting("preparing " + counted(problem_.dof_count(), "unknown"), !quiet_);
  CreatedBackend created = create_backend(scene.problem, needs_of(problem_));
  record_.left_out = created.backend->needs().left_out;
  add_new(record_.warnings, created.warnings);
  created.backend->time_passes(true);
  return std::make_unique<Simulation>(scene.problem, std::move(created.backend));
}

void Run::open_recording(const OpenedScene& scene) {
  try {
    simulation_->open_recording(scene.recording);
  } catch (const InputError& error) {
    throw InputError(error.fault(), scene.recording_file.string() + ": " + error.what());
  }
  recorded_ = true;
}

/// Into the record: all that the simulation tells but its fields.
void Run::note() {
  const Backend& backend = simulation_->backend();
  record_.backend = backend.info();
  if (backend.prepares() && problem_.scene().solver.prepare) {
    record_.preparation = backend.preparation();
  }
  const auto& destroyed = simulation_->destroyed();
  record_.destroyed.insert(
      record_.destroyed.end(),
      destroyed.begin() + static_cast<std::ptrdiff_t>(record_.destroyed.size()), destroyed.end());
  record_.cracks = simulation_->cracks();
  record_.warnings = of_setup_;
  add_new(record_.warnings, simulation_->warnings());
}

/// Within a step, whenever the fields fit what is destroyed.
void Run::take_snapshots() {
  const auto destroyed = static_cast<int>(simulation_->destroyed().size());
  while (!wanted_.empty() && wanted_.front() <= destroyed) {
    Snapshot snapshot{wanted_.front(), capture(*simulation_, simulation_->steps_done())};
    const std::lock_guard turn(turn_);
    taken_.push_back(std::move(snapshot));
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

/// Where snapshots are taken. What a step of quick events has come to is not worth it.
void Run::put_aside() {
  const double since = seconds_since(put_aside_);
  if (!(since > std::max(kAsideSeconds, kAsideShare * aside_seconds_))) return;
  const auto start = Clock::now();
  Aside aside{simulation_->so_far(), capture(*simulation_, simulation_->steps_done()),
              simulation_->destroyed(), simulation_->warnings()};
  const std::lock_guard turn(turn_);
  aside_ = std::move(aside);
  put_aside_ = Clock::now();
  aside_seconds_ = seconds_since(start);
}

void Run::write_snapshots() {
  for (const Snapshot& snapshot : taken_) {
    tell_stopped();
    writer_.snapshot(snapshot.wanted, snapshot.state);
  }
  taken_.clear();
}

/// Where a signal has come: from here on files are written alone, which may take longer.
void Run::tell_stopped() {
  if (quiet_ || !interruption_.requested() || std::exchange(told_stopped_, true)) return;
  const Interruption::Since since = interruption_.since_signal();
  progress_.finish();
  std::cerr << "sunder: stopped " << rounded(since.seconds, 2) << " s after the signal ("
            << rounded(since.processor_seconds, 2) << " s of processor time); writing results to "
            << writer_.folder().path().string() << ", another signal drops them" << std::endl;
}

void Run::observe() {
  simulation_->observe_frames([this] {
    take_snapshots();
    note_before_rupture();
    put_aside();
  });
  simulation_->observe_events([this](std::span<const DestroyedElement> event) {
    const std::lock_guard turn(turn_);
    note_rupture(event);
    progress_.update(simulation_->steps_done(), static_cast<int>(simulation_->destroyed().size()));
    return !interruption_.requested();
  });
}

void Run::step() {
  const int number = simulation_->steps_done();
  const StepReport report = recorded_ ? simulation_->recorded_step() : simulation_->step();
  State state = capture(*simulation_, number);
  std::vector<TipState> tips;
  if (!simulation_->interrupted()) tips = simulation_->tips();
  record_.tips = tips;
  const std::lock_guard turn(turn_);
  aside_.reset();
  put_aside_ = Clock::now();
  record_.last = std::move(state);
  note();
  write_snapshots();
  if (simulation_->interrupted()) {
    record_.unfinished = report;
    return;
  }
  record_.steps.push_back(report);
  tell_stopped();
  writer_.step_done(report, record_.last, tips);
  progress_.update(simulation_->steps_done(), broken(record_.last));
}

/// Files appear once a signal ends the computing and no longer the set-up.
void Run::begin() {
  const std::lock_guard turn(turn_);
  writer_.begin();
}

/// Inputs and a recording end the run, and may change the body after its last step.
bool Run::reach_step() {
  if (!inputs_ && !recorded_) return !simulation_->done();
  const std::size_t before = simulation_->destroyed().size();
  if (recorded_ ? simulation_->reach_recorded_step() : inputs_->reach_step()) return true;
  if (simulation_->destroyed().size() > before && simulation_->steps_done() > 0) {
    State state = capture(*simulation_, simulation_->steps_done() - 1);
    const std::lock_guard turn(turn_);
    record_.last = std::move(state);
    note();
  }
  inputs_done_ = true;
  return false;
}

void Run::compute() {
  try {
    while (!interruption_.requested() && reach_step()) step();
  } catch (const NumericalError& error) {
    const std::lock_guard turn(turn_);
    record_.failure = error.what();
    note();
  }
}

int Run::carry_out() {
  observe();
  const Expecting computing(interruption_, {"", [this] { return writer_.folder().drop(); },
                                            [this] { return end_without_computing(); }, kGrace});
  begin();
  compute();
  interruption_.claim();
  const bool done = simulation_->done() || inputs_done_;
  record_.interrupted = simulation_->interrupted() || (!done && !record_.failure);
  return end();
}

/// On another thread than the computing, which is left behind.
int Run::end_without_computing() {
  turn_.lock();  // for good
  if (aside_) {
    record_.unfinished = aside_->report;
    record_.cracks = aside_->state.cracks;
    record_.last = std::move(aside_->state);
    record_.destroyed = std::move(aside_->destroyed);
    record_.warnings = of_setup_;
    add_new(record_.warnings, aside_->warnings);
  }
  std::erase_if(taken_, [this](const Snapshot& snapshot) {
    return broken(snapshot.state) > broken(record_.last);
  });
  record_.interrupted = !record_.failure;
  return end();
}

std::string Run::no_snapshot(int wanted) const {
  const auto count = static_cast<long long>(record_.destroyed.size());
  if (cracks_split(problem_.scene())) {
    return "no snapshot at " + counted(wanted, "split") + ": there were only " +
           std::to_string(count);
  }
  return "no snapshot at " + counted(wanted, "destroyed element") + ": only " +
         std::to_string(count) + " were destroyed";
}

/// The result files and what is to be said; reads the record alone.
int Run::end() {
  progress_.finish();
  tell_stopped();
  write_snapshots();
  for (const int count : wanted_) add_new(record_.warnings, {no_snapshot(count)});
  writer_.finish(record_);
  const bool signalled = interruption_.requested();
  writer_.folder().release();
  const int steps = static_cast<int>(record_.steps.size());
  const std::string so_far = ": results so far are in " + writer_.folder().path().string();
  if (record_.failure)
    throw NumericalError(*record_.failure + " (in step " + of_steps(steps + 1, problem_) + ")" +
                         so_far);
  if (record_.interrupted)
    std::cerr << "sunder: interrupted " << (record_.unfinished ? "in step " : "after step ")
              << of_steps(record_.unfinished ? steps + 1 : steps, problem_) << so_far << "\n";
  else if (signalled)
    std::cerr << "sunder: interrupted after the last step: the results in "
              << writer_.folder().path().string() << " are complete\n";
  if (!quiet_)
    for (const std::string& warning : record_.warnings)
      std::cerr << "sunder: warning: " << warning << "\n";
  print_summary();
  return signalled ? kInterruptedExit : 0;
}

void print_first_rupture(const RunRecord& run) {
  const DestroyedElement* first = run.first_rupture();
  if (!first) {
    std::cout << "  no rupture\n";
    return;
  }
  std::cout << "  first rupture: ";
  if (first->element == kNone) {
    std::cout << "crack " << first->crack;
  } else {
    std::cout << "element " << first->element;
  }
  std::cout << " (" << to_string(first->cause) << ") in step " << first->step << ", load factor "
            << rounded(first->load_factor, 4) << "\n";
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

void Run::print_summary() const {
  const RunRecord& run = record_;
  const Problem& problem = problem_;
  std::cout << problem.scene().title << "\n  "
            << counted(problem.tet_count(), "tetrahedron", "tetrahedra") << ", "
            << counted(problem.dof_count(), "unknown") << ", model "
            << name_of(problem.scene().fracture.model) << ", " << run.backend.backend << " "
            << run.backend.precision << ", route " << run.backend.route << " ("
            << run.backend.update << ")\n  "
            << counted(static_cast<long long>(run.steps.size()), "step") << " in "
            << rounded(seconds_since(start_), 3)
            << " s: " << counted(run.destroyed_count(), "element") << " destroyed in "
            << counted(run.event_count(), "event") << ", "
            << counted(static_cast<long long>(run.cracks.size()), "crack") << "\n";
  if (const SplitMesh* split = run.last.split.get()) {
    std::cout << "  " << rounded(crack_area(*split), 4) << " mm^2 split open, "
              << counted(split->mesh.node_count() - problem.node_count(), "new node") << "\n";
  }
  print_first_rupture(run);
  const StepReport last = run.last_report();
  std::cout << "  largest yield ratio left " << rounded(last.max_yield_ratio, 4) << ", residual "
            << rounded(last.residual, 2) << ", error " << rounded(last.error, 2) << "\n";
  std::cout << "  results in " << writer_.folder().path().string() << ":";
  for (const std::string& file : writer_.files()) std::cout << " " << file;
  std::cout << std::endl;
}

}  // namespace

int run(const RunArguments& arguments, Interruption& interruption) {
  const Clock::time_point start = Clock::now();
  const OpenedScene scene = open_scene(arguments.scene);
  std::optional<ResultFolder> folder;
  const Expecting preparing =
      in_folder(interruption, folder,
                arguments.out.value_or(std::filesystem::path("out") / arguments.scene.scene.stem()),
                "nothing was computed, and nothing written to ");
  Run run(arguments, scene, *folder, interruption, start);
  const int exit_code = run.carry_out();
  // Destructors wait for threads that make what nobody wants any more.
  if (exit_code == kInterruptedExit) interruption.leave(exit_code);
  interruption.over(exit_code);
  return exit_code;
}

}  // namespace sunder::app
