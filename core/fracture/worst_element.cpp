// SPDX-License-Identifier: Apache-2.0
#include "fracture/worst_element.hpp"

#include "fracture/preset_cracks.hpp"

namespace sunder::fracture {

std::optional<DestroyedElement> rupture(const Worst& worst, Cause cause) {
  if (worst.element == kNone || !(worst.ratio >= 1)) return std::nullopt;
  DestroyedElement row;
  row.element = worst.element;
  row.cause = cause;
  row.ratio = worst.ratio;
  return row;
}

void WorstElement::decide(const FractureState& state, Decision& decision) {
  decision.clear();
  if (problem_.moves()) {
    if (!(state.summary.any.ratio >= 1)) return;
    for (const Worst& over : state.over()) {
      decision.elements.push_back(*rupture(over, cause_));
    }
    return;
  }
  if (const auto row = rupture(state.summary.any, cause_)) decision.elements.push_back(*row);
}

void WorstElement::next_in_line(const FractureState& state, std::vector<Index>& next) {
  next.clear();
  if (state.summary.any.element != kNone) next.push_back(state.summary.any.element);
}

Decision WorstElement::preset() {
  Decision decision;
  decision.elements = preset_elements(problem_);
  return decision;
}

/// Whatever was decided, the next decision looks at the body alone.
std::shared_ptr<const CriterionState> WorstElement::state() const {
  return std::make_shared<const CriterionState>();
}

/// Without crack records there is no face to press on.
PressedNodes WorstElement::pressed_nodes(const Press&, std::span<const std::uint8_t>) const {
  return {};
}

}  // namespace sunder::fracture
