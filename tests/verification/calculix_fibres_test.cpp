// SPDX-License-Identifier: Apache-2.0
// Transversely isotropic elasticity against CalculiX on the same mesh: one direction, and
// directions that differ from element to element, intact and with elements gone.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "support/loads.hpp"
#include "support/structured_board.hpp"
#include "verification/calculix.hpp"

namespace sunder::test {
namespace {

// CalculiX prints seven digits.
constexpr double kSevenDigits = 1e-6;
// What is left of a destroyed element there; ours adds nothing.
constexpr double kNextToNothing = 1e-9;

/// 6 x 4 x 2 mm, clamped at x = 0, inner nodes moved at random; the upper half is isotropic.
Scene fibred_block(const decltype(Fibres::direction)& direction) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> any(-1, 1);
  Scene scene;
  scene.mesh = structured_board({6, 4, 2, 6, 4, 2}, [](const Vec3& x) {
    return std::string(x.y() < 2 ? "fibred" : "plain");
  });
  for (Vec3& x : scene.mesh.nodes) {
    const bool inside = x.x() > 0 && x.x() < 6 && x.y() > 0 && x.y() < 4 && x.z() > 0 && x.z() < 2;
    if (inside) x += 0.2 * Vec3(any(generator), any(generator), any(generator));
  }
  scene.materials["plain"] = {3, 0.3, {}};
  Material m{2, 0.4, {}};
  Fibres f;
  f.direction = direction;
  f.young_along = 15;
  f.poisson_along = 0.25;
  f.shear_along = 4;
  m.fibres.push_back(f);
  scene.materials["fibred"] = m;
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
  Instrument tool;
  tool.name = "pull";
  tool.action = Pull{Box{Vec3(6 - 1e-6, -1, -1), Vec3(9, 9, 9)}, Vec3(0.3, -0.2, 0.1)};
  scene.instruments.push_back(tool);
  return scene;
}

void expect_fibres_agree(Scene scene, const std::vector<Index>& gone) {
  ASSERT_TRUE(calculix_installed())
      << "the program ccx is missing; install it with: apt-get install calculix-ccx";
  scene.steps = 2;
  if (!gone.empty()) scene.removals.push_back({1, gone});
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!run.done()) run.step();
  std::vector<double> share(problem->mesh().tets.size(), 1.0);
  for (Index e : gone) share[static_cast<std::size_t>(e)] = kNextToNothing;
  const std::vector<Index> end = nodes_in(problem->mesh(), {Vec3(6 - 1e-6, -1, -1), Vec3(9, 9, 9)});
  const CalculixResult theirs = run_calculix(
      *problem, share, shared_force(problem->mesh(), end, Vec3(0.3, -0.2, 0.1)),
      std::filesystem::temp_directory_path() / ("calculix_fibres_" + std::to_string(getpid())));
  double moved = 0, apart = 0, stressed = 0, stress_apart = 0;
  const auto& ours = run.displacement();
  for (std::size_t n = 0; n < ours.size(); ++n) {
    const Vec3 their(theirs.displacement[3 * n], theirs.displacement[3 * n + 1],
                     theirs.displacement[3 * n + 2]);
    moved = std::max(moved, their.norm());
    apart = std::max(apart, (ours[n] - their).norm());
  }
  const auto& stress = run.stress();
  for (std::size_t e = 0; e < stress.size(); ++e) {
    if (share[e] != 1) continue;
    stressed = std::max(stressed, theirs.stress[e].norm());
    stress_apart = std::max(stress_apart, (stress[e] - theirs.stress[e]).norm());
  }
  EXPECT_LE(apart, kSevenDigits * moved);
  EXPECT_LE(stress_apart, kSevenDigits * stressed);
}

TEST(CalculiXFibres, AgreesOnOneDirection) {
  expect_fibres_agree(fibred_block(Vec3(1, 2, -0.5)), {});
}
TEST(CalculiXFibres, AgreesRoundAnAxis) {
  expect_fibres_agree(fibred_block(AroundAxis{Vec3(3, -1, 0), Vec3(0.2, 0.1, 1)}), {});
}
TEST(CalculiXFibres, AgreesOnATornBlock) {
  expect_fibres_agree(fibred_block(Vec3(1, 1, 0)), {40, 41, 42, 60, 61, 100});
}

}  // namespace
}  // namespace sunder::test
