// SPDX-License-Identifier: Apache-2.0
// Model "none": nothing breaks by itself; preset cracks stay as they are and can be pressed on.
#pragma once

#include <optional>

#include "fracture/board.hpp"
#include "fracture/criterion.hpp"
#include "fracture/field_sif/field_growth.hpp"

namespace sunder::fracture {

class FixedCracks final : public FractureCriterion {
 public:
  explicit FixedCracks(const Problem& problem) : problem_(problem) {}

  void decide(const FractureState&, Decision& decision) override { decision.clear(); }
  void tips(const FractureState& state, std::vector<TipState>& tips,
            std::vector<Finding>& findings) override;
  [[nodiscard]] Decision preset() override;
  [[nodiscard]] PressedNodes pressed_nodes(const Press& press,
                                           std::span<const std::uint8_t> destroyed) const override;
  [[nodiscard]] const std::vector<Crack>& cracks() const override { return cracks_; }
  [[nodiscard]] std::shared_ptr<const CriterionState> state() const override;
  void restore(const CriterionState& state) override;

 private:
  struct State final : CriterionState {
    std::size_t cracks = 0;
  };

  const Problem& problem_;
  std::optional<Board> board_;                // built only when there are cracks
  std::optional<FieldIntensityMeter> meter_;  // only when somebody asks for K
  std::vector<Crack> cracks_;
};

}  // namespace sunder::fracture
