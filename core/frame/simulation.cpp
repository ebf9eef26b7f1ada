// SPDX-License-Identifier: Apache-2.0
#include "sunder/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "body/pieces.hpp"
#include "fracture/averaged_strength.hpp"
#include "fracture/criterion.hpp"
#include "fracture/finding.hpp"
#include "frame/attribution.hpp"
#include "frame/history.hpp"
#include "frame/loads.hpp"
#include "frame/needs.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder {
namespace {

/// Adds the milliseconds of a scope to a stage.
class Timer {
 public:
  explicit Timer(double& stage) : stage_(stage) {}
  ~Timer() { stage_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& stage_;
  Clock::time_point start_ = Clock::now();
};

/// The report of a step while the step lasts.
class Shown {
 public:
  Shown(const StepReport*& place, const StepReport& report) : place_(place) { place_ = &report; }
  ~Shown() { place_ = nullptr; }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

 private:
  const StepReport*& place_;
};

}  // namespace

Simulation::Simulation(std::shared_ptr<const Problem> problem, std::unique_ptr<Backend> backend)
    : problem_(std::move(problem)), backend_(std::move(backend)) {
  if (!problem_ || !backend_) throw UsageError("a simulation needs a problem and a backend");
  if (&backend_->problem() != problem_.get()) {
    throw UsageError("the backend was created for another problem");
  }
  check_needs(needs_of(*problem_), backend_->needs());
  set_up();
}

/// What begins with the run.
void Simulation::set_up() {
  loads_ = std::make_unique<Loads>(*problem_);
  criterion_ = make_criterion(*problem_);
  loose_ = std::make_unique<LooseSearch>(*problem_);
  if (problem_->scene().fracture.averaging > 0 && backend_->needs().yield) {
    averaged_ = std::make_unique<fracture::AveragedStrength>(*problem_);
  }
  decision_ = std::make_unique<Decision>();
  reserve();
}

/// Steps append to what is here and allocate nothing, up to so many destroyed elements.
void Simulation::reserve() {
  constexpr std::size_t kDestroyed = 1 << 16, kFindings = 256;
  const std::size_t elements = problem_->mesh().tets.size();
  if (backend_->needs().damage) destroyed_.reserve(std::min(elements, kDestroyed));
  if (backend_->needs().damage) event_.reserve(std::min(elements, kDestroyed));
  if (!problem_->scene().removals.empty()) taken_.reserve(elements);
  if (backend_->needs().damage && backend_->needs().stress) {
    now_.cut_off.reserve(elements);
    newly_cut_off_.reserve(std::min(elements, kDestroyed));
  }
  if (backend_->needs().pristine) pristine_.reserve(3 * problem_->mesh().nodes.size());
  findings_.reserve(kFindings);
  of_loads_.reserve(kFindings);
  reserve_in_line();
  std::size_t nodes = 0;
  for (const InstrumentNodes& i : problem_->instrument_nodes()) {
    nodes += std::max(i.nodes.size(), std::size_t{2});  // a press has up to two
    reactions_.displacement.reserve(std::max(i.nodes.size(), std::size_t{2}));
  }
  instrument_forces_.reserve(nodes);
  reactions_.forces.reserve(problem_->scene().instruments.size());
}

Simulation::~Simulation() {
  if (haptics_) haptics_->end();
  if (frames_) frames_->end();
}

StepReport Simulation::step() { return take_step(std::nullopt, problem_->scene().solver.max_ms); }

StepReport Simulation::step(double dt) {
  if (!problem_->moves()) throw UsageError("a step of time needs a scene with [dynamics]");
  if (!(dt > 0) || !std::isfinite(dt)) {
    throw UsageError("a step of time must be finite and above 0 s");
  }
  return take_step(dt, problem_->scene().solver.max_ms);
}

StepReport Simulation::step_within(double max_ms) {
  if (!(max_ms >= 0) || !std::isfinite(max_ms)) {
    throw UsageError("a bound on a step's time must be finite and not below 0 ms");
  }
  return take_step(std::nullopt, max_ms);
}

StepReport Simulation::compute_step(double dt) {
  const bool moves = problem_->moves();
  const int steps = problem_->scene().steps;
  const double time_step = moves ? problem_->scene().dynamics->time_step : 0;
  const bool even = now_.even && dt == time_step;  // sums of time round, multiples do not
  const double time = even ? (now_.next_step + 1) * time_step : now_.time + dt;
  now_.scene_time = even ? (now_.next_step + 1.0) / steps : time / (steps * time_step);
  StepReport report;
  const Shown shown(in_work_, report);
  report.step = now_.next_step;
  report.load_factor = now_.scene_time;
  now_.interrupted = now_.out_of_time_now = false;
  if (haptics_) haptics_->label(now_.next_step);
  events_this_step_ = 0;
  decisions_this_step_ = 0;
  pristine_.clear();
  StageTimes& times = report.times;
  const std::size_t destroyed_before = destroyed_.size();
  StressSummary summary;
  {
    const Timer total(times.total);
    {
      const Timer timer(times.update);
      if (!now_.preset) apply_presets();
      apply_removals();
    }
    for (bool broke = true; broke;) {
      {
        const Timer timer(times.load);
        of_loads_.clear();
        loads_->update(report.load_factor, *criterion_, backend_->destroyed(), of_loads_);
        for (const Finding& found : of_loads_) note(found);
        backend_->set_load(loads_->load());
      }
      {
        const Timer timer(times.solve);
        const SolveReport solved = moves ? backend_->advance(dt) : solve();
        times.solve -= solved.stress_ms;
        times.stress += solved.stress_ms;
        record_solve(solved, report);
      }
      if (backend_->needs().split) settle_lips(report);
      {
        const Timer timer(times.stress);
        summary = backend_->needs().stress ? backend_->stress() : StressSummary{};
        if (averaged_) summary = averaged_->summarize(*backend_);
      }
      report.max_yield_ratio = summary.any.ratio;
      // In motion the intact body moves beside the real one, in every step.
      if (moves && backend_->needs().pristine) static_cast<void>(pristine_displacement());
      if (frame_observer_ && !replaying()) frame_observer_();
      if (report.unfinished) break;  // a body on its way: nothing is decided
      {
        const Timer timer(times.decide);
        decide(summary);
      }
      {
        const Timer timer(times.update);
        if (now_.attribute) attribute_event();
        broke = apply_event() && !moves;
      }
    }
    if (destroyed_.size() != destroyed_before) find_loose();
    if (backend_->needs().stress) {
      const Timer timer(times.stress);
      measure_deformation(report);
    }
  }
  report.events = events_this_step_;
  report.out_of_time = now_.out_of_time_now;
  report.destroyed = now_.gone;
  report.compliance = compliance();
  report.passes = backend_->take_pass_times();
  report.new_bases = backend_->take_new_bases();
  if (moves) {
    report.motion = backend_->motion();
    report.motion->time = time;  // a sum of steps rounds
  }
  now_.time = time;
  now_.even = even;
  ++now_.next_step;
  prepare_next(summary);
  return report;
}

/// Looks at the lips of split cracks; where they are to be kept apart, springs come and go until
/// those that are there press and no other lips overlap.
void Simulation::settle_lips(StepReport& report) {
  constexpr int kSolutions = 20;
  LipState lips;
  for (int i = 0;; ++i) {
    lips = criterion_->look_at_lips(fracture_state({}));
    if (lips.change.ties.empty()) break;
    if (i == kSolutions) {
      note({Finding::Kind::lips_unsettled, now_.next_step});
      break;
    }
    {
      const Timer timer(report.times.update);
      backend_->change(lips.change);
    }
    const Timer timer(report.times.solve);
    record_solve(solve(), report);
  }
  for (const Finding& found : lips.findings) note(found);
  now_.lip_overlap = std::max(now_.lip_overlap, lips.overlap);
}

/// The last step has nobody to go on from it: it is finished, or the backend refuses it.
SolveReport Simulation::solve() {
  SolveReport report = backend_->solve();
  const bool last = now_.next_step + 1 == problem_->scene().steps;
  while (last && report.unfinished) {
    const int before = report.back_solves;
    report = backend_->solve();
    report.back_solves += before;
  }
  return report;
}

StepReport Simulation::so_far() {
  if (!in_work_) return {};
  StepReport report = *in_work_;
  report.events = events_this_step_;
  report.destroyed = now_.gone;
  report.compliance = compliance();
  return report;
}

void Simulation::record_solve(const SolveReport& solve, StepReport& report) {
  now_.solved = true;
  loads_->solved();
  report.residual = solve.residual;
  report.error = solve.error;
  report.iterations += solve.iterations;
  report.back_solves += solve.back_solves;
  report.unfinished = solve.unfinished;
  report.capped = solve.capped;
  if (solve.capped) now_.cut_short.add(now_.next_step);
  report.polished = report.polished || solve.polished;
  if (solve.polished) now_.polished.add(now_.next_step);
  if (solve.unfinished) now_.unfinished.add(now_.next_step);
}

FractureState Simulation::fracture_state(const StressSummary& summary) {
  read(reactions_);
  const std::vector<Vec3>& forces = reactions_.forces;
  Vec3 resultant = Vec3::Zero();
  const auto& instruments = problem_->scene().instruments;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (!std::holds_alternative<Press>(instruments[i].action)) resultant += forces[i];
  }
  for (const Tool& tool : loads_->tools()) {
    if (!tool.holds) resultant += tool.force;
    for (std::size_t n = 0; tool.holds && n < tool.nodes.size(); ++n) {
      resultant += Vec3(&reactions_.grips[tool.first + 3 * n]);
    }
  }
  return {
      *problem_,
      backend_->destroyed(),
      summary,
      [this](Index e) { return backend_->read_stress(e); },
      [this] { return pristine_displacement(); },
      resultant,
      loads_->presses(),
      [this](std::span<const Index> nodes, std::span<Vec3> u) {
        backend_->read_displacement(nodes, u);
      },
      [this] { return instrument_forces(); },
      [this] { return over_yield(); },
      backend_->pools(),
  };
}

