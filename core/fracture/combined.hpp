// SPDX-License-Identifier: Apache-2.0
// Model B: cracks grow by stress intensity factors; where none can, the maximum shear stress
// starts a new one (method.md "Model B").
#pragma once

#include <cstdint>
#include <memory_resource>
#include <utility>
#include <vector>

#include "fracture/band.hpp"
#include "fracture/board.hpp"
#include "fracture/criterion.hpp"
#include "fracture/field_sif/field_growth.hpp"
#include "fracture/present_field.hpp"
#include "fracture/pristine_field.hpp"
#include "fracture/tip_growth.hpp"
#include "fracture/toughness.hpp"

namespace sunder::fracture {

class Combined final : public FractureCriterion {
 public:
  explicit Combined(const Problem& problem);

  void decide(const FractureState& state, Decision& decision) override;
  void next_in_line(const FractureState& state, std::vector<Index>& next) override;
  void tips(const FractureState& state, std::vector<TipState>& tips,
            std::vector<Finding>& findings) override;
  [[nodiscard]] Decision preset() override;
  [[nodiscard]] PressedNodes pressed_nodes(const Press& press,
                                           std::span<const std::uint8_t> destroyed) const override;
  [[nodiscard]] const std::vector<Crack>& cracks() const override { return cracks_; }
  [[nodiscard]] std::shared_ptr<const CriterionState> state() const override;
  void restore(const CriterionState& state) override;

 private:
  struct DrivenTip {
    int crack;
    TipGrowth growth;
  };

  /// What events alone change; states between two of them share it.
  struct Kept {
    std::vector<Crack> cracks;
    std::vector<std::uint8_t> excluded;
  };
  struct State final : CriterionState {
    std::shared_ptr<const Kept> kept;
    std::vector<DrivenTip> driven;
  };

  void reserve(Decision& decision) const;
  /// Fills driven_: K and direction of all tips that have not ended, from one state.
  void drive_tips(const FractureState& state, std::vector<Finding>& findings);
  /// E' that field K takes at a tip, where a toughness asks for it; else 0.
  [[nodiscard]] double young_at(const Crack& crack, std::size_t tip, const FractureState& state);
  /// `view` as it is at a tip.
  [[nodiscard]] const FieldView& at_tip(FieldView& view, const Crack& crack, std::size_t tip,
                                        const FractureState& state);
  void add_toughness(const Crack& crack, const FractureState& state, TipState& tip);
  [[nodiscard]] bool by_field() const { return problem_.scene().fracture.sif == SifSource::field; }
  /// Whether the formula has a remote stress for the crack; says why not, and where it is poor.
  [[nodiscard]] bool formula_holds(const Crack& crack, std::vector<Finding>& findings) const;
  void add_formula_state(const RemoteField& remote, const Crack& crack, const FractureState& state,
                         TipState& tip, std::vector<Finding>& findings);
  /// The field that rules 5 and 8 ask for, as it is in this state.
  [[nodiscard]] const RemoteField& remote_field(const FractureState& state);
  /// What the other criterion says of the same tips, for the rows that will tell.
  void add_other_terms(const FractureState& state);
  /// Moves one tip as far as it goes; its elements are added to the decision.
  void grow(const DrivenTip& driven, const FractureState& state, Decision& decision);
  void take(const DestroyedElement& row, Decision& decision);
  [[nodiscard]] Vec2 heading(const Crack& crack, std::size_t tip) const;
  void cut_through(Crack& crack, const FractureState& state, Decision& decision);
  void start_crack(const FractureState& state, Decision& decision);
  /// Elements that the decision's elements touch, live and not excluded before.
  void exclude_neighbours(Decision& decision);

  const Problem& problem_;
  Board board_;
  FieldIntensityMeter meter_;
  std::vector<double> yields_;  // per element, 0: none
  Toughness toughness_;
  bool anything_destructible_ = false;
  std::pmr::monotonic_buffer_resource lists_;  // of the cracks
  std::vector<Crack> cracks_;
  std::vector<std::uint8_t> excluded_;  // shape (elements)
  std::vector<DrivenTip> driven_;       // of the last decision
  // Of the decision in work, with room from the start: a frame allocates nothing.
  PristineField pristine_;
  PresentField present_;
  BandSearch bands_;
  Walk walk_;
  FacePressure faces_;
  std::vector<std::uint8_t> taken_;  // per element
  std::vector<std::pair<Index, std::int8_t>> labels_;
  std::vector<Finding> untold_;
  mutable std::shared_ptr<const Kept> kept_;  // as of the last state(); null: changed since
};

}  // namespace sunder::fracture
