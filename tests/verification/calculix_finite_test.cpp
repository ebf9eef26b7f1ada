// SPDX-License-Identifier: Apache-2.0
// Saint Venant-Kirchhoff elasticity against CalculiX with NLGEOM on the same mesh: a cantilever
// that bends by half its length.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

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

TEST(CalculiXFinite, BendsACantileverAlike) {
  ASSERT_TRUE(calculix_installed())
      << "the program ccx is missing; install it with: apt-get install calculix-ccx";
  const Problem problem(cantilever());
  const std::vector<Index> end = nodes_in(problem.mesh(), {Vec3(9.999, -1, -1), Vec3(11, 9, 9)});
  const auto force = shared_force(problem.mesh(), end, Vec3(0, -0.02, 0.005));
  const std::vector<double> intact(problem.mesh().tets.size(), 1.0);
  const CalculixResult theirs = run_calculix(
      problem, intact, force,
      std::filesystem::temp_directory_path() / ("calculix_finite_" + std::to_string(getpid())),
      calculix::Theory::finite);
  const plain::Solution ours =
      plain::FiniteBody(problem, plain::kSaintVenantKirchhoff).solve(load_of(problem, force, {}));
  const std::vector<double> none(force.size(), 0);
  const double moved = largest_difference(ours.displacement, none);
  EXPECT_GT(moved, 4);
  // It prints seven digits; and by the linear law the end would not move towards the clamp.
  EXPECT_LE(largest_difference(ours.displacement, theirs.displacement), 1e-5 * moved);
  EXPECT_LT(ours.displacement[3 * static_cast<std::size_t>(end[0])], -1);
}

}  // namespace
}  // namespace sunder::test