std::span<const Worst> Simulation::over_yield() {
  over_.clear();
  if (averaged_) {
    averaged_->over(backend_->destroyed(), over_);
    return over_;
  }
  const YieldMeasure measure = strength_measure(problem_->scene().fracture);
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (backend_->destroyed()[e] || !problem_->breakable(e)) continue;
    const double ratio = problem_->yield_ratio(e, backend_->read_stress(e), measure);
    if (ratio >= 1) over_.push_back({e, ratio});
  }
  return over_;
}

void Simulation::decide(const StressSummary& summary) {
  decision_->clear();
  if (!row_of(problem_->scene().fracture.model).breaks || ended_early()) return;
  if (decisions_this_step_ >= problem_->scene().fracture.max_events) {
    now_.capped.add(now_.next_step);
    return;
  }
  criterion_->decide(fracture_state(summary), *decision_);
  if (!decision_->elements.empty()) ++decisions_this_step_;
}

/// Of what breaks by itself so many, and all that a host has named.
void Simulation::reserve_in_line() {
  constexpr std::size_t kInLine = 1 << 14;
  next_in_line_.reserve(std::min(problem_->mesh().tets.size(), kInLine) + named_.size());
}

/// In a frame in which nothing breaks: brings to hand what the next fractures will need, and what a
/// host has named.
void Simulation::prepare_next(const StressSummary& summary) {
  const Scene& scene = problem_->scene();
  if (!backend_->prepares() || ended_early() || done()) return;
  const bool predicts = scene.solver.prepare && row_of(scene.fracture.model).breaks;
  if (!predicts && named_.empty()) return;
  next_in_line_.clear();
  if (predicts) criterion_->next_in_line(fracture_state(summary), next_in_line_);
  next_in_line_.insert(next_in_line_.end(), named_.begin(), named_.end());
  backend_->prepare(next_in_line_);
}

