// SPDX-License-Identifier: Apache-2.0
// Cantilever 10 x 1 x 1 under end shear against Timoshenko: P L^3/(3 E I) + P L/(k G A), k = 5/6,
// E 5, nu 0, P 1e-3 gives 0.8 + 0.0048. Cubes cut into six tetrahedra (Kuhn).
#include <gtest/gtest.h>

#include "verification/engine_cases.hpp"

namespace sunder::test {
namespace {

// Published deviations of correct linear tetrahedra, in percent; 0.3 points leave room for the
// choice of end point.
TEST(Cantilever, DeviatesFromTimoshenkoAsLinearTetrahedraDo) {
  const std::pair<Index, double> published[] = {{2, -45}, {4, -17.6}, {6, -8.7}};
  for (const auto& [cells, percent] : published) {
    for (int axis : {1, 2}) {
      const double deviation = 100 * (mean_end_deflection(cells, axis) / kTimoshenko - 1);
      EXPECT_NEAR(deviation, percent, 0.3) << 60 * cells * cells * cells << " tets, axis " << axis;
    }
  }
}

}  // namespace
}  // namespace sunder::test
