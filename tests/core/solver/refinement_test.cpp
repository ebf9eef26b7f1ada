// SPDX-License-Identifier: Apache-2.0
// How often the solver of a frame asks a device for a refinement, by a device whose corrections
// leave a share of the error that a test wants.
#include <gtest/gtest.h>

#include <limits>

#include "small_tissue.hpp"
#include "solver/frame_solver.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

constexpr double kStress = 2;  // MPa

class Correcting final : public FrameDevice {
 public:
  Precision precision() const override { return {2e-10, 1e-8, 5e-9}; }
  bool adds_at_once() const override { return ahead; }
  int solve(double, Residual) override {
    ++asked;
    error = at_first;
    return 0;
  }
  Balance balance() const override { return {1e-10, 1, .01, kStress}; }
  Correction correct(bool add) override {
    ++asked;
    const double found = overflows ? std::numeric_limits<double>::infinity() : error;
    if (add) error *= overflows ? std::numeric_limits<double>::quiet_NaN() : share;
    return {found * kStress, 0};
  }
  void add_correction() override {
    ++asked;
    error *= share;
  }

  bool ahead = true, overflows = false;
  double at_first = 1e-5, share = 1e-5;  // of a solution, and what a correction leaves of it
  double error = 0;
  int asked = 0;  // a submit each
};

class Refinement : public testing::Test {
 protected:
  static Scene scene() {
    Scene scene = test::small_tissue();
    scene.solver.tolerance = 1e-2;
    return scene;
  }
  int asked_of(double at_first, double share) {
    device_.at_first = at_first;
    device_.share = share;
    device_.asked = 0;
    report_ = solver_.solve(load_);
    return device_.asked;
  }

  Problem problem_{scene()};
  Correcting device_;
  FrameSolver solver_{problem_, device_};
  Load load_{{0, 3}, {1, 2}, {}};
  SolveReport report_;
};

TEST_F(Refinement, ThatIsLikelyIsAddedWithItsEstimate) {
  EXPECT_EQ(asked_of(1e-5, 1e-6), 1 + 2 + 1) << "nobody knew of it";
  EXPECT_EQ(asked_of(1e-5, 1e-6), 1 + 2);
  EXPECT_EQ(report_.back_solves, 3);
  EXPECT_LT(report_.error, 2e-10);
  device_.ahead = false;
  EXPECT_EQ(asked_of(1e-5, 1e-6), 1 + 2 + 1);
}

// Each leaves about the same share.
TEST_F(Refinement, AfterTheFirstIsForeseen) {
  static_cast<void>(asked_of(1e-3, 1e-3));
  EXPECT_EQ(asked_of(1e-3, 1e-3), 1 + 4);
  EXPECT_EQ(report_.back_solves, 5);
  EXPECT_DOUBLE_EQ(report_.error, device_.error);
}

TEST_F(Refinement, ThatWasNotNeededMakesTheSolutionBetter) {
  static_cast<void>(asked_of(1e-5, 1e-6));
  EXPECT_EQ(asked_of(1e-10, 1e-6), 1 + 1);
  EXPECT_DOUBLE_EQ(report_.error, 1e-10);
  EXPECT_LT(device_.error, report_.error);
  EXPECT_EQ(asked_of(1e-10, 1e-6), 1 + 1) << "nor is the next one";
  EXPECT_DOUBLE_EQ(device_.error, 1e-10);
}

// Another look at what was added, and no more.
TEST_F(Refinement, ThatDoesNotConvergeEnds) {
  for (const double share : {.9, 1.5}) {
    for (int frame = 0; frame < 2; ++frame) {
      static_cast<void>(asked_of(1e-4, share));
      EXPECT_LE(report_.back_solves, 1 + 3) << share;
      EXPECT_DOUBLE_EQ(report_.error, device_.error) << share;
    }
  }
}

TEST_F(Refinement, ThatIsNoNumberLeavesTheSolutionWhatItWas) {
  static_cast<void>(asked_of(1e-5, 1e-6));
  device_.overflows = true;
  EXPECT_THROW(static_cast<void>(solver_.solve(load_)), NumericalError);
  EXPECT_EQ(device_.error, 1e-5);
}

}  // namespace
}  // namespace sunder::solver
