// SPDX-License-Identifier: Apache-2.0
// Strength alone (method.md "Model A"): what a further model of that kind measures stands in its
// row (criterion.cpp).
#pragma once

#include "fracture/criterion.hpp"
#include "fracture/parting_pairs.hpp"

namespace sunder::fracture {

/// Destroys the live breakable element with the largest ratio while it is >= 1, one per event; in
/// motion, where a step has one event, all with a ratio >= 1. Of an interface the springs between
/// two nodes are one. Keeps no crack records.
class WorstElement final : public FractureCriterion {
 public:
  /// `cause`: what the rows of its events say.
  WorstElement(const Problem& problem, Cause cause);

  void decide(const FractureState& state, Decision& decision) override;
  void next_in_line(const FractureState& state, std::vector<Index>& next) override;
  [[nodiscard]] Decision preset() override;
  [[nodiscard]] PressedNodes pressed_nodes(const Press& press,
                                           std::span<const std::uint8_t> destroyed) const override;
  [[nodiscard]] const std::vector<Crack>& cracks() const override { return none_; }
  [[nodiscard]] std::shared_ptr<const CriterionState> state() const override;
  void restore(const CriterionState& of) override;

 private:
  const Problem& problem_;
  Cause cause_;
  std::optional<PartingPairs> pairs_;  // where there are interfaces
  std::vector<Crack> none_;
};

/// The row of a rupture by strength; none while the ratio stays under 1.
[[nodiscard]] std::optional<DestroyedElement> rupture(const Worst& worst, Cause cause);

}  // namespace sunder::fracture
