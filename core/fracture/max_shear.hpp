// SPDX-License-Identifier: Apache-2.0
// Model A: the maximum shear stress hypothesis alone (method.md "Model A").
#pragma once

#include "fracture/criterion.hpp"

namespace sunder::fracture {

/// Destroys the live breakable element with the largest ratio while it is >= 1, one per event.
/// Keeps no crack records.
class MaxShear final : public FractureCriterion {
 public:
  explicit MaxShear(const Problem& problem) : problem_(problem) {}

  void decide(const FractureState& state, Decision& decision) override;
  void next_in_line(const FractureState& state, std::vector<Index>& next) override;
  [[nodiscard]] Decision preset() override;
  [[nodiscard]] PressedNodes pressed_nodes(const Press& press,
                                           std::span<const std::uint8_t> destroyed) const override;
  [[nodiscard]] const std::vector<Crack>& cracks() const override { return none_; }

 private:
  const Problem& problem_;
  std::vector<Crack> none_;
};

/// The row of a rupture by maximum shear stress; none while the ratio stays under 1.
[[nodiscard]] std::optional<DestroyedElement> rupture(const Worst& worst);

}  // namespace sunder::fracture
