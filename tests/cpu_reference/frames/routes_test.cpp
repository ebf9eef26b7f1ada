// SPDX-License-Identifier: Apache-2.0
// The engine's routes as a frame uses them, over long cracks: rank grows, is compacted, the base
// is made anew; extremes of contrast, Poisson's ratio and alpha included.
#include <gtest/gtest.h>

#include <string>

#include "body/pieces.hpp"
#include "cpu_reference/routes.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {
namespace {

struct RouteCase {
  const char* name;
  Route route;
  bool crack;
  std::size_t batch;
  double contrast = 1, poisson = 0.4, alpha = 1e-6;
};

std::vector<double> pull(const Problem& problem) {
  std::vector<double> force(problem.dofs().size(), 0.0);
  for (Index n = 0; n < problem.node_count(); ++n) {
    const Vec3& x = problem.mesh().nodes[n];
    if (x.x() > 49.999 && x.y() < 0.001) force[3 * static_cast<std::size_t>(n) + 1] = -30;
  }
  return force;
}

Scene scene_of(const RouteCase& c) {
  Scene scene = held_board();
  scene.solver.route = c.route;
  scene.fracture.alpha = c.alpha;
  for (auto& [name, m] : scene.materials) {
    if (!m.yield) m.young *= c.contrast;
    m.poisson = c.poisson;
  }
  return scene;
}

class EngineRoute : public ::testing::TestWithParam<RouteCase> {};

TEST_P(EngineRoute, StaysWithinTheTable) {
  const RouteCase& c = GetParam();
  Body body(scene_of(c));
  const std::vector<double> force = pull(*body.problem);
  const auto sequence =
      c.crack ? crack_sequence(*body.problem, 200, 12) : scattered_sequence(*body.problem, 200);
  const double tolerance = c.crack ? kCrackTolerance : kIntactTolerance;
  body.load(force);
  std::size_t done = 0;
  for (std::size_t k : {0U, 50U, 100U, 200U}) {
    while (done < k) {
      body.backend->destroy(std::span(sequence).subspan(done, std::min(c.batch, k - done)));
      done += std::min(c.batch, k - done);
    }
    const SolveReport report = body.backend->solve();
    EXPECT_LE(report.error, 1e-4);
    EXPECT_FALSE(report.polished);
    EXPECT_EQ(report.iterations, 0);
    const auto destroyed = body.backend->destroyed();
    const auto right = yardstick(*body.problem, destroyed, force);
    EXPECT_LE(displacement_error(body.problem->mesh(), destroyed, body.displacement(),
                                 right.displacement),
              tolerance)
        << k;
    EXPECT_LE(stress_error(destroyed, body.stress(), right.stress), tolerance) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sequences, EngineRoute,
    ::testing::Values(RouteCase{"InverseScattered", Route::inverse, false, 1},
                      RouteCase{"InverseCrack", Route::inverse, true, 1},
                      RouteCase{"InverseCrackBy10", Route::inverse, true, 10},
                      RouteCase{"FactorScattered", Route::factor, false, 1},
                      RouteCase{"FactorCrack", Route::factor, true, 1},
                      RouteCase{"FactorCrackBy100", Route::factor, true, 100},
                      RouteCase{"InverseContrast1e4", Route::inverse, true, 1, 1e2},
                      RouteCase{"FactorContrast1e4", Route::factor, true, 1, 1e2},
                      RouteCase{"InversePoisson499", Route::inverse, true, 10, 1, 0.499},
                      RouteCase{"FactorPoisson499", Route::factor, true, 10, 1, 0.499},
                      RouteCase{"InverseAlpha1e9", Route::inverse, true, 10, 1, 0.4, 1e-9},
                      RouteCase{"FactorAlpha1e9", Route::factor, true, 10, 1, 0.4, 1e-9}),
    [](const auto& p) { return p.param.name; });

// 300 fractures one by one: the rank would be 1800, and a new base or a compaction keeps it small.
TEST(EngineRoutes, MemoryOfTheDamageStaysBounded) {
  for (Route route : {Route::inverse, Route::factor}) {
    RouteCase c{"", route, false, 1};
    Body body(scene_of(c));
    const auto sequence = scattered_sequence(*body.problem, 300);
    for (Index e : sequence) body.backend->destroy(std::span(&e, 1));
    std::size_t small = 0;
    for (const BufferPlan& b : body.backend->buffers()) {
      if (b.name == "small matrix of the damage") small = b.bytes;
    }
    EXPECT_GT(small, 0u);
    EXPECT_LE(small, 8u * 4 * 1000 * 1000);
    body.load(pull(*body.problem));
    EXPECT_LE(body.backend->solve().error, 1e-9);
  }
}

}  // namespace
}  // namespace sunder::test
