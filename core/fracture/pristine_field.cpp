// SPDX-License-Identifier: Apache-2.0
#include "fracture/pristine_field.hpp"

#include "body/law_stress.hpp"

namespace sunder::fracture {

std::optional<InPlane> PristineField::at(const Vec2& p) const {
  Voigt sum = Voigt::Zero();
  double volume = 0;
  board_.elements_within(p, kNeighbourhood * board_.h(), near_);
  std::erase_if(near_, [&](Index e) { return !problem_.destructible(e); });
  const std::function<void(std::span<const Index>, std::span<Vec3>)> displacement =
      [this](std::span<const Index> nodes, std::span<Vec3> u) {
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          u[i] = Vec3(&displacement_[3 * static_cast<std::size_t>(nodes[i])]);
        }
      };
  patches_.read(near_, {{}, displacement, {}});
  for (std::size_t i = 0; i < near_.size(); ++i) {
    const Index e = near_[i];
    const TetShape& shape = problem_.shape(e);
    const auto u = fem::corner_displacement(problem_.mesh(), e, displacement_);
    sum += shape.volume * stress_with(patches_, problem_, i, e, u);
    volume += shape.volume;
  }
  if (!(volume > 0)) return std::nullopt;
  return in_plane(sum / volume, board_.plane());
}

}  // namespace sunder::fracture
