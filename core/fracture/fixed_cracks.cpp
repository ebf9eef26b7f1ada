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

PressedNodes FixedCracks::pressed_nodes(const Press& press,
                                        std::span<const std::uint8_t> destroyed) const {
  if (press.crack < 0 || static_cast<std::size_t>(press.crack) >= cracks_.size()) return {};
  return fracture::pressed_nodes(*board_, cracks_[press.crack], press, destroyed);
}

}  // namespace sunder::fracture
