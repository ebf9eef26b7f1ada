// SPDX-License-Identifier: Apache-2.0
#include "sunder/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "body/law_stress.hpp"
#include "body/pieces.hpp"
#include "fracture/averaged_strength.hpp"
#include "fracture/criterion.hpp"
#include "fracture/finding.hpp"
#include "frame/attribution.hpp"
#include "frame/loads.hpp"
#include "frame/needs.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/in_quotes.hpp"
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
  constexpr std::size_t kDestroyed = 1 << 16, kFindings = 256, kInLine = 1 << 14;
  const std::size_t elements = problem_->mesh().tets.size();
  if (backend_->needs().damage) destroyed_.reserve(std::min(elements, kDestroyed));
  if (backend_->needs().damage) event_.reserve(std::min(elements, kDestroyed));
  if (!problem_->scene().removals.empty()) taken_.reserve(elements);
  if (backend_->needs().damage && backend_->needs().stress) {
    cut_off_.reserve(elements);
    newly_cut_off_.reserve(std::min(elements, kDestroyed));
  }
  if (backend_->needs().pristine) pristine_.reserve(3 * problem_->mesh().nodes.size());
  findings_.reserve(kFindings);
  of_loads_.reserve(kFindings);
  next_in_line_.reserve(std::min(elements, kInLine));
  std::size_t nodes = 0;
  for (const InstrumentNodes& i : problem_->instrument_nodes()) {
    nodes += std::max(i.nodes.size(), std::size_t{2});  // a press has up to two
    reactions_.displacement.reserve(std::max(i.nodes.size(), std::size_t{2}));
  }
  instrument_forces_.reserve(nodes);
  reactions_.forces.reserve(problem_->scene().instruments.size());
}

Simulation::~Simulation() = default;

StepReport Simulation::step() {
  return compute_step(problem_->moves() ? problem_->scene().dynamics->time_step : 0);
}

StepReport Simulation::step(double dt) {
  if (!problem_->moves()) throw UsageError("a step of time needs a scene with [dynamics]");
  if (!(dt > 0) || !std::isfinite(dt)) {
    throw UsageError("a step of time must be finite and above 0 s");
  }
  return compute_step(dt);
}

StepReport Simulation::compute_step(double dt) {
  if (done()) throw UsageError("all steps of the scene are done");
  const bool moves = problem_->moves();
  const int steps = problem_->scene().steps;
  const double time_step = moves ? problem_->scene().dynamics->time_step : 0;
  const bool even = even_ && dt == time_step;  // sums of time round, multiples do not
  const double time = even ? (next_step_ + 1) * time_step : time_ + dt;
  scene_time_ = even ? (next_step_ + 1.0) / steps : time / (steps * time_step);
  StepReport report;
  const Shown shown(in_work_, report);
  report.step = next_step_;
  report.load_factor = scene_time_;
  interrupted_ = false;
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
      if (next_step_ == 0) apply_presets();
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
      if (frame_observer_) frame_observer_();
      if (report.unfinished) break;  // a body on its way: nothing is decided
      {
        const Timer timer(times.decide);
        decide(summary);
      }
      {
        const Timer timer(times.update);
        if (attribute_) attribute_event();
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
  report.destroyed = gone_;
  report.compliance = compliance();
  report.passes = backend_->take_pass_times();
  if (moves) {
    report.motion = backend_->motion();
    report.motion->time = time;  // a sum of steps rounds
  }
  time_ = time;
  even_ = even;
  ++next_step_;
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
      note({Finding::Kind::lips_unsettled, next_step_});
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
  lip_overlap_ = std::max(lip_overlap_, lips.overlap);
}

/// The last step has nobody to go on from it: it is finished, or the backend refuses it.
SolveReport Simulation::solve() {
  SolveReport report = backend_->solve();
  const bool last = next_step_ + 1 == problem_->scene().steps;
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
  report.destroyed = gone_;
  report.compliance = compliance();
  return report;
}

void Simulation::record_solve(const SolveReport& solve, StepReport& report) {
  solved_ = true;
  report.residual = solve.residual;
  report.error = solve.error;
  report.iterations += solve.iterations;
  report.back_solves += solve.back_solves;
  report.unfinished = solve.unfinished;
  report.capped = solve.capped;
  if (solve.capped) cut_short_.add(next_step_);
  report.polished = report.polished || solve.polished;
  if (solve.polished) polished_.add(next_step_);
  if (solve.unfinished) unfinished_.add(next_step_);
}

FractureState Simulation::fracture_state(const StressSummary& summary) {
  read(reactions_);
  const std::vector<Vec3>& forces = reactions_.forces;
  Vec3 resultant = Vec3::Zero();
  const auto& instruments = problem_->scene().instruments;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (!std::holds_alternative<Press>(instruments[i].action)) resultant += forces[i];
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
    const double ratio = yield_measure(backend_->read_stress(e), measure) / problem_->yield(e);
    if (ratio >= 1) over_.push_back({e, ratio});
  }
  return over_;
}

