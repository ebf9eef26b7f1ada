// SPDX-License-Identifier: Apache-2.0
// A joined board twisted as far as linear tissue has no meaning any more: what is called a rest is
// one nevertheless.
#include <gtest/gtest.h>

#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/plain/finite.hpp"
#include "fracture/criterion.hpp"
#include "frame/loads.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

constexpr double kSide = 50;

/// Between two hands that hold its edges; the lower one turns about the board's length.
Scene joined_board() {
  Scene scene;
  scene.mesh = structured_board({6, 6, 1, kSide, kSide, 5}, [](const Vec3& x) {
    return x.y() > 41 || x.y() < 9 ? "frame" : x.y() > 25 ? "upper" : "lower";
  });
  scene.materials = {{"upper", {5, 0.45, std::nullopt}},
                     {"lower", {8, 0.45, std::nullopt}},
                     {"frame", {5, 0.45, std::nullopt}}};
  scene.interfaces.push_back({{"lower", "upper"}, 1, 1, 1});
  for (const double y : {0.0, kSide}) {
    Instrument hand;
    hand.name = y == 0 ? "lower" : "upper";
    hand.action = Grip{Box{Vec3(-1, y - .01, -1), Vec3(51, y + .01, 6)}, Vec3(0, 0, 0), Axes{7},
                       true, Vec3(0, 0, 0)};
    scene.instruments.push_back(hand);
  }
  return scene;
}

// Layers under a twist of 120 degrees are all but inside out: a step of the iteration often ends
// where their law knows no energy. What stress would change by such a step is no error's measure: a
// residual of .5 % was called a rest by it.
TEST(JoinedBoard, TwistedFarRestsWhereTheYardstickDoes) {
  const auto problem = std::make_shared<const Problem>(joined_board());
  const auto criterion = make_criterion(*problem);
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  Loads loads(*problem);
  const std::vector<std::uint8_t> none(problem->mesh().tets.size(), 0);
  const plain::FiniteBody yardstick(*problem, none);
  const double tolerance = problem->scene().solver.tolerance;
  std::vector<double> u(problem->dofs().size());
  for (double degrees = 30; degrees <= 120; degrees += 30) {
    loads.turn(0, Vec3(0, degrees, 0));
    std::vector<Finding> findings;
    loads.update(0, *criterion, none, findings);
    backend->set_load(loads.load());
    SolveReport report = backend->solve();
    for (int calls = 0; report.unfinished && calls < 400; ++calls) report = backend->solve();
    ASSERT_FALSE(report.unfinished) << degrees;
    backend->read_displacement(u);
    const auto rest = yardstick.solve(loads.load(), u).displacement;
    EXPECT_LE(report.error, tolerance) << degrees;
    EXPECT_LE(stress_error(none, yardstick.stress(u, StressMeasure::cauchy),
                           yardstick.stress(rest, StressMeasure::cauchy)),
              tolerance)
        << degrees;
  }
}

}  // namespace
}  // namespace sunder::test
