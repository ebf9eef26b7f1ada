// SPDX-License-Identifier: Apache-2.0
// Boards that a crack splits on the routes of the CPU, against the yardstick on the split mesh.
#include <algorithm>
#include <numeric>

#include "cpu_reference/cpu_reference.hpp"
#include "split_bodies.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"
#include "support/yardstick.hpp"

namespace sunder {
namespace {

struct Case {
  Route route;
  bool grip;  // the lower side is held and moved, else pulled
  double poisson;
  bool notch;  // elements are destroyed where the crack begins
};

std::string name_of(const ::testing::TestParamInfo<Case>& info) {
  const Case& c = info.param;
  return std::string(c.route == Route::inverse ? "Inverse" : "Factor") +
         (c.grip ? "Grip" : "Pull") + (c.notch ? "Notch" : "") + (c.poisson > 0.4 ? "Nu45" : "Nu3");
}

const Vec3 kBy(0.1, -0.3, 0.05);  // of the pull [N] or the grip [mm]

Scene scene_of(const Case& c, Mesh mesh) {
  Scene scene = test::board_scene(std::move(mesh), FractureModel::b);
  scene.materials["board"] = {5.0, c.poisson, 1.0};
  scene.fracture.alpha = 1e-12;  // what ties lips is beyond the digits that are compared
  scene.fracture.crack = CrackWay::split;
  scene.solver.route = c.route;
  const Box lower{Vec3(-1, -1e-9, -1e9), Vec3(1e9, 1e-9, 1e9)};
  Instrument pull{"pull", Pull{lower, kBy}, {}};
  if (c.grip) pull.action = Grip{lower, kBy, Axes{7}};
  scene.instruments = {pull};
  return scene;
}

std::vector<double> grips_of(const Problem& problem) {
  std::vector<double> grips;
  for (Index d : problem.gripped_dofs()) {
    const auto at = std::ranges::find(problem.dofs(), d) - problem.dofs().begin();
    grips.push_back(kBy[static_cast<int>(at % 3)]);
  }
  return grips;
}

/// Forces act on nodes of the mesh, whatever has parted from them.
void expect_as_fresh(const test::EdgeSplit& crack, const Case& c, const Backend& backend,
                     std::vector<double> force) {
  const Problem fresh(scene_of(c, crack.mesh()));
  force.resize(3 * fresh.mesh().nodes.size(), 0.0);
  const auto expected = test::yardstick(fresh, crack.destroyed, force, grips_of(fresh));
  std::vector<Index> nodes(fresh.mesh().nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  std::vector<Vec3> at(nodes.size());
  backend.read_displacement(nodes, at);
  std::vector<double> u;
  for (const Vec3& x : at) u.insert(u.end(), x.begin(), x.end());
  EXPECT_LE(test::displacement_error(fresh.mesh(), crack.destroyed, u, expected.displacement),
            test::kCrackTolerance);
  std::vector<Voigt> stress(fresh.mesh().tets.size());
  backend.read_stress(stress);
  EXPECT_LE(test::stress_error(crack.destroyed, stress, expected.stress), test::kCrackTolerance);
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
