// SPDX-License-Identifier: Apache-2.0
// A recording played step by step, before observers: the same actions, each step ended after the
// event that it was ended after.
#include <utility>

#include "frame/action_bytes.hpp"
#include "frame/history.hpp"
#include "sunder/error.hpp"

namespace sunder {

void Simulation::open_recording(std::span<const std::uint8_t> bytes) {
  if (history_ || now_.next_step > 0 || now_.next_event > 0 || now_.solved) {
    throw UsageError("a recording is played from the beginning, before anything else is done");
  }
  const BackendInfo info = backend_->info();
  const bool live = problem_->scene().live;
  std::vector<std::uint64_t> bodies{fingerprint(*problem_, info, live)};
  // Where nothing breaks by itself it decides the region of route condensed, and nothing else.
  if (info.route != "condensed") bodies.push_back(fingerprint(*problem_, info, !live));
  Actions actions = from_bytes(bytes, bodies);
  keep_history({}, 0);
  history_->recording = std::move(actions);
}

bool Simulation::reach_recorded_step() {
  require_history();
  History& h = *history_;
  for (; h.played < h.recording.size(); ++h.played) {
    const auto& action = h.recording[h.played];
    if (std::holds_alternative<Action::Step>(action->what) && !action->failed) return true;
    perform(action);
  }
  return false;
}

StepReport Simulation::recorded_step() {
  if (!reach_recorded_step()) throw UsageError("all steps of the recording are done");
  History& h = *history_;
  h.again = h.recording[h.played++].get();
  const struct Done {
    History& h;
    ~Done() { h.again = nullptr; }
  } done{h};
  return take_step(std::get<Action::Step>(h.again->what).dt, 0);
}

}  // namespace sunder
