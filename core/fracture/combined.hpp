// SPDX-License-Identifier: Apache-2.0
// Model B: cracks grow by stress intensity factors; where none can, the maximum shear stress
// starts a new one (method.md "Model B").
#pragma once

#include <cstdint>
#include <vector>

#include "fracture/band.hpp"
#include "fracture/board.hpp"
#include "fracture/criterion.hpp"
#include "fracture/field_sif/field_growth.hpp"
#include "fracture/tip_growth.hpp"

namespace sunder::fracture {

class Combined final : public FractureCriterion {
 public:
  explicit Combined(const Problem& problem);

  [[nodiscard]] Decision decide(const FractureState& state) override;
  void next_in_line(const FractureState& state, std::vector<Index>& next) const override;
  [[nodiscard]] Decision preset() override;
  [[nodiscard]] std::vector<Index> pressed_nodes(
      const Press& press, std::span<const std::uint8_t> destroyed) const override;
  [[nodiscard]] const std::vector<Crack>& cracks() const override { return cracks_; }

 private:
  struct DrivenTip {
    int crack;
    TipGrowth growth;
  };

  /// K and direction of all tips that have not ended, from one state.
  [[nodiscard]] std::vector<DrivenTip> driven_tips(const FractureState& state,
                                                   std::vector<std::string>& warnings);
  [[nodiscard]] bool by_field() const { return problem_.scene().fracture.sif == SifSource::field; }
  /// What the other criterion says of the same tips, for the rows that will tell.
  void add_other_terms(std::vector<DrivenTip>& driven, const FractureState& state);
  /// Moves one tip as far as it goes; its elements are added to the decision.
  void grow(std::vector<DrivenTip>& driven, std::size_t which, const FractureState& state,
            Decision& decision);
  [[nodiscard]] Vec2 heading(const Crack& crack, std::size_t tip) const;
  void cut_through(Crack& crack, const FractureState& state, Decision& decision);
  void start_crack(const FractureState& state, Decision& decision);
  /// Elements that the decision's elements touch, live and not excluded before.
  void exclude_neighbours(Decision& decision);

  const Problem& problem_;
  Board board_;
  FieldIntensityMeter meter_;
  bool anything_breakable_ = false;
  std::vector<Crack> cracks_;
  std::vector<std::uint8_t> excluded_;  // shape (elements)
  std::vector<DrivenTip> driven_;       // of the last decision
};

}  // namespace sunder::fracture
