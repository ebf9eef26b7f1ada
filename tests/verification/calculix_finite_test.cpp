// SPDX-License-Identifier: Apache-2.0
// Saint Venant-Kirchhoff elasticity against CalculiX with NLGEOM on the same mesh: a cantilever
// that bends by half its length.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <random>

#include "cpu_reference/plain/finite.hpp"
#include "support/loads.hpp"
#include "support/structured_board.hpp"
#include "verification/calculix.hpp"

namespace sunder::test {
namespace {

/// 10 x 1 x 1 mm, clamped at x = 0.
Scene cantilever() {
  Scene scene;
  scene.mesh = structured_board({16, 2, 2, 10, 1, 1});
  scene.materials["board"] = {5, 0.3, 2.0};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
  return scene;
}

double largest_difference(std::span<const double> a, std::span<const double> b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

/// Of displacements, relative to the largest, where linear theory is off by over a tenth. CalculiX
/// prints seven digits.
void expect_agreement(const Problem& problem, std::span<const double> force) {
  ASSERT_TRUE(calculix_installed())
      << "the program ccx is missing; install it with: apt-get install calculix-ccx";
  const std::vector<double> intact(problem.mesh().tets.size(), 1.0), none(force.size(), 0.0);
  const CalculixResult theirs = run_calculix(
      problem, intact, force,
      std::filesystem::temp_directory_path() / ("calculix_finite_" + std::to_string(getpid())),
      calculix::Theory::finite);
  const plain::Solution ours =
      plain::FiniteBody(problem, plain::kSaintVenantKirchhoff).solve(load_of(problem, force, {}));
  const double moved = largest_difference(ours.displacement, none);
  const plain::Solution linear = plain::Body(problem).solve(load_of(problem, force, {}));
  EXPECT_GT(largest_difference(ours.displacement, linear.displacement), 0.1 * moved);
  EXPECT_LE(largest_difference(ours.displacement, theirs.displacement), 1e-5 * moved);
}

TEST(CalculiXFinite, BendsACantileverAlike) {
  const Problem problem(cantilever());
  const std::vector<Index> end = nodes_in(problem.mesh(), {Vec3(9.999, -1, -1), Vec3(11, 9, 9)});
  expect_agreement(problem, shared_force(problem.mesh(), end, Vec3(0, -0.02, 0.005)));
}

TEST(CalculiXFinite, PullsThePapersBoardAlike) {
  const Problem problem(held_board());
  expect_agreement(problem, corner_force(problem.mesh(), Vec3(0, -10, 0)));
}

// Two materials, inner nodes moved at random, forces at random on the far end.
TEST(CalculiXFinite, DeformsARandomBodyAlike) {
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> any(-1, 1);
  Scene scene;
  scene.mesh = structured_board(
      {4, 3, 2, 4, 3, 2}, [](const Vec3& x) { return std::string(x.y() < 1 ? "stiff" : "soft"); });
  const auto inside = [](const Vec3& x) {
    return x.x() > 0 && x.x() < 4 && x.y() > 0 && x.y() < 3 && x.z() > 0 && x.z() < 2;
  };
  for (Vec3& x : scene.mesh.nodes) {
    if (inside(x)) x += 0.2 * Vec3(any(generator), any(generator), any(generator));
  }
  scene.materials["stiff"] = {20, 0.3, 2.0};
  scene.materials["soft"] = {5, 0.45, 2.0};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
  const Problem problem(std::move(scene));
  std::vector<double> force(problem.dofs().size(), 0.0);
  for (std::size_t i = 0; i < force.size(); ++i) {
    const Vec3& x = problem.mesh().nodes[i / 3];
    if (x.x() > 3.5) force[i] = 0.1 * any(generator) + (i % 3 == 0 ? 0.3 : 0.15);
  }
  expect_agreement(problem, force);
}

}  // namespace
}  // namespace sunder::test
