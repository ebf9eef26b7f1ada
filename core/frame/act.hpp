// SPDX-License-Identifier: Apache-2.0
// What every action of a host goes through.
#pragma once

#include "frame/history.hpp"
#include "sunder/error.hpp"

namespace sunder {

/// Does something and, where a history is kept, takes it down.
template <class Do>
void Simulation::act(Action action, Do&& body) {
  if (!history_) {
    body(action);
    return;
  }
  const auto before = action.undoable() && history_->quick > 0 ? keep() : nullptr;
  const int events = now_.next_event;
  try {
    body(action);
  } catch (const NumericalError&) {
    action.failed = true;
    record(std::move(action), before, events);
    throw;
  }
  record(std::move(action), before, events);
}

}  // namespace sunder
