// SPDX-License-Identifier: Apache-2.0
// Loads as sums of those that full checks know.
#include "solver/checked_loads.hpp"

#include <gtest/gtest.h>

#include <random>

#include "support/table1_board.hpp"

namespace sunder::solver {
namespace {

struct Checked : testing::Test {
  Problem problem{test::held_board()};
  CheckedLoads known{problem};

  /// Forces on unknowns 4, 7, 9 and the displacements of two grips.
  static Load load(std::array<double, 5> of) {
    return {{4, 7, 9}, {of[0], of[1], of[2]}, {of[3], of[4]}};
  }
  void check(const std::array<double, 5>& of, double u, double stress, double error = 1e-12) {
    known.checked(load(of), {error, 2 * stress, u, stress}, 1);
  }
};

TEST_F(Checked, KnowsMultiplesAndSums) {
  EXPECT_FALSE(known.takes(load({1, 0, 0, 0, 0})));
  EXPECT_FALSE(known.expected(load({1, 0, 0, 0, 0}), 1));
  check({1, 0, 0, 0, 0}, 2, 5);
  check({0, 0, 0, 1e-3, 0}, 3, 7, 1e-10);
  const auto twice = known.expected(load({0, 0, 0, 2e-3, 0}), 1);
  ASSERT_TRUE(twice);
  EXPECT_TRUE(twice->alone);
  EXPECT_DOUBLE_EQ(twice->largest_u, 6);
  EXPECT_DOUBLE_EQ(twice->stress_of_residual, 14);
  const auto sum = known.expected(load({-3, 0, 0, 2e-3, 0}), 1);
  ASSERT_TRUE(sum);
  EXPECT_FALSE(sum->alone);
  EXPECT_NEAR(sum->largest_u, 3 * 2 + 2 * 3, 1e-12);
  EXPECT_NEAR(sum->largest_stress, 3 * 5 + 2 * 7, 1e-12);
  EXPECT_NEAR(sum->stress_error, 15e-12 + 14e-10, 1e-20);
  EXPECT_EQ(sum->error, 1e-10);
  EXPECT_EQ(sum->stress_of_residual, 14);
  EXPECT_FALSE(known.expected(load({1, 1, 0, 0, 0}), 1)) << "beyond their span";
  EXPECT_FALSE(known.expected(load({1, 0, 0, 0, 0}), 2)) << "of another base";
  Load other = load({1, 0, 0, 0, 0});
  other.force_dofs[2] = 10;
  EXPECT_FALSE(known.takes(other));
}

TEST_F(Checked, ForcesAndEventsAreThoseOfAllShares) {
  known.checked(load({1, 0, 0, 0, 0}), {1e-12, 10, 2, 5, 30}, 1);
  EXPECT_EQ(known.expected(load({2, 0, 0, 0, 0}), 1)->forces, 60);
  known.event();
  known.checked(load({0, 1, 0, 0, 0}), {1e-12, 10, 2, 5, 40}, 1);
  const auto sum = known.expected(load({1, -2, 0, 0, 0}), 1);
  ASSERT_TRUE(sum);
  EXPECT_NEAR(sum->forces, 30 + 2 * 40, 1e-12);
  EXPECT_EQ(sum->events, 1);
  EXPECT_FALSE(sum->fresh());
  EXPECT_TRUE(known.expected(load({0, 1, 0, 0, 0}), 1)->fresh());
  known.checked(load({0, 1, 0, 0, 0}), {1e-12, 10, 2, 5, 0}, 1);
  EXPECT_EQ(known.expected(load({1, -2, 0, 0, 0}), 1)->forces, 0) << "of one nothing is known";
}

TEST_F(Checked, ANewBaseForgetsAllButWhatIsKnownOfIt) {
  check({1, 0, 0, 0, 0}, 2, 5);
  check({0, 1, 0, 0, 0}, 3, 7);
  EXPECT_FALSE(known.follow(1, {load({1, 0, 0, 0, 0}), 9, 1e-13})) << "the same base";
  EXPECT_FALSE(known.follow(2, {load({0, 0, 1, 0, 0}), 9, 1e-13})) << "an unknown load";
  EXPECT_FALSE(known.follow(2, {load({1, 1, 0, 0, 0}), 0, 0})) << "it had no check";
  EXPECT_TRUE(known.follow(2, {load({1, 1, 0, 0, 0}), 9, 1e-13}));
  const auto half = known.expected(load({0.5, 0.5, 0, 0, 0}), 2);
  ASSERT_TRUE(half);
  EXPECT_DOUBLE_EQ(half->largest_u, 2.5);
  EXPECT_DOUBLE_EQ(half->stress_of_residual, 9);
  EXPECT_FALSE(known.expected(load({1, 0, 0, 0, 0}), 2));
}

// A direction near others is left out; no load has none.
TEST_F(Checked, KeepsWhatAddsMost) {
  check({0, 0, 0, 0, 0}, 0, 0);
  EXPECT_FALSE(known.takes(load({1, 0, 0, 0, 0})));
  check({1, 1e-6, 0, 0, 0}, 1, 1);
  check({1, 0, 0, 0, 0}, 1, 1);
  EXPECT_FALSE(known.expected(load({0, 1, 0, 0, 0}), 1));
  check({0, 1, 0, 0, 0}, 1, 1);
  EXPECT_TRUE(known.expected(load({-3, 1, 0, 0, 0}), 1));
}

// However many random directions have come, the newest spans with those that stay what it can.
TEST_F(Checked, HasRoomForAllThatHandsCanDo) {
  std::mt19937 random(1);
  std::normal_distribution<double> by;
  Load of;
  for (Index d = 0; d < 20; ++d) of.force_dofs.push_back(d);
  const auto wander = [&](int directions) {
    of.forces.assign(20, 0.0);
    for (int i = 0; i < directions; ++i) of.forces[static_cast<std::size_t>(i)] = by(random);
    return of;
  };
  for (int i = 0; i < 40; ++i) known.checked(wander(12), {}, 1);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(known.expected(wander(12), 1)) << i;
  for (int i = 0; i < 40; ++i) known.checked(wander(20), {}, 1);
  EXPECT_TRUE(known.expected(of, 1)) << "the last";
  EXPECT_FALSE(known.expected(wander(20), 1));
}

}  // namespace
}  // namespace sunder::solver
