// SPDX-License-Identifier: Apache-2.0
#include "fracture/fixed_cracks.hpp"

#include "fracture/crack_birth.hpp"
#include "fracture/preset_cracks.hpp"
#include "fracture/pressed_nodes.hpp"

namespace sunder::fracture {

Decision FixedCracks::preset() {
  const Scene& scene = problem_.scene();
  board_.emplace(problem_.mesh(), scene.fracture.plane_normal);
  for (std::size_t c = 0; c < scene.cracks.size(); ++c)
    cracks_.push_back(
        preset_crack(*board_, scene.cracks[c], static_cast<int>(c), problem_.crack_elements()[c]));
  Decision decision;
  decision.elements = preset_elements(problem_);
  return decision;
}

std::shared_ptr<const CriterionState> FixedCracks::state() const {
  auto state = std::make_shared<State>();
  state->cracks = cracks_.size();
  return state;
}

/// Before the presets there were none, since then they are as they are.
void FixedCracks::restore(const CriterionState& state) {
  const auto cracks = static_cast<std::ptrdiff_t>(dynamic_cast<const State&>(state).cracks);
  cracks_.erase(cracks_.begin() + cracks, cracks_.end());
}

void FixedCracks::tips(const FractureState& state, std::vector<TipState>& tips,
                       std::vector<Finding>& findings) {
  if (cracks_.empty()) return;
  const bool by_field = problem_.scene().fracture.sif == SifSource::field;
  if (by_field && !meter_) meter_.emplace(problem_, *board_);
  FieldView view{state.destroyed, state.displacement, state.forces()};
  view.pools = state.pools;
  for (const Crack& crack : cracks_) {
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      tips.push_back(tip_state(*board_, crack, tip));
      if (by_field && !crack.tips[tip].ended)
        add_field_state(*meter_, crack, tip, view, tips.back(), findings);
    }
  }
}

PressedNodes FixedCracks::pressed_nodes(const Press& press,
                                        std::span<const std::uint8_t> destroyed) const {
  if (press.crack < 0 || static_cast<std::size_t>(press.crack) >= cracks_.size()) return {};
  return fracture::pressed_nodes(*board_, cracks_[press.crack], press, destroyed);
}

}  // namespace sunder::fracture
