// SPDX-License-Identifier: Apache-2.0
// Strokes along the fibres of what a picture shows: one on each point of an even grid, of the
// nearest triangle there.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "app/output/state.hpp"

namespace sunder::app {

/// A triangle that looks at the eye, as it is drawn.
struct DrawnTriangle {
  std::array<Vec2, 3> corners;       ///< [px]
  std::array<double, 3> nearness{};  ///< of the corners: the larger one hides the other
  Index element = 0;
};

struct FibreStroke {
  Vec2 from, to;  ///< [px]
  int family = 0;
};

/// `places`: of the nodes of mesh_of(), as they are drawn with `scale` times the displacement.
/// `flat`: a direction of space on the picture [px], as long as it is at most; fibres that point at
/// the eye are short. None where no material has fibres.
[[nodiscard]] std::vector<FibreStroke> fibre_strokes(const Problem& problem, const State& state,
                                                     std::span<const Vec3> places, double scale,
                                                     std::span<const DrawnTriangle> drawn,
                                                     double pixels_per_mm,
                                                     const std::function<Vec2(const Vec3&)>& flat);

}  // namespace sunder::app