void Simulation::decide(const StressSummary& summary) {
  decision_->clear();
  if (!row_of(problem_->scene().fracture.model).breaks || interrupted_) return;
  if (decisions_this_step_ >= problem_->scene().fracture.max_events) {
    capped_.add(next_step_);
    return;
  }
  criterion_->decide(fracture_state(summary), *decision_);
  if (!decision_->elements.empty()) ++decisions_this_step_;
}

/// In a frame in which nothing breaks: brings to hand what the next fractures will need.
void Simulation::prepare_next(const StressSummary& summary) {
  const Scene& scene = problem_->scene();
  if (!scene.solver.prepare || !backend_->prepares() || interrupted_ || done()) return;
  if (!row_of(scene.fracture.model).breaks) return;
  criterion_->next_in_line(fracture_state(summary), next_in_line_);
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
  return instrument_forces_;
}

void Simulation::add_grip_forces() {
  const auto gripped = problem_->gripped_dofs();
  if (gripped.empty()) return;
  const auto& instruments = problem_->scene().instruments;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto* grip = std::get_if<Grip>(&instruments[i].action);
    if (!grip) continue;
    for (Index n : loads_->nodes(i)) {
      NodalForce at{n, Vec3::Zero()};
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem_->dof(n, axis);
        const auto g = std::lower_bound(gripped.begin(), gripped.end(), d) - gripped.begin();
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

void Simulation::drive(std::size_t instrument, const Vec3& value) {
  if (instrument >= problem_->scene().instruments.size()) {
    throw UsageError("there is no instrument " + std::to_string(instrument));
  }
  if (!value.allFinite()) throw UsageError("an instrument's value must be finite");
  loads_->drive(instrument, value);
}

void Simulation::turn(std::size_t instrument, const Vec3& rotation) {
  const auto& instruments = problem_->scene().instruments;
  const auto* grip = instrument < instruments.size()
                         ? std::get_if<Grip>(&instruments[instrument].action)
                         : nullptr;
  if (!grip || !grip->rigid) {
    throw UsageError("instrument " + std::to_string(instrument) + " is no rigid grip");
  }
  if (!rotation.allFinite()) throw UsageError("a grip's turn must be finite");
  loads_->turn(instrument, rotation);
}

void Simulation::attribute_events(bool wanted) {
  if (wanted && problem_->finite()) {
    throw UsageError("which instrument broke an element cannot be said by law " +
                     in_quotes(problem_->law()) +
                     ": it rests on superposition; leave attribution out, or take law \"linear\"");
  }
  attribute_ = wanted;
}

/// The instrument behind a decision; the backend holds the same solution before and after.
void Simulation::attribute_event() {
  if (decision_->elements.empty()) return;
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
    d.step = next_step_;
    d.event = next_event_;
    d.load_factor = scene_time_;
    if (!d.lives) event_.push_back(d.element);
  }
  if (!event_.empty()) backend_->destroy(event_);
  if (!decision_->change.come.empty()) backend_->change(decision_->change);
  gone_ += static_cast<int>(event_.size());
  if (backend_->needs().yield) backend_->exclude_candidates(decision_->excluded);
  if (averaged_) averaged_->exclude(decision_->excluded);
  ++next_event_;
  ++events_this_step_;
  destroyed_.insert(destroyed_.end(), decision_->elements.begin(), decision_->elements.end());
  if (observer_ && !observer_(decision_->elements)) interrupted_ = true;
  return true;
}

void Simulation::apply_presets() {
  if (problem_->scene().cracks.empty()) return;
  *decision_ = criterion_->preset();
  apply_event();
}

void Simulation::apply_removals() {
  const auto& removals = problem_->scene().removals;
  const auto now = [this](const auto& removal) { return removal.step == next_step_; };
  if (std::none_of(removals.begin(), removals.end(), now)) return;
  decision_->clear();
  taken_.assign(backend_->destroyed().begin(), backend_->destroyed().end());
  for (std::size_t r = 0; r < removals.size(); ++r) {
    if (removals[r].step != next_step_) continue;
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
      note({Finding::Kind::removed_before, static_cast<int>(r), next_step_, already});
    }
  }
  apply_event();
}

