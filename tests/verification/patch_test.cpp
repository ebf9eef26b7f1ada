// SPDX-License-Identifier: Apache-2.0
// Patch test: 192 distorted tetrahedra reproduce every state of constant strain.
#include <gtest/gtest.h>

#include "verification/engine_cases.hpp"

namespace sunder::test {
namespace {

// Backward error of the solution, eps, times the condition of the stiffness that is left: under 1e2
// with the whole surface held, some 1e3 held at three nodes.
constexpr double kHeldSurface = 5e-14, kThreeNodes = 2e-13;

void expect_constant(const PatchErrors& errors, double tolerance) {
  EXPECT_TRUE(errors.u <= tolerance) << errors.u;
  EXPECT_TRUE(errors.stress <= 1e-12) << errors.stress;
  EXPECT_TRUE(errors.residual <= 1e-12) << errors.residual;
}

class Patch : public ::testing::TestWithParam<int> {};  // strain component in Voigt order

TEST_P(Patch, DisplacedSurfaceStrainsTheInsideEvenly) {
  expect_constant(patch_errors(GetParam(), PatchHeld::surface), kHeldSurface);
}

TEST_P(Patch, SurfaceTractionStrainsTheInsideEvenly) {
  expect_constant(patch_errors(GetParam(), PatchHeld::three_nodes), kThreeNodes);
}

INSTANTIATE_TEST_SUITE_P(Strains, Patch, ::testing::Range(0, 6));

}  // namespace
}  // namespace sunder::test