/// Of reactions_, which fracture_state() has read.
std::span<const NodalForce> Simulation::instrument_forces() {
  instrument_forces_.clear();
  const auto& instruments = problem_->scene().instruments;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    if (std::holds_alternative<Grip>(instruments[i].action)) continue;
    const auto nodes = loads_->nodes(i);
    for (Index n : nodes) {
      // What acts on a held axis is taken by the support there and does not reach the body.
      NodalForce at{n, loads_->force(i) / static_cast<double>(nodes.size())};
      for (int axis = 0; axis < 3; ++axis)
        if (problem_->dof(n, axis) == kNone) at.force[axis] = 0;
      instrument_forces_.push_back(at);
    }
  }
  add_grip_forces();
  for (const Tool& tool : loads_->tools()) {
    for (std::size_t n = 0; n < tool.nodes.size(); ++n) {
      NodalForce at{tool.nodes[n], tool.force / static_cast<double>(tool.nodes.size())};
      if (tool.holds) at.force = Vec3(&reactions_.grips[tool.first + 3 * n]);
      for (int axis = 0; axis < 3; ++axis)
        if (problem_->dof(at.node, axis) == kNone) at.force[axis] = 0;
      instrument_forces_.push_back(at);
    }
  }
  return instrument_forces_;
}

void Simulation::add_grip_forces() {
  const auto held = loads_->held_unknowns();
  if (held.empty()) return;
  const auto& instruments = problem_->scene().instruments;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto* grip = std::get_if<Grip>(&instruments[i].action);
    if (!grip || loads_->has_let_go(i)) continue;
    for (Index n : loads_->nodes(i)) {
      NodalForce at{n, Vec3::Zero()};
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem_->dof(n, axis);
        const auto g = std::ranges::lower_bound(held, d) - held.begin();
        if (grip->axes.has(axis)) at.force[axis] = reactions_.grips[static_cast<std::size_t>(g)];
      }
      instrument_forces_.push_back(at);
    }
  }
}

