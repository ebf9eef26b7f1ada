// SPDX-License-Identifier: Apache-2.0
// The error that a frame reports while a body tears is never under the true one.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {
namespace {

struct PromiseCase {
  const char* name;
  Route route;
  double contrast = 1, poisson = 0.4, alpha = 1e-6;
};

class Estimate : public ::testing::TestWithParam<PromiseCase> {};

TEST_P(Estimate, IsNeverUnderTheErrorAlongACrack) {
  Scene scene = held_board();
  scene.solver.route = GetParam().route;
  scene.fracture.alpha = GetParam().alpha;
  for (auto& [name, m] : scene.materials) {
    if (!m.yield) m.young *= GetParam().contrast;
    m.poisson = GetParam().poisson;
  }
  const Body body(std::move(scene));
  std::vector<double> force(body.problem->dofs().size(), 0.0);
  for (Index n = 0; n < body.problem->node_count(); ++n) {
    const Vec3& x = body.problem->mesh().nodes[n];
    if (x.x() > 49.999 && x.y() < 0.001) force[3 * static_cast<std::size_t>(n) + 1] = -30;
  }
  const auto sequence = crack_sequence(*body.problem, 160, 12);
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    body.backend->destroy({&sequence[i], 1});
    body.load(force);
    const SolveReport report = body.backend->solve();
    EXPECT_LE(report.error, kCrackTolerance) << i;
    if (i % 8 != 7) continue;
    const auto destroyed = body.backend->destroyed();
    const double error =
        stress_error(destroyed, body.stress(), yardstick(*body.problem, destroyed, force).stress);
    // A solution refined to rounding has a correction of rounding's size, no bound (up to 2.4 times
    // under it); and the reference is off by this itself.
    constexpr double kOfRounding = 3, kReference = 1e-11;
    EXPECT_LE(error, kOfRounding * report.error + kReference) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Boards, Estimate,
    ::testing::Values(PromiseCase{"Inverse", Route::inverse}, PromiseCase{"Factor", Route::factor},
                      PromiseCase{"InverseContrast1e4", Route::inverse, 1e2},
                      PromiseCase{"FactorContrast1e4", Route::factor, 1e2},
                      PromiseCase{"FactorPoisson499", Route::factor, 1, 0.499},
                      // New bases hold remains so soft that no refinement
                      // corrects what the next events add.
                      PromiseCase{"InverseAlpha1e8", Route::inverse, 1, 0.4, 1e-8},
                      PromiseCase{"FactorAlpha1e8", Route::factor, 1, 0.4, 1e-8},
                      PromiseCase{"CondensedAlpha1e8", Route::condensed, 1, 0.4, 1e-8}),
    [](const auto& p) { return p.param.name; });

// Two hands pull where they like, six directions in all. Once their loads have had full checks a
// frame needs no more of them than under a load that keeps its direction, and what it promises
// still holds.
TEST_P(Estimate, OfHandsThatWanderNeedsNoCheckOfEveryFrame) {
  Scene scene = held_board();
  scene.solver.route = GetParam().route;
  scene.fracture.alpha = GetParam().alpha;
  for (auto& [name, m] : scene.materials) {
    if (!m.yield) m.young *= GetParam().contrast;
    m.poisson = GetParam().poisson;
  }
  constexpr int kFrames = 20, kEvents = 4;
  std::array<int, 2> full{};
  for (const bool wander : {false, true}) {
    const Body body(scene);
    const Mesh& mesh = body.problem->mesh();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> pull(-20, 20);
    std::vector<double> force(body.problem->dofs().size(), 0.0);
    Vec3 right(3, -20, 5), left(-9, -4, 7);
    const auto frame = [&] {
      for (Vec3* of : {&right, &left}) {
        if (wander)
          *of = Vec3(pull(random), pull(random), pull(random));
        else
          *of *= 1.01;
      }
      for (Index n = 0; n < body.problem->node_count(); ++n) {
        const Vec3& x = mesh.nodes[n];
        if (x.y() > 0.001 || (x.x() < 49.999 && x.x() > 0.001)) continue;
        const Vec3& of = x.x() > 25 ? right : left;
        for (int axis = 0; axis < 3; ++axis) {
          force[3 * static_cast<std::size_t>(n) + static_cast<std::size_t>(axis)] = of[axis];
        }
      }
      body.load(force);
      return body.backend->solve();
    };
    const auto sequence = crack_sequence(*body.problem, 10 * kEvents, 12);
    for (std::size_t i = 0; i < sequence.size(); i += 10) {
      body.backend->destroy(std::span(sequence).subspan(i, 10));
      for (int k = 0; k < 12; ++k) static_cast<void>(frame());  // as many directions, and again
      for (int k = 0; k < kFrames; ++k) {
        const SolveReport report = frame();
        EXPECT_LE(report.error, kCrackTolerance) << i;
        if (report.back_solves > 1) ++full[wander];
        if (k % 10 != 0) continue;
        const auto destroyed = body.backend->destroyed();
        const double error = stress_error(destroyed, body.stress(),
                                          yardstick(*body.problem, destroyed, force).stress);
        constexpr double kOfRounding = 3, kReference = 1e-11;
        EXPECT_LE(error, kOfRounding * report.error + kReference) << i;
      }
    }
  }
  std::printf("full checks in %d frames: %d under one direction, %d under wandering hands\n",
              kFrames * kEvents, full[0], full[1]);
  EXPECT_LE(full[1], full[0] + 3 * kEvents);
}

/// A frame after 60 fractures along a crack, by a route and to a tolerance.
struct Frame {
  Frame(Route route, Update update, double tolerance) : body(scene(route, update, tolerance)) {
    const auto sequence = crack_sequence(*body.problem, 60, 12);
    for (std::size_t i = 0; i < sequence.size(); i += 10) {
      body.backend->destroy(std::span(sequence).subspan(i, 10));
    }
    body.load(force());
  }
  static Scene scene(Route route, Update update, double tolerance) {
    Scene scene = held_board();
    scene.solver.route = route;
    scene.solver.update = update;
    scene.solver.tolerance = tolerance;
    return scene;
  }
  [[nodiscard]] std::vector<double> force() const {
    return corner_force(body.problem->mesh(), Vec3(0, -60, 0));
  }
  [[nodiscard]] double true_error() const {
    const auto destroyed = body.backend->destroyed();
    return stress_error(destroyed, body.stress(),
                        yardstick(*body.problem, destroyed, force()).stress);
  }
  Body body;
};

struct PolishedRoute {
  const char* name;
  Route route;
  Update update = Update::deferred;
};

class Polish : public ::testing::TestWithParam<PolishedRoute> {};

// The tolerance lies under what the route finds by itself, and above what rounding allows.
TEST_P(Polish, BringsAFrameUnderTheToleranceAndSaysSo) {
  const Frame rough(GetParam().route, GetParam().update, 1e-4);
  const SolveReport before = rough.body.backend->solve();
  EXPECT_FALSE(before.polished);
  const double tolerance = before.error / 3;
  ASSERT_GT(tolerance, 2e-12);
  const Frame fine(GetParam().route, GetParam().update, tolerance);
  const SolveReport after = fine.body.backend->solve();
  EXPECT_TRUE(after.polished);
  EXPECT_LE(after.error, tolerance);
  EXPECT_LE(fine.true_error(), 3 * tolerance) << "it was " << rough.true_error();
}

TEST_P(Polish, RefusesWithTheReasonWhatRoundingForbids) {
  const Frame frame(GetParam().route, GetParam().update, 1e-17);
  try {
    frame.body.backend->solve();
    ADD_FAILURE() << "not refused";
  } catch (const NumericalError& error) {
    const std::string what = error.what();
    for (const char* part : {"cannot be brought under the tolerance", "estimated stress error ",
                             "residual ", "raise solver.tolerance or ease contrast"}) {
      EXPECT_NE(what.find(part), std::string::npos) << what;
    }
  }
  for (double u : frame.body.displacement()) ASSERT_TRUE(std::isfinite(u));
}

INSTANTIATE_TEST_SUITE_P(Routes, Polish,
                         ::testing::Values(PolishedRoute{"Inverse", Route::inverse},
                                           PolishedRoute{"Factor", Route::factor}),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace sunder::test
