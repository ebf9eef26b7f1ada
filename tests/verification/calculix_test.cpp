// SPDX-License-Identifier: Apache-2.0
// The board of Table 1 against CalculiX on the same mesh, intact and torn.
#include "verification/calculix.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

// CalculiX prints seven digits: rounding of each number is up to 5e-7 of it.
constexpr double kPrintPrecision = 1e-6;

void expect_agreement(std::size_t fractures, Route route) {
  ASSERT_TRUE(calculix_installed())
      << "the program ccx is missing; install it with: apt-get install calculix-ccx";
  Scene scene = held_board();
  scene.solver.route = route;
  Body body(std::move(scene));
  const Mesh& mesh = body.problem->mesh();
  std::vector<double> force(3 * mesh.nodes.size(), 0.0);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3& x = mesh.nodes[n];
    if (x.x() > 49.999 && x.y() < 0.001) force[3 * n + 1] = -30;  // two nodes: 60 N
  }
  const auto torn = crack_sequence(*body.problem, fractures, 12);
  if (!torn.empty()) body.backend->destroy(torn);
  body.load(force);
  body.backend->solve();
  const std::string folder = ::testing::TempDir() + "sunder-ccx-" + std::to_string(getpid());
  const CalculixResult other = run_calculix(*body.problem, body.scale(), force, folder);
  const auto destroyed = body.backend->destroyed();
  const double u = displacement_error(mesh, destroyed, body.displacement(), other.displacement);
  const double s = stress_error(destroyed, body.stress(), other.stress);
  EXPECT_TRUE(u <= kPrintPrecision) << "displacement " << u;
  EXPECT_TRUE(s <= kPrintPrecision) << "stress " << s;
}

TEST(CalculiX, AgreesOnTheIntactBoard) { expect_agreement(0, Route::cg); }
TEST(CalculiX, AgreesOn32FracturesByTheInverse) { expect_agreement(32, Route::inverse); }
TEST(CalculiX, AgreesOn32FracturesByConjugateGradients) { expect_agreement(32, Route::cg); }

}  // namespace
}  // namespace sunder::test
