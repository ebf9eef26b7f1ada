// SPDX-License-Identifier: Apache-2.0
// What a host does to a simulation: steps, instruments by hand, elements that it removes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "body/triangle_crossing.hpp"
#include "fracture/averaged_strength.hpp"
#include "fracture/finding.hpp"
#include "frame/act.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder {

void Simulation::drive(std::size_t instrument, const Vec3& value) {
  if (instrument >= problem_->scene().instruments.size()) {
    throw UsageError("there is no instrument " + std::to_string(instrument));
  }
  if (!value.allFinite()) throw UsageError("an instrument's value must be finite");
  refuse_let_go(instrument, "driven");
  act({Action::Drive{instrument, value}}, [&](Action&) { loads_->drive(instrument, value); });
}

void Simulation::refuse_let_go(std::size_t instrument, const std::string& what) const {
  if (!loads_->has_let_go(instrument)) return;
  throw UsageError("instrument " + std::to_string(instrument) + " cannot be " + what +
                   ": it has let go");
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
  refuse_let_go(instrument, "turned");
  act({Action::Turn{instrument, rotation}}, [&](Action&) { loads_->turn(instrument, rotation); });
}

void Simulation::attribute_events(bool wanted) {
  if (wanted && problem_->finite()) {
    throw UsageError("which instrument broke an element cannot be said by law " +
                     in_quotes(problem_->law()) +
                     ": it rests on superposition; leave attribution out, or take law \"linear\"");
  }
  if (wanted && problem_->fibrous()) {
    throw UsageError(
        "which instrument broke an element cannot be said of a body with fibres: attribution knows "
        "isotropic elements alone; leave attribution out");
  }
  act({Action::Attribute{wanted}}, [&](Action&) { now_.attribute = wanted; });
}

void Simulation::set_velocity(std::span<const Vec3> velocity) {
  if (velocity.size() != problem_->mesh().nodes.size()) {
    throw UsageError("one velocity per node");
  }
  act({Action::Velocity{{velocity.begin(), velocity.end()}}}, [&](Action&) {
    backend_->set_velocity({velocity.front().data(), 3 * velocity.size()});
  });
}

StepReport Simulation::take_step(std::optional<double> dt, double max_ms) {
  if (done()) throw UsageError("all steps of the scene are done");
  StepReport report;
  max_ms_ = max_ms;
  began_ = std::chrono::steady_clock::now();
  act({Action::Step{dt}}, [&](Action& action) {
    const auto note_end = [&] {
      auto& step = std::get<Action::Step>(action.what);
      if (ended_early()) step.events = events_this_step_;
      step.by_time = now_.out_of_time_now;
    };
    const double own = problem_->moves() ? problem_->scene().dynamics->time_step : 0;
    try {
      report = compute_step(dt.value_or(own));
    } catch (const NumericalError&) {
      note_end();
      throw;
    }
    note_end();
  });
  finish_frame();
  return report;
}

bool Simulation::replaying() const { return history_ && history_->travels; }

/// After an event: whether the step in work is to end with the solution that follows.
void Simulation::end_step_early() {
  if (!replaying() && observer_ && !observer_(decision_->elements)) now_.interrupted = true;
  if (const Action* again = history_ ? history_->again : nullptr) {
    const auto* step = std::get_if<Action::Step>(&again->what);
    if (!step || step->events != events_this_step_) return;
    // Of a recording that is played the step was ended so; whoever plays it has not ended it.
    (step->by_time || !replaying() ? now_.out_of_time_now : now_.interrupted) = true;
    if (step->by_time) now_.out_of_time.add(now_.next_step);
    return;
  }
  if (!in_work_ || !(max_ms_ > 0) || problem_->moves() || now_.interrupted) return;
  using Milliseconds = std::chrono::duration<double, std::milli>;
  if (Milliseconds(std::chrono::steady_clock::now() - began_).count() < max_ms_) return;
  now_.out_of_time_now = true;
  now_.out_of_time.add(now_.next_step);
}

