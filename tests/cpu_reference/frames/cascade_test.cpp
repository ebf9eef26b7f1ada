// SPDX-License-Identifier: Apache-2.0
// A long tear: bases that come from another thread, at the same event whatever that takes.
#include <gtest/gtest.h>

#include <cmath>

#include "cpu_reference/routes.hpp"
#include "rebasing_routes.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {
namespace {

std::vector<double> corner_pull(const Problem& problem) {
  std::vector<double> force(problem.dofs().size(), 0.0);
  for (Index n = 0; n < problem.node_count(); ++n) {
    const Vec3& x = problem.mesh().nodes[n];
    if (x.x() > 49.999 && x.y() < 0.001) force[3 * static_cast<std::size_t>(n) + 1] = -3;
  }
  return force;
}

/// Displacements along a tear of 240 elements, every 40.
std::vector<std::vector<double>> tear(Route route, int& bases, bool grips, bool check) {
  Scene scene = pulled_board();
  scene.solver.route = route;
  if (grips) {
    scene.instruments[0].action = Grip{lower_right_corner(), Vec3::Constant(0.25), Axes{7}};
  }
  const Body body(std::move(scene));
  const auto force =
      grips ? std::vector<double>(body.problem->dofs().size(), 0.0) : corner_pull(*body.problem);
  const std::vector<double> moved(body.problem->gripped_dofs().size(), 0.25);
  const auto sequence = crack_sequence(*body.problem, 240, 8);
  std::vector<std::vector<double>> all;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    body.backend->destroy({&sequence[i], 1});
    body.load(force, moved);
    const SolveReport report = body.backend->solve();
    EXPECT_LE(report.error, kCrackTolerance) << i;
    if ((i + 1) % 40 != 0) continue;
    all.push_back(body.displacement());
    if (!check || (i + 1) % 120 != 0) continue;
    const auto destroyed = body.backend->destroyed();
    const auto right = yardstick(*body.problem, destroyed, force, moved);
    EXPECT_LE(displacement_error(body.problem->mesh(), destroyed, all.back(), right.displacement),
              kCrackTolerance);
    EXPECT_LE(stress_error(destroyed, body.stress(), right.stress), kCrackTolerance);
  }
  for (const BufferPlan& b : body.backend->buffers()) {
    bases += b.name.starts_with("damaged factor") || b.name.starts_with("stiffness lost");
  }
  return all;
}

class Cascade : public ::testing::TestWithParam<RebasingRoute> {};

TEST_P(Cascade, StaysRightThroughRebasesAndRepeatsBitByBit) {
  int bases = 0;
  const auto once = tear(GetParam().route, bases, GetParam().grips, true);
  EXPECT_EQ(bases, 1) << "the tear is long enough for a new base";
  EXPECT_EQ(once, tear(GetParam().route, bases, GetParam().grips, false));
}

INSTANTIATE_TEST_SUITE_P(Tears, Cascade, rebasing_routes(), name_of);

}  // namespace
}  // namespace sunder::test