std::span<const double> Simulation::pristine_displacement() {
  if (pristine_.empty()) {
    pristine_.resize(3 * problem_->mesh().nodes.size());
    backend_->solve_pristine(loads_->expansion(), pristine_);
  }
  return pristine_;
}

/// The instrument behind a decision; the backend holds the same solution before and after.
void Simulation::attribute_event() {
  if (decision_->elements.empty()) return;
  const InstrumentForces::Quiet quiet(haptics_.get());  // solutions of other loads
  const Attribution a = attribution(*backend_, *loads_, decision_->elements.front().element);
  backend_->set_load(loads_->load());
  backend_->solve();
  backend_->stress();
  for (DestroyedElement& d : decision_->elements) {
    d.instrument = a.instrument;
    d.instrument_share = a.share;
  }
}

bool Simulation::apply_event() {
  for (const Finding& found : decision_->findings) note(found);
  if (decision_->elements.empty()) return false;
  event_.clear();
  for (DestroyedElement& d : decision_->elements) {
    d.step = now_.next_step;
    d.event = now_.next_event;
    d.load_factor = now_.scene_time;
    if (!d.lives) event_.push_back(d.element);
  }
  if (!event_.empty()) backend_->destroy(event_);
  if (!decision_->change.come.empty()) backend_->change(decision_->change);
  now_.gone += static_cast<int>(event_.size());
  if (backend_->needs().yield) backend_->exclude_candidates(decision_->excluded);
  if (averaged_) averaged_->exclude(decision_->excluded);
  ++now_.next_event;
  ++events_this_step_;
  destroyed_.insert(destroyed_.end(), decision_->elements.begin(), decision_->elements.end());
  end_step_early();
  return true;
}

void Simulation::apply_presets() {
  now_.preset = true;
  if (problem_->scene().cracks.empty()) return;
  *decision_ = criterion_->preset();
  apply_event();
}

void Simulation::apply_removals() {
  const auto& removals = problem_->scene().removals;
  const auto now = [this](const auto& removal) { return removal.step == now_.next_step; };
  if (std::none_of(removals.begin(), removals.end(), now)) return;
  decision_->clear();
  taken_.assign(backend_->destroyed().begin(), backend_->destroyed().end());
  for (std::size_t r = 0; r < removals.size(); ++r) {
    if (removals[r].step != now_.next_step) continue;
    int already = 0;
    for (Index e : problem_->removal_elements()[r]) {
      if (taken_[e]) {
        ++already;
        continue;
      }
      taken_[e] = 1;
      DestroyedElement d;
      d.element = e;
      d.cause = Cause::script;
      decision_->elements.push_back(d);
    }
    if (already > 0) {
      note({Finding::Kind::removed_before, static_cast<int>(r), now_.next_step, already});
    }
  }
  apply_event();
}

void Simulation::find_loose() {
  loose_->look(backend_->destroyed(), criterion_->corners(), backend_->node_count());
  ++looks_;
  now_.loose_nodes = loose_->isolated_nodes();
  now_.loose_pieces = loose_->pieces();
  now_.loose_elements = loose_->elements_cut_off();
  if (now_.loose_nodes > 0 && now_.loose_nodes_step == kNone)
    now_.loose_nodes_step = now_.next_step;
  if (now_.loose_pieces > 0 && now_.loose_pieces_step == kNone)
    now_.loose_pieces_step = now_.next_step;
  leave_out_loose();
}

/// Elements of pieces that have come off in this step; in motion they stay in.
void Simulation::leave_out_loose() {
  if (now_.loose_pieces == 0 || !backend_->needs().stress || problem_->moves()) return;
  now_.cut_off.resize(problem_->mesh().tets.size(), 0);
  newly_cut_off_.clear();
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (now_.cut_off[e] || loose_->piece_of(e) == kNone) continue;
    now_.cut_off[e] = 1;
    newly_cut_off_.push_back(e);
  }
  backend_->cut_off(newly_cut_off_);
}

void Simulation::measure_deformation(StepReport& report) {
  const Deformation d = backend_->deformation();
  report.deformation = d;
  if (d.inverted > 0) now_.inverted.add(now_.next_step, d.inverted);
  if (problem_->finite()) return;  // strains and rotations may be large
  if (std::abs(d.strain) > kSmallStrain) now_.strained.add(now_.next_step, std::abs(d.strain));
  if (d.rotation_deg > kSmallRotationDeg) now_.turned.add(now_.next_step, d.rotation_deg);
}

}  // namespace sunder