/// Where a host may change the body. `verb`: what it wants to do, "removed" say.
void Simulation::require_damage(const std::string& verb) const {
  if (backend_->needs().damage) return;
  throw UsageError("nothing can be " + verb +
                   ": the scene has neither fracture nor removals, and was not told that it is "
                   "live before the simulation was made");
}

void Simulation::check_removal(std::span<const Index> elements) const {
  require_damage("removed");
  std::vector<Index> sorted(elements.begin(), elements.end());
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  const auto refuse = [](Index e, const std::string& why) {
    throw UsageError("element " + std::to_string(e) + " cannot be removed: " + why);
  };
  if (twice != sorted.end()) refuse(*twice, "it is named twice");
  for (Index e : elements) {
    if (e < 0 || e >= problem_->tet_count()) refuse(e, "the mesh has none of that number");
    if (backend_->destroyed()[e]) refuse(e, "it is gone already");
  }
  if (now_.preset) return;
  for (const auto& crack : problem_->crack_elements()) {
    for (Index e : crack) {
      if (std::ranges::binary_search(sorted, e)) refuse(e, "it belongs to a preset crack");
    }
  }
}

void Simulation::remove(std::span<const Index> elements) {
  check_removal(elements);
  if (elements.empty()) return;
  act({Action::Remove{{elements.begin(), elements.end()}}}, [&](Action&) { take_out(elements); });
  finish_frame();
}

/// Elements that a blade does not meet: those that are gone, and those that a preset crack takes.
std::vector<std::uint8_t> Simulation::gone_to_blade() const {
  std::vector<std::uint8_t> gone(backend_->destroyed().begin(), backend_->destroyed().end());
  for (const auto& crack : problem_->crack_elements()) {
    for (Index e : crack) gone[static_cast<std::size_t>(e)] = 1;
  }
  return gone;
}

int Simulation::cut(std::span<const std::array<Vec3, 3>> swept) {
  for (const auto& triangle : swept) {
    for (const Vec3& p : triangle) {
      if (!p.allFinite()) throw UsageError("the places of a blade must be finite");
    }
  }
  if (backend_->needs().split) return cut_faces(swept);
  std::vector<Index> passed;
  const std::vector<Vec3> moved = displacement();
  const std::vector<std::uint8_t> gone = gone_to_blade();
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (gone[static_cast<std::size_t>(e)]) continue;
    std::array<Vec3, 4> corners;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto n = static_cast<std::size_t>(problem_->mesh().tets[e][a]);
      corners[a] = problem_->mesh().nodes[n] + moved[n];
    }
    const auto passes = [&](const auto& triangle) { return fem::crosses(triangle, corners); };
    if (std::ranges::any_of(swept, passes)) passed.push_back(e);
  }
  remove(passed);
  return static_cast<int>(passed.size());
}

void Simulation::prepare(std::span<const Index> elements) {
  require_damage("prepared for");
  for (Index e : elements) {
    if (e >= 0 && e < problem_->tet_count()) continue;
    throw UsageError("element " + std::to_string(e) +
                     " cannot be prepared for: the mesh has none of that number");
  }
  const auto first = elements.first(std::min(elements.size(), kNamed));
  named_.assign(first.begin(), first.end());
  reserve_in_line();
  backend_->prepare(named_);
}

int Simulation::prepare(const Vec3& near, double radius) {
  require_damage("prepared for");
  if (!near.allFinite()) throw UsageError("the place to prepare for must be finite");
  if (!(radius > 0) || !std::isfinite(radius)) {
    throw UsageError("the radius around the place to prepare for must be finite and above 0 mm");
  }
  const Mesh body = mesh();
  const std::vector<Vec3> moved = displacement();
  std::vector<std::pair<double, Index>> within;
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (backend_->destroyed()[e]) continue;
    double least = std::numeric_limits<double>::infinity();
    for (Index n : body.tets[static_cast<std::size_t>(e)]) {
      const auto i = static_cast<std::size_t>(n);
      least = std::min(least, (body.nodes[i] + moved[i] - near).norm());
    }
    if (least <= radius) within.emplace_back(least, e);
  }
  std::ranges::sort(within);
  std::vector<Index> elements;
  for (const auto& [distance, e] : within) elements.push_back(e);
  prepare(elements);
  return static_cast<int>(elements.size());
}

