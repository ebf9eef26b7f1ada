// SPDX-License-Identifier: Apache-2.0
// Model B by split cracks (method.md "Split cracks"): cracks are surfaces of faces that open, grown
// by K from the field; where none grows, strength opens a small new one. Nothing is destroyed.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "body/pieces.hpp"
#include "fracture/board.hpp"
#include "fracture/criterion.hpp"
#include "fracture/field_sif/field_growth.hpp"
#include "fracture/split/split_front.hpp"
#include "fracture/split/split_lips.hpp"
#include "fracture/toughness.hpp"

namespace sunder::fracture {

class SplitCracks final : public FractureCriterion {
 public:
  explicit SplitCracks(const Problem& problem);

  void decide(const FractureState& state, Decision& decision) override;
  void tips(const FractureState& state, std::vector<TipState>& tips,
            std::vector<Finding>& findings) override;
  [[nodiscard]] Decision preset() override;
  [[nodiscard]] PressedNodes pressed_nodes(const Press& press,
                                           std::span<const std::uint8_t> destroyed) const override;
  [[nodiscard]] LipState look_at_lips(const FractureState& state) override {
    return lips_.look(faces(), cracks_, state);
  }
  [[nodiscard]] std::vector<PassedFace> passed(std::span<const std::array<Vec3, 3>> blade,
                                               std::span<const Vec3> places,
                                               std::span<const std::uint8_t> gone) const override;
  void check_opening(std::span<const PassedFace> faces,
                     std::span<const std::uint8_t> gone) override;
  void open(std::span<const PassedFace> faces, const FractureState& state,
            Decision& decision) override;
  [[nodiscard]] const std::vector<Crack>& cracks() const override { return cracks_; }
  [[nodiscard]] std::vector<CrackFace> faces() const override;
  [[nodiscard]] std::span<const std::array<Index, 4>> corners() const override {
    return body_.corners();
  }
  void hold(std::span<const Index> unknowns) override {
    body_.hold(unknowns);
    loose_.hold(unknowns, {});
  }
  [[nodiscard]] std::shared_ptr<const CriterionState> state() const override;
  void restore(const CriterionState& of) override;

 private:
  struct Driven {
    int crack;
    TipGrowth growth;
  };
  /// What events alone change; states between two of them share it.
  struct Kept {
    std::vector<Crack> cracks;
    std::vector<SplitCrack> splits;
    std::vector<std::uint8_t> excluded;
    SplitBody::State body;
  };
  struct State final : CriterionState {
    std::shared_ptr<const Kept> kept;
    SplitLips::State lips;
  };
  [[nodiscard]] FieldView view(const FractureState& state) const;
  [[nodiscard]] FieldView::Lips lips_at(const Crack& crack, std::size_t tip) const;
  [[nodiscard]] Crack measured(const Crack& crack, std::size_t tip) const;
  void grow(const Driven& driven, const FractureState& state, Decision& decision);
  void bear(const FractureState& state, Decision& decision);
  void follow(const SplitStep& step, Decision& decision) const;
  void exclude(const SplitCrack& split, Decision& decision);
  [[nodiscard]] bool full() const;
  /// E' that field K takes at a tip, where a toughness asks for it; else 0.
  [[nodiscard]] double young_at(const Crack& crack, std::size_t tip, const FieldView& field);
  /// `field` as it is at a tip.
  [[nodiscard]] const FieldView& at_tip(FieldView& field, const Crack& crack, std::size_t tip);
  [[nodiscard]] Index ahead(const Crack& crack, std::size_t tip, const Vec2& direction,
                            std::span<const std::uint8_t> destroyed) const;
  void add_toughness(const Crack& crack, std::size_t tip, const FieldView& field, TipState& state);
  [[nodiscard]] std::array<Index, 3> outward(const Face& face) const;
  void end_passed_tips(const fem::Change& change);
  void tie_what_is_loose(const FractureState& state, Decision& decision);

  const Problem& problem_;
  Board board_;
  FieldIntensityMeter meter_;
  Toughness toughness_;
  SplitBody body_;
  SplitFront front_;
  SplitLips lips_;
  LooseSearch loose_;
  bool ran_through_ = false;  // a tip of the decision in work
  Index most_nodes_;
  std::vector<Crack> cracks_;
  std::vector<SplitCrack> splits_;  // of each crack
  std::vector<std::uint8_t> excluded_;
  std::vector<Driven> driven_;
  mutable std::shared_ptr<const Kept> kept_;  // as of the last state(); null: changed since
};

}  // namespace sunder::fracture
