// SPDX-License-Identifier: Apache-2.0
// Nearly incompressible bodies: patches of pooled volume do not lock, elements do.
#include <gtest/gtest.h>

#include <cmath>

#include "verification/pooled_cases.hpp"

namespace sunder::test {
namespace {

using enum MaterialVolume;

TEST(PooledVolume, ThickCylinderIsRightAtEveryPoissonsRatio) {
  for (double nu : {0.3, 0.4, 0.49, 0.499, 0.4999}) {
    const LameErrors errors = lame_errors(pooled, nu, 8);
    EXPECT_LE(std::abs(errors.u), 0.01) << nu;
    EXPECT_LE(errors.tresca, 0.03) << nu;
  }
  const LameErrors locked = lame_errors(element, 0.499, 12);  // what the warning says
  EXPECT_NEAR(locked.u, -0.16, 0.01);
}

TEST(PooledVolume, ThickCylinderConverges) {
  const LameErrors coarse = lame_errors(pooled, 0.4999, 8), fine = lame_errors(pooled, 0.4999, 16);
  EXPECT_LE(std::abs(fine.u), std::abs(coarse.u) / 3);
  EXPECT_LE(fine.tresca, coarse.tresca / 1.8);
}

// Bending of coarse meshes stays stiff: 8 % on 16 x 16.
TEST(PooledVolume, CooksMembraneConvergesWhereElementsLock) {
  const double coarse = incompressible_cook(pooled, 16), fine = incompressible_cook(pooled, 32),
               finest = incompressible_cook(pooled, 64);
  EXPECT_GT(coarse, 0.92 * finest);
  EXPECT_GT(fine, 0.98 * finest);
  EXPECT_NEAR(finest, 8.0, 0.1);
  EXPECT_LT(incompressible_cook(element, 32), finest / 3);
}

// 3.45 N by quadratic tetrahedra.
TEST(PooledVolume, BondedBlockBearsWhatItShould) {
  EXPECT_NEAR(bonded_block_force(pooled, 8), 3.72, 0.02);
  EXPECT_NEAR(bonded_block_force(pooled, 12), 3.45, 0.05 * 3.45);
  EXPECT_GT(bonded_block_force(element, 8), 200);
}

// 6.97 by quadratic tetrahedra, 6.85 by a prototype, refined: bending of coarse meshes stays stiff.
TEST(PooledVolume, CooksMembraneAtFiniteDeformation) {
  const double coarse = neo_hookean_cook(pooled, 16, 4), fine = neo_hookean_cook(pooled, 32, 4);
  EXPECT_GT(coarse, 0.93 * 6.97);
  EXPECT_GT(fine, 0.97 * 6.97);
  EXPECT_LT(fine, 6.97);
  EXPECT_LT(neo_hookean_cook(element, 16, 4), 0.4 * fine);
}

TEST(PooledVolume, BondedBlockByTheFiniteLawIsThatOfTheLinearOneAtSmallLoads) {
  const double linear = bonded_block_force(pooled, 8);
  EXPECT_NEAR(neo_hookean_block_force(8), linear, 1e-3 * linear);
}

}  // namespace
}  // namespace sunder::test
