// SPDX-License-Identifier: Apache-2.0
// Rank 6 k updates against a fresh factorisation of the damaged board (cpu_reference/plain), for
// scattered damage, along a crack, one by one and in batches, by both routes.
#include <gtest/gtest.h>

#include "body/pieces.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/loads.hpp"
#include "support/sequences.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {
namespace {

double work(std::span<const double> f, std::span<const double> u) {
  double sum = 0;
  for (std::size_t i = 0; i < f.size(); ++i) sum += f[i] * u[i];
  return sum;
}

void expect_accurate(Body& body, const std::vector<double>& force, double tolerance,
                     std::span<const std::uint8_t> ignored, const std::string& when) {
  const auto right = yardstick(*body.problem, body.backend->destroyed(), force);
  const double u_error =
      displacement_error(body.problem->mesh(), ignored, body.displacement(), right.displacement);
  const double s_error = stress_error(ignored, body.stress(), right.stress);
  EXPECT_TRUE(u_error <= tolerance) << when << ": u " << u_error;
  EXPECT_TRUE(s_error <= tolerance) << when << ": stress " << s_error;
}

struct LowRankCase {
  const char* name;
  Route route;
  bool crack;
  std::size_t batch;  // elements per event
};

class Damage : public ::testing::TestWithParam<LowRankCase> {};

TEST_P(Damage, FollowsAFreshFactorisation) {
  Scene scene = held_board();
  scene.solver.route = GetParam().route;
  if (GetParam().route == Route::inverse) scene.solver.update = Update::eager;
  Body body(std::move(scene));
  const auto force = corner_force(body.problem->mesh());
  const auto sequence = GetParam().crack ? crack_sequence(*body.problem, 200, 12)
                                         : scattered_sequence(*body.problem, 200);
  ASSERT_EQ(sequence.size(), 200u);
  const double tolerance = GetParam().crack ? kCrackTolerance : kIntactTolerance;
  double last_work = 0;
  for (std::size_t done = 0; done < sequence.size();) {
    const std::size_t next = std::min(done + GetParam().batch, sequence.size());
    body.backend->destroy(std::span(sequence).subspan(done, next - done));
    done = next;
    body.load(force);
    const SolveReport report = body.backend->solve();
    EXPECT_TRUE(report.error <= tolerance) << done;
    const double w = work(force, body.displacement());
    // Destroying stiffness never stiffens: f.u cannot fall (but for rounding).
    EXPECT_TRUE(w >= last_work * (1 - 1e-9)) << "f.u fell at " << done;
    last_work = w;
    if (done == 1 || done == 10 || done == 50 || done == 100 || done == 200) {
      expect_accurate(body, force, tolerance, body.backend->destroyed(),
                      "after " + std::to_string(done));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sequences, Damage,
    ::testing::Values(LowRankCase{"InverseScattered", Route::inverse, false, 1},
                      LowRankCase{"InverseCrack", Route::inverse, true, 1},
                      LowRankCase{"InverseCrackBy10", Route::inverse, true, 10},
                      LowRankCase{"InverseCrackBy100", Route::inverse, true, 100},
                      LowRankCase{"InverseCrackBy200", Route::inverse, true, 200},
                      LowRankCase{"CgScattered", Route::cg, false, 50},
                      LowRankCase{"CgCrack", Route::cg, true, 10}),
    [](const auto& p) { return p.param.name; });

/// Pieces that nothing holds, and destroyed elements: what the promise leaves out.
std::vector<std::uint8_t> detached(const Problem& problem,
                                   std::span<const std::uint8_t> destroyed) {
  std::vector<std::uint8_t> ignored(destroyed.begin(), destroyed.end());
  for (const auto& piece : find_loose_parts(problem, destroyed).pieces) {
    for (Index e : piece) ignored[e] = 1;
  }
  return ignored;
}

class Cut : public ::testing::TestWithParam<LowRankCase> {};

// The whole width is cut at y = 26.5: the lower part with the loaded corner hangs on destroyed
// elements only. A second force on the attached part makes its field one worth checking.
TEST_P(Cut, KeepsTheAttachedPartRight) {
  Scene scene = held_board();
  scene.solver.route = GetParam().route;
  if (GetParam().route == Route::inverse) scene.solver.update = Update::eager;
  scene.solver.tolerance = 1e-3;
  Body body(std::move(scene));
  const auto across = elements_across(body.problem->mesh(), 26.5);
  std::vector<double> force(3 * body.problem->mesh().nodes.size(), 0.0);
  for (Index n = 0; n < body.problem->node_count(); ++n) {
    const Vec3& x = body.problem->mesh().nodes[n];
    if (x.y() > 35 && x.y() < 45 && x.x() > 49.9) force[3 * n] = 0.5;
  }
  for (std::size_t done = 0; done < across.size();) {
    const std::size_t next = std::min(done + GetParam().batch, across.size());
    body.backend->destroy(std::span(across).subspan(done, next - done));
    done = next;
  }
  const auto ignored = detached(*body.problem, body.backend->destroyed());
  const auto pieces = find_loose_parts(*body.problem, body.backend->destroyed()).pieces;
  ASSERT_EQ(pieces.size(), 1u);
  body.load(force);
  body.backend->solve();
  for (double v : body.displacement()) ASSERT_TRUE(std::isfinite(v));
  expect_accurate(body, force, kCutTolerance, ignored, "cut, load on the attached part");

  const auto below = corner_force(body.problem->mesh());  // 60 N on a piece held by 1e-6 of a row
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += below[i] / 1e4;
  body.load(force);
  body.backend->solve();
  for (double v : body.displacement()) ASSERT_TRUE(std::isfinite(v));
  expect_accurate(body, force, kCutTolerance, ignored, "cut, load on both parts");
}

INSTANTIATE_TEST_SUITE_P(Sequences, Cut,
                         ::testing::Values(LowRankCase{"InverseOneByOne", Route::inverse, true, 1},
                                           LowRankCase{"InverseAtOnce", Route::inverse, true, 1000},
                                           LowRankCase{"Cg", Route::cg, true, 1000}),
                         [](const auto& p) { return p.param.name; });

struct Extreme {
  const char* name;
  double alpha, poisson, contrast;
  Route route;
};

class Extremes : public ::testing::TestWithParam<Extreme> {};

// Not to be refused in double precision: alpha down to 1e-9, Poisson's ratio up to 0.499, contrast
// of stiffness up to 1e4.
TEST_P(Extremes, AreSolvedInDoublePrecision) {
  Scene scene = held_board();
  scene.solver.route = GetParam().route;
  if (GetParam().route == Route::inverse) scene.solver.update = Update::eager;
  scene.fracture.alpha = GetParam().alpha;
  set_poisson(scene, GetParam().poisson);
  set_contrast(scene, GetParam().contrast);
  Body body(std::move(scene));
  const auto force = corner_force(body.problem->mesh());
  const auto sequence = crack_sequence(*body.problem, 50, 12);
  body.load(force);
  body.backend->solve();
  expect_accurate(body, force, kIntactTolerance, body.backend->destroyed(), "intact");
  for (std::size_t i = 0; i < sequence.size(); i += 10) {
    body.backend->destroy(std::span(sequence).subspan(i, 10));
  }
  body.backend->solve();
  expect_accurate(body, force, kCrackTolerance, body.backend->destroyed(), "after 50");
}

INSTANTIATE_TEST_SUITE_P(
    Range, Extremes,
    ::testing::Values(Extreme{"Alpha1e9Inverse", 1e-9, 0.4, 100, Route::inverse},
                      Extreme{"Alpha1e9Cg", 1e-9, 0.4, 100, Route::cg},
                      Extreme{"Poisson499Inverse", 1e-6, 0.499, 100, Route::inverse},
                      Extreme{"Poisson499Cg", 1e-6, 0.499, 100, Route::cg},
                      Extreme{"Contrast1e4Inverse", 1e-6, 0.4, 1e4, Route::inverse},
                      Extreme{"Contrast1e4Cg", 1e-6, 0.4, 1e4, Route::cg}),
    [](const auto& p) { return p.param.name; });

class BeyondExtremes : public ::testing::TestWithParam<Extreme> {};

// Beyond: a right answer, or a typed refusal; never a number that is not one.
TEST_P(BeyondExtremes, AreRightOrRefused) {
  Scene scene = held_board();
  scene.solver.route = GetParam().route;
  if (GetParam().route == Route::inverse) scene.solver.update = Update::eager;
  scene.fracture.alpha = GetParam().alpha;
  set_poisson(scene, GetParam().poisson);
  set_contrast(scene, GetParam().contrast);
  try {
    Body body(std::move(scene));
    const auto force = corner_force(body.problem->mesh());
    body.backend->destroy(crack_sequence(*body.problem, 50, 12));
    body.load(force);
    body.backend->solve();
    expect_accurate(body, force, 1e-4, body.backend->destroyed(), GetParam().name);
  } catch (const NumericalError& error) {
    EXPECT_GT(std::string(error.what()).size(), 40u);
  }
}

INSTANTIATE_TEST_SUITE_P(Range, BeyondExtremes,
                         ::testing::Values(Extreme{"Poisson4999999", 1e-6, 0.4999999, 100,
                                                   Route::inverse},
                                           Extreme{"Contrast1e8", 1e-6, 0.4, 1e8, Route::inverse},
                                           Extreme{"Contrast1e12", 1e-6, 0.4, 1e12, Route::cg},
                                           Extreme{"Alpha1e15", 1e-15, 0.4, 100, Route::inverse},
                                           Extreme{"Alpha1e15Cg", 1e-15, 0.4, 100, Route::cg}),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace sunder::test
