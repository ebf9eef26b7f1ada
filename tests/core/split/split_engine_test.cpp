// SPDX-License-Identifier: Apache-2.0
// Boards that a crack splits on the routes of the CPU, against the yardstick on the split mesh.
#include "split_against_fresh.hpp"

namespace sunder {
namespace {

using Case = test::SplitCase;
using test::expect_as_fresh;
using test::grips_of;
using test::kBy;
using test::scene_of;

std::string name_of(const ::testing::TestParamInfo<Case>& info) {
  const Case& c = info.param;
  return std::string(c.route == Route::inverse ? "Inverse" : "Factor") +
         (c.grip ? "Grip" : "Pull") + (c.notch ? "Notch" : "") + (c.poisson > 0.4 ? "Nu45" : "Nu3");
}

class SplitEngine : public ::testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(All, SplitEngine,
                         ::testing::Values(Case{Route::inverse, false, 0.3, false},
                                           Case{Route::factor, false, 0.3, false},
                                           Case{Route::inverse, true, 0.45, false},
                                           Case{Route::factor, true, 0.3, true},
                                           Case{Route::inverse, false, 0.45, true}),
                         name_of);

TEST_P(SplitEngine, FollowsACrackAsAFreshFactorOfItsMeshSays) {
  const Case& c = GetParam();
  std::mt19937 random(7);
  const Mesh mesh = test::shaken_board({12, 10, 2, 12, 10, 2}, random, 0.2);
  const auto problem = std::make_shared<const Problem>(scene_of(c, mesh));
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  test::EdgeSplit crack(*problem);
  const auto& held = problem->instrument_nodes()[0].nodes;
  const std::vector<double> force = c.grip
                                        ? std::vector<double>(3 * problem->mesh().nodes.size(), 0.0)
                                        : test::shared_force(problem->mesh(), held, kBy);
  const std::vector<double> grips = grips_of(*problem);
  if (c.notch) {
    std::vector<Index> notch;
    for (Index e = 0; e < problem->tet_count(); ++e) {
      const Vec2& at = crack.board.centroid(e);
      if (at.x() < 1 && std::abs(at.y() - 4.5) < 0.5) notch.push_back(e);
    }
    for (Index e : notch) crack.destroyed[static_cast<std::size_t>(e)] = 1;
    backend->set_load(test::load_of(*problem, force, grips));
    backend->destroy(notch);
  }
  const auto solve = [&] {
    backend->set_load(test::load_of(*problem, force, grips));
    const SolveReport report = backend->solve();
    static_cast<void>(backend->stress());
    EXPECT_LE(report.error, 1e-8);
  };
  const auto first = crack.begin(0.1);
  ASSERT_TRUE(first.moved());
  backend->change(first.change);
  solve();
  expect_as_fresh(crack, c, *backend, force);
  std::uniform_real_distribution<double> kink(-0.3, 0.3);
  for (int i = 0; i < 7; ++i) {
    const auto step = crack.advance(kink(random));
    ASSERT_TRUE(step.moved() && !step.through) << i;
    backend->change(step.change);
    if (i % 3 != 0) continue;
    solve();
    expect_as_fresh(crack, c, *backend, force);
  }
}

}  // namespace
}  // namespace sunder
