// SPDX-License-Identifier: Apache-2.0
// Cook's membrane: a tapered panel, clamped at x = 0, sheared at x = 48. One layer of cells of
// thickness 1, each cut into six tetrahedra (Kuhn): the diagonals run from the lower left to the
// upper right corner. The other diagonal gives -4.1 % instead of -13.4 % on 16 x 16.
#include <gtest/gtest.h>

#include "verification/engine_cases.hpp"

namespace sunder::test {
namespace {

// Reference values 32.27 (plane strain, E 70, nu 1/3, shear 6.25 per unit area) at (48, 60) and
// 23.96 (plane stress, E 1, nu 1/3, total force 1) at (48, 52); published deviations in percent.
TEST(Cook, PlaneStrainDeviatesAsLinearTetrahedraDo) {
  const std::pair<Index, double> published[] = {{16, -13.4}, {32, -4.8}, {64, -1.7}, {96, -0.9}};
  for (const auto& [cells, percent] : published) {
    const double v = cook_deflection(Plane::strain, cells);
    EXPECT_NEAR(100 * (v / cook_published(Plane::strain) - 1), percent, 0.3)
        << cells << " x " << cells;
  }
}

TEST(Cook, PlaneStressDeviatesAsLinearTetrahedraDo) {
  const std::pair<Index, double> published[] = {{16, -11.5}, {32, -3.3}, {64, -0.9}};
  for (const auto& [cells, percent] : published) {
    const double v = cook_deflection(Plane::stress, cells);
    EXPECT_NEAR(100 * (v / cook_published(Plane::stress) - 1), percent, 0.3)
        << cells << " x " << cells;
  }
}

}  // namespace
}  // namespace sunder::test
