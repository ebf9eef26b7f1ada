// SPDX-License-Identifier: Apache-2.0
#include "fracture/pristine_field.hpp"

#include "body/law_stress.hpp"

namespace sunder::fracture {

std::optional<InPlane> PristineField::at(const Vec2& p) const {
  Voigt sum = Voigt::Zero();
  double volume = 0;
  board_.elements_within(p, kNeighbourhood * board_.h(), near_);
  for (Index e : near_) {
    if (!problem_.destructible(e)) continue;
    const TetShape& shape = problem_.shape(e);
    const auto u = fem::corner_displacement(problem_.mesh(), e, displacement_);
    sum += shape.volume * fem::material_stress(problem_, e, u);
    volume += shape.volume;
  }
  if (!(volume > 0)) return std::nullopt;
  return in_plane(sum / volume, board_.plane());
}

}  // namespace sunder::fracture