void Simulation::find_loose() {
  loose_->look(backend_->destroyed(), criterion_->corners(), backend_->node_count());
  loose_nodes_ = loose_->isolated_nodes();
  loose_pieces_ = loose_->pieces();
  loose_elements_ = loose_->elements_cut_off();
  if (loose_nodes_ > 0 && loose_nodes_step_ == kNone) loose_nodes_step_ = next_step_;
  if (loose_pieces_ > 0 && loose_pieces_step_ == kNone) loose_pieces_step_ = next_step_;
  leave_out_loose();
}

/// Elements of pieces that have come off in this step; in motion they stay in.
void Simulation::leave_out_loose() {
  if (loose_pieces_ == 0 || !backend_->needs().stress || problem_->moves()) return;
  cut_off_.resize(problem_->mesh().tets.size(), 0);
  newly_cut_off_.clear();
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (cut_off_[e] || loose_->piece_of(e) == kNone) continue;
    cut_off_[e] = 1;
    newly_cut_off_.push_back(e);
  }
  backend_->cut_off(newly_cut_off_);
}

void Simulation::measure_deformation(StepReport& report) {
  const Deformation d = backend_->deformation();
  report.deformation = d;
  if (d.inverted > 0) inverted_.add(next_step_, d.inverted);
  if (problem_->finite()) return;  // strains and rotations may be large
  if (std::abs(d.strain) > kSmallStrain) strained_.add(next_step_, std::abs(d.strain));
  if (d.rotation_deg > kSmallRotationDeg) turned_.add(next_step_, d.rotation_deg);
}

const std::vector<Crack>& Simulation::cracks() const { return criterion_->cracks(); }

Mesh Simulation::mesh() const {
  Mesh mesh = problem_->mesh();
  const auto corners = criterion_->corners();
  if (corners.empty()) return mesh;
  mesh.nodes.resize(static_cast<std::size_t>(backend_->node_count()));
  for (std::size_t e = 0; e < corners.size(); ++e) {
    for (std::size_t a = 0; a < 4; ++a) {
      mesh.nodes[static_cast<std::size_t>(corners[e][a])] =
          problem_->mesh().nodes[static_cast<std::size_t>(problem_->mesh().tets[e][a])];
    }
    mesh.tets[e] = corners[e];
  }
  return mesh;
}

std::vector<CrackFace> Simulation::crack_faces() const { return criterion_->faces(); }

std::vector<TipState> Simulation::tips() {
  std::vector<TipState> tips;
  if (!solved_) return tips;
  std::vector<Finding> found;
  criterion_->tips(fracture_state({}), tips, found);
  for (const Finding& finding : found) note(finding);
  return tips;
}

std::vector<Vec3> Simulation::reactions() const {
  Reactions r;
  read(r);
  return r.forces;
}

void Simulation::read(Reactions& r) const {
  r.forces.clear();
  for (std::size_t i = 0; i < problem_->scene().instruments.size(); ++i) {
    r.forces.push_back(loads_->force(i));
  }
  r.grips.resize(problem_->gripped_dofs().size());
  if (r.grips.empty()) return;
  backend_->read_reactions(r.grips);
  for (std::size_t g = 0; g < r.grips.size(); ++g) {
    r.grips[g] -= loads_->weight_on_grip(g);
    const auto& of = loads_->gripped()[g];
    r.forces[of.instrument][of.axis] += r.grips[g];
  }
}

