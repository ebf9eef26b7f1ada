// SPDX-License-Identifier: Apache-2.0
#include "fracture/worst_element.hpp"

#include <utility>

#include "fracture/preset_cracks.hpp"
#include "sunder/interfaces.hpp"

namespace sunder::fracture {

std::optional<DestroyedElement> rupture(const Worst& worst, Cause cause) {
  if (worst.element == kNone || !(worst.ratio >= 1)) return std::nullopt;
  DestroyedElement row;
  row.element = worst.element;
  row.cause = cause;
  row.ratio = worst.ratio;
  return row;
}

WorstElement::WorstElement(const Problem& problem, Cause cause) : problem_(problem), cause_(cause) {
  if (problem.interfaces()) pairs_.emplace(problem);
}

void WorstElement::decide(const FractureState& state, Decision& decision) {
  decision.clear();
  if (problem_.moves()) {
    if (!(state.summary.any.ratio >= 1)) return;
    std::vector<std::uint8_t> parted(pairs_ ? problem_.interfaces()->pair_count() : 0, 0);
    for (const Worst& over : state.over()) {
      if (!problem_.in_interface(over.element)) {
        decision.elements.push_back(*rupture(over, cause_));
      } else if (!std::exchange(parted[problem_.interfaces()->pair(over.element)], 1)) {
        pairs_->add_rows({over.element, over.ratio}, state, decision.elements);
      }
    }
    return;
  }
  const Worst& worst = state.summary.any;
  if (pairs_) {
    const PartingPairs::Next next = pairs_->next(state, worst);
    const bool first = next.ratio >= worst.ratio || problem_.in_interface(worst.element);
    if (first && next.ratio >= 1) pairs_->part(next, state, decision.elements);
    if (first) return;
  }
  if (const auto row = rupture(worst, cause_)) decision.elements.push_back(*row);
}

void WorstElement::next_in_line(const FractureState& state, std::vector<Index>& next) {
  next.clear();
  const Index first = state.summary.any.element;
  if (first == kNone) return;
  if (!problem_.in_interface(first)) return next.push_back(first);
  const Interfaces& interfaces = *problem_.interfaces();
  for (Index e : interfaces.elements(interfaces.pair(first))) {
    if (!state.destroyed[static_cast<std::size_t>(e)]) next.push_back(e);
  }
}

Decision WorstElement::preset() {
  Decision decision;
  decision.elements = preset_elements(problem_);
  return decision;
}

namespace {

struct PairState final : CriterionState {
  std::shared_ptr<const PartingPairs::State> pairs;
};

}  // namespace

/// Whatever was decided, the next decision looks at the body and at what its interfaces released.
std::shared_ptr<const CriterionState> WorstElement::state() const {
  auto state = std::make_shared<PairState>();
  if (pairs_) state->pairs = pairs_->state();
  return state;
}

void WorstElement::restore(const CriterionState& of) {
  if (pairs_) pairs_->restore(static_cast<const PairState&>(of).pairs);
}

/// Without crack records there is no face to press on.
PressedNodes WorstElement::pressed_nodes(const Press&, std::span<const std::uint8_t>) const {
  return {};
}

}  // namespace sunder::fracture
