// SPDX-License-Identifier: Apache-2.0
// Beyond what the accuracy table names: stiffness contrast 1e6, Poisson's ratio .4999, a sliver of
// quality 1e-3, and all at once. A frame is right to the scene's tolerance or refused with the
// reason; the last two by themselves stay within the table along a crack.
#include <gtest/gtest.h>

#include <cmath>

#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/sliver.hpp"
#include "support/structured_board.hpp"
#include "support/table1_board.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {
namespace {

struct Extreme {
  const char* name;
  double contrast = 100, poisson = 0.4, sliver = 1;
  bool in_table = true;
};

struct Engine {
  const char* name;
  Route route;
  Update update = Update::automatic;
};

Scene extreme_board(const Extreme& extreme, const Engine& engine) {
  Scene scene;
  scene.mesh = structured_board({10, 10, 1, 50, 50, 5}, [](const Vec3& x) {
    return x.y() > 45 ? "top-frame" : x.y() < 5 ? "bottom-frame" : x.y() > 25 ? "upper" : "lower";
  });
  if (extreme.sliver < 1) make_sliver(scene.mesh, Vec3(25, 37.5, 2.5), 2.5, extreme.sliver);
  scene.materials = table1_materials();
  set_contrast(scene, extreme.contrast);
  set_poisson(scene, extreme.poisson);
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 6)}, Axes{7}});
  scene.solver.backend = "cpu";
  scene.solver.route = engine.route;
  scene.solver.update = engine.update;
  scene.solver.tolerance = 1e-7;
  return scene;
}

/// Between two rows of cells, into the board.
std::vector<Index> crack(const Problem& problem) {
  std::vector<Index> sequence;
  for (double row : {27.5, 32.5}) {
    for (Index e : elements_across(problem.mesh(), row)) {
      const bool taken = std::ranges::find(sequence, e) != sequence.end();
      if (!taken && problem.breakable(e) && centroid(problem.mesh(), e).x() > 12) {
        sequence.push_back(e);
      }
    }
  }
  return sequence;
}

class Extremes : public ::testing::TestWithParam<std::tuple<Extreme, Engine>> {};

TEST_P(Extremes, AreRightOrRefusedWithTheReason) {
  const auto& [extreme, engine] = GetParam();
  const Body body(extreme_board(extreme, engine));
  const auto sequence = crack(*body.problem);
  ASSERT_GE(sequence.size(), 60u);
  const auto force = corner_force(body.problem->mesh(), Vec3(0, -60, 0));
  std::size_t done = 0;
  for (std::size_t k : {0U, 10U, 60U}) {
    for (; done < k; ++done) body.backend->destroy({&sequence[done], 1});
    body.load(force);
    SCOPED_TRACE(k);
    SolveReport report;
    try {
      report = body.backend->solve();
    } catch (const NumericalError& error) {
      EXPECT_FALSE(extreme.in_table) << error.what();
      EXPECT_NE(std::string(error.what()).find("ease contrast, Poisson's ratio or slivers"),
                std::string::npos)
          << error.what();
      return;
    }
    EXPECT_LE(report.error, body.problem->scene().solver.tolerance);
    const auto dead = body.backend->destroyed();
    const auto right = yardstick(*body.problem, dead, force);
    const double tolerance = extreme.in_table && !report.polished
                                 ? kCrackTolerance
                                 : body.problem->scene().solver.tolerance;
    EXPECT_LE(
        displacement_error(body.problem->mesh(), dead, body.displacement(), right.displacement),
        tolerance);
    EXPECT_LE(stress_error(dead, body.stress(), right.stress), tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Boards, Extremes,
    ::testing::Combine(::testing::Values(Extreme{"Contrast1e6", 1e6, 0.4, 1, false},
                                         Extreme{"Poisson4999", 100, 0.4999},
                                         Extreme{"Sliver1e3", 100, 0.4, 1e-3},
                                         Extreme{"AllAtOnce", 1e6, 0.4999, 1e-3, false}),
                       ::testing::Values(Engine{"InverseEager", Route::inverse, Update::eager},
                                         Engine{"Inverse", Route::inverse},
                                         Engine{"Condensed", Route::condensed},
                                         Engine{"Factor", Route::factor}, Engine{"Cg", Route::cg})),
    [](const auto& p) {
      return std::string(std::get<0>(p.param).name) + std::get<1>(p.param).name;
    });

}  // namespace
}  // namespace sunder::test
