// SPDX-License-Identifier: Apache-2.0
// Forces of grips between frames at finite deformation and in motion: those of the frame where it
// was, and to first order those of the next frame where the hand goes on to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "solver/grip_stiffness.hpp"
#include "support/body.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

/// A strip of 8 x 4 x 2 mm, held at its left end; a hand has its right end.
Scene held_strip(MaterialLaw law) {
  Scene scene;
  scene.mesh = structured_board({8, 4, 2, 8, 4, 2});
  scene.materials["board"] = {5, 0.3, {}, law, 1e-9};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
  Instrument hand;
  hand.name = "hand";
  hand.action = Grip{Box{Vec3(8 - 1e-6, 1, -1), Vec3(9, 3, 9)}, Vec3(1, 1, 1), Axes{7}};
  scene.instruments.push_back(hand);
  scene.solver.tolerance = 1e-8;
  return scene;
}

struct Hand {
  explicit Hand(Scene scene)
      : body(std::move(scene)), instruments(body.backend->instrument_forces()) {}
  /// The hand goes to there.
  void go(const Vec3& to) {
    at.clear();
    for (std::size_t g = 0; g < body.problem->gripped_dofs().size(); ++g) {
      at.push_back(to[static_cast<Eigen::Index>(g % 3)]);
    }
    body.load(std::vector<double>(body.problem->dofs().size(), 0.0), at);
    body.problem->moves() ? body.backend->advance(0.005) : body.backend->solve();
  }
  [[nodiscard]] std::vector<double> forces(const std::vector<double>& where) const {
    std::vector<double> of(where.size());
    EXPECT_TRUE(instruments->forces(where, of));
    return of;
  }
  Body body;
  std::shared_ptr<InstrumentForces> instruments;
  std::vector<double> at;
};

double size(const std::vector<double>& of) {
  double sum = 0;
  for (double x : of) sum += x * x;
  return std::sqrt(sum);
}

double apart(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return size(a);
}

class LawGrips : public ::testing::TestWithParam<MaterialLaw> {};

TEST_P(LawGrips, FollowTheHandBetweenFramesAtRest) {
  for (const Route route : {Route::factor, Route::inverse}) {
    Scene scene = held_strip(GetParam());
    scene.solver.route = route;
    Hand hand(scene);
    ASSERT_TRUE(hand.instruments);
    std::vector<double> forces(hand.body.problem->gripped_dofs().size(), 1);
    EXPECT_FALSE(hand.instruments->forces(forces, forces)) << "before the first frame";
    // To a stretch of a quarter, bent; then something breaks.
    Vec3 to = Vec3::Zero();
    for (int i = 1; i <= 8; ++i) hand.go(to = i * Vec3(0.25, 0.2, 0.05));
    for (const bool torn : {false, true}) {
      if (torn) {
        hand.body.backend->destroy(std::vector<Index>{90, 91, 92, 140});
        hand.go(to);
      }
      const std::vector<double> reactions = hand.body.reactions();
      EXPECT_LE(apart(hand.forces(hand.at), reactions), 1e-8 * size(reactions));
      // What the hand feels on its way to the next frame, which ends there.
      const Vec3 step(0.01, -0.02, 0.01);
      std::vector<double> next = hand.at;
      for (std::size_t g = 0; g < next.size(); ++g)
        next[g] += step[static_cast<Eigen::Index>(g % 3)];
      const std::vector<double> felt = hand.forces(next);
      hand.go(to + step);
      const std::vector<double> there = hand.body.reactions();
      const double change = apart(there, reactions);
      std::printf("the hand moved by .024 mm: %.3g N, felt within %.2g of it\n", change,
                  apart(felt, there) / change);
      EXPECT_LE(apart(felt, there), 0.01 * change);
      hand.go(to);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, LawGrips,
                         ::testing::Values(MaterialLaw::corotated, MaterialLaw::neo_hookean,
                                           MaterialLaw::saint_venant_kirchhoff),
                         [](const auto& law) {
                           return "law_" + std::to_string(static_cast<int>(law.param));
                         });

// Of two hands that part in the last step the one feels what the other meets.
TEST(MovingGrips, FollowTheHandBetweenFrames) {
  for (const bool felt_inertia : {true, false}) {
    for (const double damping : {0.0, 0.01}) {
      Scene scene = held_strip(MaterialLaw::neo_hookean);
      scene.dynamics = Dynamics{.time_step = 0.005};
      scene.dynamics->felt_inertia = felt_inertia;
      scene.dynamics->stiffness_damping = damping;
      Hand hand(scene), other(scene);
      Vec3 to = Vec3::Zero();
      for (int i = 1; i <= 12; ++i) {
        to += Vec3(0.1, 0.1, 0);
        hand.go(to);
        if (i < 12) other.go(to);
      }
      EXPECT_LE(apart(hand.forces(hand.at), hand.body.reactions()),
                1e-8 * size(hand.body.reactions()));
      const Vec3 step(0.01, -0.02, 0.01);
      other.go(to + step);
      const std::vector<double> there = other.body.reactions(), felt = hand.forces(other.at);
      const double change = apart(there, hand.body.reactions());
      std::printf("in motion, .024 mm: %.3g N, felt within %.2g of it\n", change,
                  apart(felt, there) / change);
      EXPECT_LE(apart(felt, there), 0.01 * change);
    }
  }
}

TEST(MovingGrips, OfAPieceThatNothingHoldsAreItsInertia) {
  Scene scene = held_strip(MaterialLaw::corotated);
  scene.supports.clear();
  scene.dynamics = Dynamics{.time_step = 0.005};
  scene.dynamics->felt_inertia = true;
  Hand hand(scene);
  for (int i = 1; i <= 4; ++i) hand.go(Vec3(0.1 * i, 0, 0));
  std::vector<double> next = hand.at;
  for (std::size_t g = 0; g < next.size(); g += 3) next[g] += 0.01;
  const std::vector<double> there = hand.forces(next), here = hand.forces(hand.at);
  double pull = 0;
  for (std::size_t g = 0; g < next.size(); g += 3) pull += there[g] - here[g];
  // Moved as a whole, by the rate of BDF2: mass (1.5 / dt)^2.
  const double mass = 8 * 4 * 2 * 1e-9;
  EXPECT_NEAR(pull, mass * 0.01 * 2.25 / (0.005 * 0.005), 0.01 * pull);
}

TEST(GripStiffness, ADirectionWithoutStiffnessGetsNextToNone) {
  Eigen::MatrixXd s(3, 3);
  s << 4, 1, 0, 1, 3, 0, 0, 0, 0;
  Eigen::MatrixXd l = solver::compliance_factor(s, std::vector<double>(3, 0.0));
  EXPECT_TRUE(l.isLowerTriangular());
  Eigen::MatrixXd back = (l * l.transpose()).inverse();
  EXPECT_LE((back - s).cwiseAbs().maxCoeff(), 1e-8);
  s(2, 2) = -2;
  l = solver::compliance_factor(s, std::vector<double>(3, 0.0));
  back = (l * l.transpose()).inverse();
  EXPECT_LE((back.topLeftCorner(2, 2) - s.topLeftCorner(2, 2)).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_NEAR(back(2, 2), 0, 1e-8);
  l = solver::compliance_factor(s, std::vector<double>{0, 0, 5});
  back = (l * l.transpose()).inverse();
  EXPECT_NEAR(back(2, 2), 3, 1e-12);
}

}  // namespace
}  // namespace sunder::test
