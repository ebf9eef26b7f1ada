// SPDX-License-Identifier: Apache-2.0
// When a frame of a region may do without a full check.
#include "solver/energy_check.hpp"

#include <gtest/gtest.h>

#include "support/table1_board.hpp"

namespace sunder::solver {
namespace {

class EnergyChecked : public testing::Test {
 protected:
  EnergyChecked() {
    load.force_dofs = {7};
    load.forces = {-2};
    other.force_dofs = {9};
    other.forces = {1};
  }
  void check_fully(double unrefined, double mended = 0, int base = 1, double forces = 0) {
    check.checked(load, {}, unrefined, mended, base, forces, kU, kStress);
  }
  [[nodiscard]] auto refined(double error, double u = kU, double stress = kStress) {
    return check.known_refined(expected(), error, u, stress);
  }
  [[nodiscard]] CheckedLoads::Sum expected(int base = 1) {
    return check.expected(load, base).value();
  }
  [[nodiscard]] bool trusts_factor(const Load& of, int base = 1) {
    const auto known = check.expected(of, base);
    return known && check.known_refined(*known, 0, kU, kStress).has_value();
  }
  [[nodiscard]] bool known(double energy, int base = 1, double forces = 0) {
    return check.known(expected(base), energy, forces, kU, kStress).has_value();
  }

