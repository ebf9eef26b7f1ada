// SPDX-License-Identifier: Apache-2.0
// A board whose cracks split, with a history, for what a host does to it.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "cpu_reference/plain/finite.hpp"
#include "split_against_fresh.hpp"

namespace sunder::test {

using Blade = std::vector<std::array<Vec3, 3>>;

/// From one place to another, seen from above, through the board.
inline Blade through(const Vec2& a, const Vec2& b) {
  const Vec3 p(a.x(), a.y(), -5), q(a.x(), a.y(), 9), r(b.x(), b.y(), -5), s(b.x(), b.y(), 9);
  return {{p, q, r}, {q, s, r}};
}

struct CutCase {
  std::optional<MaterialLaw> law;  // none: linear
  Route route;
  bool grip;
};

inline std::string name_of(const ::testing::TestParamInfo<CutCase>& info) {
  const CutCase& c = info.param;
  return std::string(!c.law                            ? "Linear"
                     : c.law == MaterialLaw::corotated ? "Corotated"
                                                       : "NeoHookean") +
         (c.route == Route::inverse ? "Inverse" : "Factor") + (c.grip ? "Grip" : "Pull");
}

/// Ten by eight cells, held along y = 8, pulled or moved along y = 0; nothing breaks by itself.
inline Scene scene_of(const CutCase& c, const Mesh& mesh) {
  Scene scene = scene_of(SplitCase{c.route, c.grip, 0.3, false}, mesh);
  if (c.law) {
    scene.materials["board"].law = *c.law;
    scene.solver.tolerance = 1e-8;
  }
  scene.materials["board"].yield = 1e6;
  scene.steps = 50;
  return scene;
}

inline Mesh cut_board() {
  std::mt19937 random(5);
  return shaken_board({10, 8, 2, 10, 8, 2}, random, 0.2);
}

struct CutRun {
  explicit CutRun(Scene scene)
      : problem(std::make_shared<const Problem>(std::move(scene))),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {
    simulation.keep_history([p = problem] { return cpu_reference::create(p, needs_of(*p)); });
  }
  explicit CutRun(const CutCase& c) : CutRun(scene_of(c, cut_board())) {}

  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

inline std::vector<double> flat(const std::vector<Vec3>& at) {
  std::vector<double> u;
  for (const Vec3& x : at) u.insert(u.end(), x.begin(), x.end());
  return u;
}

/// Against the mesh whose faces are open from the start, what a host holds held where it is.
inline void expect_as_fresh(const CutRun& run, const CutCase& c) {
  const Simulation& s = run.simulation;
  const Problem whole(scene_of(c, s.mesh()));
  const std::vector<double> u = flat(s.displacement());
  const auto own = run.problem->gripped_dofs();
  std::map<Index, double> held;
  const std::vector<double> grips = grips_of(whole);
  for (std::size_t g = 0; g < grips.size(); ++g) held[whole.gripped_dofs()[g]] = grips[g];
  for (Index d : s.backend().gripped_dofs().subspan(own.size())) {
    const auto at = std::ranges::find(run.problem->dofs(), d) - run.problem->dofs().begin();
    const Index there = whole.dofs()[static_cast<std::size_t>(at)];
    held[there] = u[static_cast<std::size_t>(at)];
  }
  std::vector<Index> gripped;
  std::vector<double> by;
  for (const auto& [d, value] : held) {
    gripped.push_back(d);
    by.push_back(value);
  }
  const Problem fresh(whole, gripped);
  const std::vector<std::uint8_t> none(fresh.mesh().tets.size(), 0);
  std::vector<double> force(3 * fresh.mesh().nodes.size(), 0.0);
  if (!c.grip) {
    force = shared_force(run.problem->mesh(), run.problem->instrument_nodes()[0].nodes, kBy);
    force.resize(3 * fresh.mesh().nodes.size(), 0.0);
  }
  const double tolerance = c.law ? 1e-7 : kCrackTolerance;
  if (c.law) {
    const plain::FiniteBody newton(fresh, none);
    const auto expected = newton.solve(load_of(fresh, force, by), u);
    EXPECT_LE(displacement_error(fresh.mesh(), none, u, expected.displacement), tolerance);
    EXPECT_LE(
        stress_error(none, s.stress(), newton.stress(expected.displacement, StressMeasure::cauchy)),
        tolerance);
    return;
  }
  const auto expected = yardstick(fresh, none, force, by);
  EXPECT_LE(displacement_error(fresh.mesh(), none, u, expected.displacement), tolerance);
  EXPECT_LE(stress_error(none, s.stress(), expected.stress), tolerance);
}

}  // namespace sunder::test
