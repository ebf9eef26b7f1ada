// SPDX-License-Identifier: Apache-2.0
// Prescribed displacements by the compliance block against plain elimination of the same dofs
// (cpu_reference/plain), intact and torn, with supports, without any, and with two grips.
#include <gtest/gtest.h>

#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/structured_board.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {
namespace {

constexpr BoardShape kShape{8, 8, 1, 8, 8, 1};

Scene board() {
  Scene scene;
  scene.mesh = structured_board(kShape);
  scene.materials["board"] = {5, 0.4, 2.0};
  return scene;
}

Box edge(double y) { return {Vec3(-1, y - 1e-6, -1), Vec3(9, y + 1e-6, 2)}; }

Instrument grip(NodeSelection nodes, const Vec3& displacement, Axes axes) {
  Instrument tool;
  tool.action = Grip{std::move(nodes), displacement, axes};
  return tool;
}

/// Displacement of each gripped dof, in the problem's order, and its place among all dofs.
struct Gripped {
  explicit Gripped(const Problem& problem) {
    std::map<std::size_t, double> known;  // ascending as the unknowns are
    const auto& instruments = problem.scene().instruments;
    for (std::size_t i = 0; i < instruments.size(); ++i) {
      const auto* g = std::get_if<Grip>(&instruments[i].action);
      if (!g) continue;
      for (Index n : problem.instrument_nodes()[i].nodes) {
        for (int axis = 0; axis < 3; ++axis) {
          if (g->axes.has(axis))
            known[static_cast<std::size_t>(3 * n + axis)] = g->displacement[axis];
        }
      }
    }
    for (const auto& [place, value] : known) {
      places.push_back(place);
      values.push_back(value);
    }
  }
  std::vector<std::size_t> places;
  std::vector<double> values;
};

/// Compares displacement, stress and the grips' forces with elimination.
void expect_elimination(Scene scene, Route route, const std::vector<Index>& destroyed) {
  scene.solver.route = route;
  Body body(std::move(scene));
  const Problem& problem = *body.problem;
  if (!destroyed.empty()) body.backend->destroy(destroyed);
  const Gripped gripped(problem);
  ASSERT_EQ(gripped.places.size(), problem.gripped_dofs().size());
  std::vector<double> force(problem.dofs().size(), 0.0);
  for (std::size_t n = 0; n < problem.mesh().nodes.size(); ++n) {
    const Vec3& x = problem.mesh().nodes[n];
    if (x.x() > 7.9 && x.y() > 3.5 && x.y() < 4.5) force[3 * n] = 0.1;
  }
  body.load(force, gripped.values);
  const SolveReport report = body.backend->solve();
  EXPECT_TRUE(report.residual <= 1e-9) << report.residual;
  const auto ignored = body.backend->destroyed();
  const auto right = yardstick(problem, ignored, force, gripped.values);
  const auto u = body.displacement();
  EXPECT_TRUE(displacement_error(problem.mesh(), ignored, u, right.displacement) <=
              kIntactTolerance);
  EXPECT_TRUE(stress_error(ignored, body.stress(), right.stress) <= kIntactTolerance);
  const auto reactions = body.reactions();
  double largest = 0;
  for (double r : right.reactions) largest = std::max(largest, std::abs(r));
  for (std::size_t g = 0; g < reactions.size(); ++g) {
    EXPECT_EQ(u[gripped.places[g]], gripped.values[g]);
    EXPECT_TRUE(std::abs(reactions[g] - right.reactions[g]) <= 1e-9 * largest) << g;
  }
}

class Grips : public ::testing::TestWithParam<Route> {};

const std::vector<Index> kCrack = {6 * 32,     6 * 32 + 1, 6 * 32 + 2, 6 * 32 + 3, 6 * 32 + 4,
                                   6 * 32 + 5, 6 * 33,     6 * 33 + 1, 6 * 33 + 2, 6 * 33 + 3};

Scene gripped_corner() {
  Scene scene = board();
  scene.supports.push_back({edge(8), Axes{7}});
  scene.instruments.push_back(grip(edge(0), Vec3(0.1, -0.5, 0.05), Axes{7}));
  return scene;
}

TEST_P(Grips, WithSupports) { expect_elimination(gripped_corner(), GetParam(), {}); }
TEST_P(Grips, WithSupportsTorn) { expect_elimination(gripped_corner(), GetParam(), kCrack); }

TEST_P(Grips, OnSomeAxesOnly) {
  Scene scene = board();
  scene.supports.push_back({edge(8), Axes{7}});
  scene.instruments.push_back(grip(edge(0), Vec3(0, -0.5, 0), Axes{2}));
  expect_elimination(std::move(scene), GetParam(), kCrack);
}

TEST_P(Grips, TwoAtOnceWithASupport) {
  Scene scene = board();
  scene.supports.push_back({edge(8), Axes{7}});
  scene.instruments.push_back(grip(std::vector<Index>{0, 1}, Vec3(-0.2, -0.5, 0), Axes{7}));
  scene.instruments.push_back(grip(std::vector<Index>{7, 8}, Vec3(0.2, -0.4, 0.3), Axes{7}));
  expect_elimination(std::move(scene), GetParam(), kCrack);
}

// Nothing but grips holds the body: K0 alone is singular, the anchors must not show.
TEST_P(Grips, AloneHoldTheBody) {
  Scene scene = board();
  scene.instruments.push_back(grip(edge(8), Vec3(0, 0.3, 0), Axes{7}));
  scene.instruments.push_back(grip(edge(0), Vec3(0.1, -0.5, 0.05), Axes{7}));
  EXPECT_GT(Problem(scene).anchor_stiffness(), 0);
  expect_elimination(scene, GetParam(), {});
  expect_elimination(std::move(scene), GetParam(), kCrack);
}

// A grip that stays at zero is a support.
TEST_P(Grips, AtRestAreSupports) {
  Scene held = gripped_corner(), gripped = board();
  gripped.instruments.push_back(held.instruments.front());
  gripped.instruments.push_back(grip(edge(8), Vec3::Zero(), Axes{7}));
  held.solver.route = gripped.solver.route = GetParam();
  const Body a(std::move(held)), b(std::move(gripped));
  const Index nodes = (kShape.nx + 1) * 2;  // of one edge
  std::vector<double> moved;
  for (Index n = 0; n < nodes; ++n) moved.insert(moved.end(), {0.1, -0.5, 0.05});
  a.load({}, moved);
  b.load({}, Gripped(*b.problem).values);
  a.backend->solve();
  b.backend->solve();
  const std::vector<std::uint8_t> none(a.problem->mesh().tets.size(), 0);
  EXPECT_TRUE(displacement_error(a.problem->mesh(), none, b.displacement(), a.displacement()) <=
              kIntactTolerance);
  EXPECT_TRUE(stress_error(none, b.stress(), a.stress()) <= kIntactTolerance);
}

INSTANTIATE_TEST_SUITE_P(Routes, Grips, ::testing::Values(Route::inverse, Route::cg),
                         [](const auto& p) {
                           return p.param == Route::inverse ? "Inverse" : "Cg";
                         });

}  // namespace
}  // namespace sunder::test