  static constexpr double kU = 0.5, kStress = 3;
  const Problem problem{test::pulled_board()};
  EnergyCheck check{problem};
  Load load, other;
};

TEST_F(EnergyChecked, TrustsAFactorThatAFullCheckHasSeen) {
  EXPECT_FALSE(trusts_factor(load));
  check_fully(0);
  EXPECT_FALSE(trusts_factor(load)) << "an exact solution says nothing about others";
  check_fully(1e-12);
  ASSERT_TRUE(trusts_factor(load));
  EXPECT_NEAR(refined(1e-11).value().error, 1.1e-10, 1e-11);
  check_fully(5e-12);
  EXPECT_GE(refined(0).value().error, 5e-10) << "the most that any has found";
  check_fully(1e-12);
  EXPECT_GE(refined(0).value().error, 5e-10);
  check_fully(2e-10);
  EXPECT_FALSE(trusts_factor(load));
  EXPECT_FALSE(refined(0));
}

TEST_F(EnergyChecked, TellsWhatDriftsFromTheFactor) {
  check_fully(1e-12, 3e-9);
  EXPECT_TRUE(trusts_factor(load));
  EXPECT_GE(expected().error, 3e-9) << "what the base gives by itself";
  check.event();
  EXPECT_FALSE(known(0));
  EXPECT_TRUE(refined(1e-11));
}

TEST_F(EnergyChecked, ForgetsAnotherFactorsErrors) {
  check.follow(1, {}, 1, false);
  check_fully(1e-12);
  check.follow(2, {load, 1, 4e-12}, 1, true);
  EXPECT_TRUE(trusts_factor(load, 2)) << "a base that has come from the same factor";
  check.follow(3, {load, 1, 4e-12}, 2, true);
  EXPECT_FALSE(trusts_factor(load, 3));
  check.follow(4, {load, 1, 3e-12}, 2, false);
  EXPECT_TRUE(trusts_factor(load, 4)) << "its own check";
  check.forget();
  EXPECT_FALSE(trusts_factor(load, 4));
  check_fully(1e-12, 0, 4);
  EXPECT_TRUE(trusts_factor(load, 4));
  check.checked(other, {}, 0, 0, 4, 0, kU, kStress);
  EXPECT_FALSE(trusts_factor(other, 4)) << "of loads on other unknowns";
}

TEST_F(EnergyChecked, AsksForAFullCheckWhereTheBodyHasChanged) {
  check_fully(1e-12);
  EXPECT_TRUE(refined(1e-12, 9 * kU));
  EXPECT_FALSE(refined(1e-12, 11 * kU)) << "a piece has come loose";
  EXPECT_FALSE(refined(1e-12, kU, kStress / 11)) << "shares that cancel";
  EXPECT_FALSE(refined(1e-12, kU, 0));
  EXPECT_FALSE(refined(2e-8));
}

// The bound by energy is of the worst element; a refinement on the region has seen what it is worth
// where damage acts.
TEST_F(EnergyChecked, TakesWhatARefinementHasFoundForAWhile) {
  check_fully(1e-12);
  check.event();
  double energy = 1e-30;
  while (known(energy)) energy *= 2;
  check.refined(load, 1e-12, {1e-12, energy}, 1, 0, kU, kStress);
  for (int event = 0; event < 15; ++event) {
    check.event();
    EXPECT_TRUE(known(energy)) << event;
  }
  check.event();
  EXPECT_FALSE(known(energy)) << "too long ago";
  check.refined(load, 1e-12, {1e-12, energy}, 1, 0, kU, kStress);
  check.event();
  ASSERT_TRUE(known(energy));
  EXPECT_FALSE(known(1e12 * energy));
  check.follow(2, {load, 1, 1e-12}, 0, true);
  EXPECT_FALSE(known(energy, 2)) << "another base";
}

// What a base gives wrong grows with the forces of the damage, a hundredfold where nobody knows
// them.
TEST_F(EnergyChecked, ErrorsGrowWithTheForcesOfTheDamageForAWhile) {
  constexpr double kForces = 40, kError = 1e-9;
  check_fully(1e-12, kError, 1, kForces);
  check.event();
  EXPECT_NEAR(check.known(expected(), 0, kForces, kU, kStress).value().error, 5 * kError, 1e-15);
  EXPECT_TRUE(known(0, 1, kForces / 10));
  EXPECT_TRUE(known(0, 1, 1.9 * kForces));
  EXPECT_FALSE(known(0, 1, 2.1 * kForces));
  for (int event = 1; event < 8; ++event) check.event();
  EXPECT_TRUE(known(0, 1, kForces));
  check.event();
  EXPECT_FALSE(known(0, 1, kForces)) << "too long ago";
  check.refined(load, kError, {}, 1, kForces, kU, kStress);
  check.event();
  EXPECT_TRUE(known(0, 1, kForces));
  check.follow(2, {load, 1, kError}, 0, true);
  EXPECT_FALSE(known(0, 2, kForces)) << "another base";
}

// A base that drifts hides what little the damage lacks: the second refinement has it alone.
TEST_F(EnergyChecked, TellsWhatDamageLacksFromWhatTheBaseGivesWrong) {
  constexpr double kForces = 40, kError = 1e-9;
  check_fully(1e-12, kError, 1, kForces);
  check.event();
  double energy = 1e-30;
  while (known(energy, 1, kForces)) energy *= 2;
  EXPECT_TRUE(check.wants_worth(kError, 1));
  EXPECT_FALSE(check.wants_worth(3e-9, 1)) << "the base alone is over the bound";
  check.refined(load, kError, {kError, energy}, 1, kForces, kU, kStress);
  check.event();
  EXPECT_FALSE(known(energy, 1, kForces)) << "all of the error put down to the damage";
  EXPECT_TRUE(check.wants_worth(kError, 1));
  check.refined(load, kError, {1e-12, energy, true}, 1, kForces, kU, kStress);
  check.event();
  EXPECT_TRUE(known(energy, 1, kForces));
  EXPECT_FALSE(check.wants_worth(kError, 1));
  EXPECT_TRUE(check.wants_worth(kError, 2)) << "another base";
  for (int event = 2; event < 64; ++event) {
    check.refined(load, kError, {kError, energy}, 1, kForces, kU, kStress);
    check.event();
    EXPECT_TRUE(known(energy, 1, kForces)) << event;
  }
  check.event();
  EXPECT_TRUE(check.wants_worth(kError, 1)) << "too long ago";
  EXPECT_FALSE(known(energy, 1, kForces));
}

// A base that drifts is checked as it is made, before the events since.
TEST_F(EnergyChecked, LooksOnceAtABaseThatDrifts) {
  check.follow(1, {}, 1, false);
  check_fully(1e-12);
  EXPECT_FALSE(check.unseen());
  check.follow(2, {load, 1, 4e-12}, 1, true);
  EXPECT_TRUE(check.unseen());
  check.refined(load, 1e-11, {}, 2, 0, kU, kStress);
  check.follow(2, {load, 1, 4e-12}, 1, true);
  EXPECT_FALSE(check.unseen());
  check.follow(3, {load, 1, 4e-12}, 1, true);
  EXPECT_TRUE(check.unseen());
  check.follow(4, {load, 1, 4e-12}, 2, false);
  EXPECT_FALSE(check.unseen()) << "the factor's own";
  check.follow(5, {load, 1, 4e-12}, 2, true);
  check_fully(1e-12, 0, 5);
  EXPECT_FALSE(check.unseen());
  check.follow(6, {load, 1, 4e-12}, 2, true);
  EXPECT_TRUE(known(0, 6)) << "where the region cannot be refined: a thousand times that";
  check.refined(load, 1e-11, {}, 6, 0, kU, kStress);
  check.follow(7, {load, 1, 5e-11}, 2, true);
  EXPECT_FALSE(known(0, 7)) << "not a hundred";
  check.forget();
  EXPECT_FALSE(check.unseen()) << "nothing is known of any";
}

TEST_F(EnergyChecked, ARefinedSolutionIsNoBetterThanItsFactor) {
  check_fully(2e-11);
  check.refined(load, 1e-14, {}, 1, 0, kU, kStress);
  EXPECT_GE(expected().error, 2e-11);
}

}  // namespace
}  // namespace sunder::solver