Vec3 Simulation::support_reaction() const {
  const std::vector<Vec3> displacement = this->displacement();
  std::vector<double> u(3 * problem_->mesh().nodes.size());  // of the element in work
  const auto destroyed = backend_->destroyed();
  const auto split = criterion_->corners();
  Vec3 sum = -loads_->force_on_supports();
  if (problem_->moves()) sum += backend_->held_beside();
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    const auto& tet = problem_->mesh().tets[e];
    const auto& corners = split.empty() ? tet : split[static_cast<std::size_t>(e)];
    const auto held = [&](int a, int axis) { return problem_->dof(tet[a], axis) == kNone; };
    Eigen::Matrix<double, 3, 4> forces;
    bool known = false;
    for (int a = 0; a < 4; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!held(a, axis)) continue;
        if (!known) {
          for (std::size_t c = 0; c < 4; ++c) {
            std::copy_n(displacement[static_cast<std::size_t>(corners[c])].data(), 3,
                        u.data() + 3 * static_cast<std::size_t>(tet[c]));
          }
          forces = fem::corner_forces(*problem_, e, u, destroyed[e] != 0);
        }
        known = true;
        sum[axis] += forces(axis, a);
      }
    }
  }
  return sum;
}

std::vector<Index> Simulation::acting_nodes(std::size_t instrument) const {
  const auto nodes = loads_->nodes(instrument);
  return {nodes.begin(), nodes.end()};
}

/// Of a rigid grip: what its forces do beyond their resultant.
double Simulation::work_of_turn(std::size_t instrument, const Vec3& displacement) const {
  double work = 0;
  for (std::size_t g = 0; g < loads_->gripped().size(); ++g) {
    const auto& of = loads_->gripped()[g];
    if (of.instrument != instrument) continue;
    work += reactions_.grips[g] * (loads_->load().displacements[g] - displacement[of.axis]);
  }
  return work;
}

double Simulation::compliance() {
  read(reactions_);
  const std::vector<Vec3>& forces = reactions_.forces;
  std::vector<Vec3>& u = reactions_.displacement;
  double work = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (problem_->scene().instruments.empty()) break;
    const auto* grip = std::get_if<Grip>(&problem_->scene().instruments[i].action);
    if (grip) {
      const Vec3 displacement = loads_->value(i, scene_time_);
      for (int axis = 0; axis < 3; ++axis) {
        if (grip->axes.has(axis)) work += forces[i][axis] * displacement[axis];
      }
      if (grip->rigid) work += work_of_turn(i, displacement);
      continue;
    }
    const auto nodes = loads_->nodes(i);
    if (nodes.empty()) continue;
    u.resize(nodes.size());
    backend_->read_displacement(nodes, u);
    Vec3 mean = Vec3::Zero();
    for (const Vec3& v : u) mean += v;
    work += forces[i].dot(mean) / static_cast<double>(nodes.size());
  }
  return work;
}

std::vector<Vec3> Simulation::velocity() const {
  std::vector<Vec3> result(problem_->mesh().nodes.size());
  backend_->read_velocity({result.front().data(), 3 * result.size()});
  return result;
}

void Simulation::set_velocity(std::span<const Vec3> velocity) {
  if (velocity.size() != problem_->mesh().nodes.size()) {
    throw UsageError("one velocity per node");
  }
  backend_->set_velocity({velocity.front().data(), 3 * velocity.size()});
}

std::vector<Vec3> Simulation::displacement() const {
  std::vector<Vec3> result(problem_->mesh().nodes.size(), Vec3::Zero());
  if (!solved_) return result;
  if (backend_->node_count() > problem_->node_count()) {
    result.resize(static_cast<std::size_t>(backend_->node_count()));
    std::vector<Index> nodes(result.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    backend_->read_displacement(nodes, result);
    return result;
  }
  std::vector<double> flat(3 * result.size());
  backend_->read_displacement(flat);
  for (std::size_t n = 0; n < result.size(); ++n) {
    result[n] = Vec3(flat[3 * n], flat[3 * n + 1], flat[3 * n + 2]);
  }
  return result;
}

std::vector<Voigt> Simulation::stress() const {
  std::vector<Voigt> result(problem_->mesh().tets.size(), Voigt::Zero());
  if (!backend_->needs().stress) throw UsageError("stress was left out of this simulation");
  if (solved_) backend_->read_stress(result);
  return result;
}

}  // namespace sunder