int Simulation::cut_faces(std::span<const std::array<Vec3, 3>> swept) {
  std::vector<Vec3> places = mesh().nodes;
  const std::vector<Vec3> moved = displacement();
  for (std::size_t n = 0; n < places.size(); ++n) places[n] += moved[n];
  const auto faces = criterion_->passed(swept, places, gone_to_blade());
  open_faces(faces);
  return static_cast<int>(faces.size());
}

void Simulation::open_faces(const std::vector<fracture::PassedFace>& faces) {
  criterion_->check_opening(faces, gone_to_blade());
  if (faces.empty()) return;
  act({Action::Open{faces}}, [&](Action&) {
    begin_by_hand();
    FractureState state{*problem_, backend_->destroyed(), {}, {}, {}, Vec3::Zero(), {}};
    criterion_->open(faces, state, *decision_);
    finish_by_hand();
  });
}

void Simulation::take_out(std::span<const Index> elements) {
  begin_by_hand();
  for (Index e : elements) {
    DestroyedElement row;
    row.element = e;
    row.cause = Cause::script;
    decision_->elements.push_back(row);
  }
  finish_by_hand();
}

/// An event that a host asks for between two steps.
void Simulation::begin_by_hand() {
  now_.interrupted = now_.out_of_time_now = false;
  events_this_step_ = 0;
  if (!now_.preset) apply_presets();
  decision_->clear();
}

void Simulation::finish_by_hand() {
  apply_event();
  find_loose();
  if (now_.solved && !problem_->moves()) follow_removal();
}

/// The solution of the last load without what has been removed.
void Simulation::follow_removal() {
  of_loads_.clear();
  loads_->update(now_.scene_time, *criterion_, backend_->destroyed(), of_loads_);
  for (const Finding& found : of_loads_) note(found);
  backend_->set_load(loads_->load());
  pristine_.clear();
  if (backend_->solve().polished) now_.polished.add(now_.next_step);
  loads_->solved();
  if (backend_->needs().split) {
    StepReport report;
    settle_lips(report);
  }
  if (!backend_->needs().stress) return;
  backend_->stress();
  if (averaged_) static_cast<void>(averaged_->summarize(*backend_));
}

/// Of a step what comes before its decision; nothing of it shows.
void Simulation::try_load(const Load& load) {
  backend_->set_load(load);
  backend_->solve();
  if (!backend_->needs().stress) return;
  backend_->stress();
  static_cast<void>(backend_->deformation());
  if (averaged_) static_cast<void>(averaged_->summarize(*backend_));
}

void Simulation::warm_up() {
  if (now_.next_step > 0 || now_.solved || problem_->moves() || problem_->finite()) return;
  act({Action::WarmUp{}}, [&](Action&) {
    const auto before = backend_->save();
    const InstrumentForces::Quiet quiet(haptics_.get());
    Load none;
    none.displacements.assign(backend_->gripped_dofs().size(), 0.0);
    try_load(none);
    if (backend_->needs().pristine) {
      std::vector<double> displacement(3 * problem_->mesh().nodes.size());
      backend_->solve_pristine(none, displacement);
    }
    if (before) static_cast<void>(backend_->restore(*before));
    now_.warm = true;
    if (backend_->info().route != "cg") {
      for (const Load& load : loads_->span(1.0 / problem_->scene().steps)) {
        try {
          try_load(load);
        } catch (const NumericalError&) {
          // A way that nobody may go: the step that does will say so.
        }
      }
    }
    if (haptics_) haptics_->withdraw();
  });
}

}  // namespace sunder
