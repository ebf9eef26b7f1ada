// SPDX-License-Identifier: Apache-2.0
// Model "none": nothing breaks by itself; preset cracks stay as they are and can be pressed on.
#pragma once

#include <optional>

#include "fracture/board.hpp"
#include "fracture/criterion.hpp"

namespace sunder::fracture {

class FixedCracks final : public FractureCriterion {
 public:
  explicit FixedCracks(const Problem& problem) : problem_(problem) {}

  void decide(const FractureState&, Decision& decision) override { decision.clear(); }
  [[nodiscard]] Decision preset() override;
  [[nodiscard]] PressedNodes pressed_nodes(const Press& press,
                                           std::span<const std::uint8_t> destroyed) const override;
  [[nodiscard]] const std::vector<Crack>& cracks() const override { return cracks_; }

 private:
  const Problem& problem_;
  std::optional<Board> board_;  // built only when there are cracks
  std::vector<Crack> cracks_;
};

}  // namespace sunder::fracture
