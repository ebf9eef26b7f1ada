// SPDX-License-Identifier: Apache-2.0
// The board of Table 1 against CalculiX on the same mesh, intact and torn.
#include "verification/calculix.hpp"

#include <gtest/gtest.h>

#include "verification/engine_cases.hpp"

namespace sunder::test {
namespace {

// CalculiX prints seven digits: rounding of each number is up to 5e-7 of it.
constexpr double kPrintPrecision = 1e-6;

void expect_agreement(std::size_t fractures, Route route) {
  ASSERT_TRUE(calculix_installed())
      << "the program ccx is missing; install it with: apt-get install calculix-ccx";
  const TwinErrors errors = board_twin(fractures, route);
  EXPECT_TRUE(errors.u <= kPrintPrecision) << "displacement " << errors.u;
  EXPECT_TRUE(errors.stress <= kPrintPrecision) << "stress " << errors.stress;
}

TEST(CalculiX, AgreesOnTheIntactBoard) { expect_agreement(0, Route::cg); }
TEST(CalculiX, AgreesOn32FracturesByTheInverse) { expect_agreement(32, Route::inverse); }
TEST(CalculiX, AgreesOn32FracturesByConjugateGradients) { expect_agreement(32, Route::cg); }

}  // namespace
}  // namespace sunder::test
