// SPDX-License-Identifier: Apache-2.0
// When the solver of a frame lets the residual of iterations speak for itself, by a device whose
// solutions have the residual and the stress that a test wants.
#include <gtest/gtest.h>

#include "small_tissue.hpp"
#include "solver/frame_solver.hpp"

namespace sunder::solver {
namespace {

class Iterating final : public FrameDevice {
 public:
  Precision precision() const override { return {2e-10, 1e-8, 5e-9}; }
  bool iterates() const override { return true; }
  int solve(double, Residual) override { return 100; }
  Balance balance() const override { return now; }
  Correction correct(bool) override {
    ++corrections;
    return {worth * now.residual, 30};
  }
  void add_correction() override {}

  Balance now{1e-10, 1, .01, 2};
  double worth = 3;  // MPa of a N of residual
  int corrections = 0;
};

class IteratedCheck : public testing::Test {
 protected:
  /// Whether the frame had a full check.
  bool checked() {
    const int before = device_.corrections;
    report_ = solver_.solve(load_);
    return device_.corrections > before;
  }

  Problem problem_{test::small_tissue()};
  Iterating device_;
  FrameSolver solver_{problem_, device_};
  Load load_{{0, 3}, {1, 2}, {}};
  SolveReport report_;
};

TEST_F(IteratedCheck, OneSpeaksForSixteenEvents) {
  EXPECT_TRUE(checked());
  EXPECT_DOUBLE_EQ(report_.error, 3 * 1e-10 / 2);
  EXPECT_EQ(report_.iterations, 130);
  int checks = 0;
  for (int event = 1; event <= 64; ++event) {
    solver_.event();
    const bool full = checked();
    checks += full;
    EXPECT_EQ(full, event % 16 == 0) << event;
    // Ten times what the last check lets expect.
    EXPECT_DOUBLE_EQ(report_.error, (full ? 1 : 10) * 3 * 1e-10 / 2) << event;
  }
  EXPECT_EQ(checks, 4);
}

TEST_F(IteratedCheck, ALoadInAnotherDirectionHasItsOwn) {
  EXPECT_TRUE(checked());
  load_.forces = {2, 4};
  EXPECT_FALSE(checked()) << "a multiple";
  load_.forces = {2, -4};
  EXPECT_TRUE(checked());
  load_.forces = {5, 1};
  EXPECT_FALSE(checked()) << "a sum of both";
}

TEST_F(IteratedCheck, IsDueWhereTheResidualDoesNotVouch) {
  EXPECT_TRUE(checked());
  solver_.event();
  device_.now.residual = 4e-10;  // ten times 6e-10 of stress: over what is promised
  EXPECT_TRUE(checked());
  device_.now.residual = 1e-10;
  solver_.event();
  EXPECT_FALSE(checked());
  solver_.event();
  device_.now.largest_u = 1;  // a hundred times softer
  EXPECT_TRUE(checked());
}

// Rounding of displacement by the bound costs more stress than fp64 promises: K u by blocks does
// not see it.
TEST_F(IteratedCheck, IsDueWhereRoundingMayHideAnError) {
  device_.now.largest_u = 1e7;
  EXPECT_TRUE(checked());
  solver_.event();
  EXPECT_TRUE(checked());
}

TEST_F(IteratedCheck, GoesBackWithTheState) {
  EXPECT_TRUE(checked());
  for (int event = 0; event < 15; ++event) solver_.event();
  const auto then = solver_.state();
  solver_.event();
  EXPECT_TRUE(checked());
  solver_.restore(*then);
  EXPECT_FALSE(checked());
  solver_.event();
  EXPECT_TRUE(checked());
}

}  // namespace
}  // namespace sunder::solver
