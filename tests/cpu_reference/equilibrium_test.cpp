// SPDX-License-Identifier: Apache-2.0
// What every exact solution of linear elasticity obeys, intact and torn, by both routes.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <numeric>

#include "body/assembly.hpp"
#include "body/element.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

struct EquilibriumCase {
  const char* name;
  Route route;
  std::size_t fractures;
};

class Equilibrium : public ::testing::TestWithParam<EquilibriumCase> {
 protected:
  static Body torn_board(double softer = 1) {
    Scene scene = held_board();
    scene.solver.route = GetParam().route;
    if (GetParam().route == Route::inverse) scene.solver.update = Update::eager;
    for (auto& [name, m] : scene.materials) m.young /= softer;
    Body body(std::move(scene));
    const auto sequence = crack_sequence(*body.problem, GetParam().fractures, 12);
    if (!sequence.empty()) body.backend->destroy(sequence);
    return body;
  }

  static std::vector<double> solve(Body& body, std::span<const double> force) {
    body.load(force);
    body.backend->solve();
    return body.displacement();
  }

  /// `force` at the nodes with x > 49.9 and low <= y <= high.
  static std::vector<double> pull(const Body& body, double low, double high, const Vec3& force) {
    const Mesh& mesh = body.problem->mesh();
    std::vector<double> f(3 * mesh.nodes.size(), 0.0);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      const Vec3& x = mesh.nodes[n];
      if (x.x() < 49.9 || x.y() < low || x.y() > high) continue;
      for (int axis = 0; axis < 3; ++axis) f[3 * n + static_cast<std::size_t>(axis)] = force[axis];
    }
    return f;
  }
};

double dot(std::span<const double> a, std::span<const double> b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

TEST_P(Equilibrium, ReactionsBalanceForceAndMoment) {
  Body body = torn_board();
  const Mesh& mesh = body.problem->mesh();
  const auto force = pull(body, -1, 1, Vec3(3, -30, 2));
  const auto u = solve(body, force);
  std::vector<double> ku(u.size());
  fem::apply_stiffness(*body.problem, body.scale(), u, ku);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  double forces = 0, moments = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    Vec3 total(&force[3 * n]);
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t i = 3 * n + static_cast<std::size_t>(axis);
      if (body.problem->dofs()[i] == kNone) total[axis] += ku[i];  // the support's force
    }
    sum += total;
    moment += mesh.nodes[n].cross(total);
    forces += total.norm();
    moments += mesh.nodes[n].cross(total).norm();
  }
  EXPECT_TRUE(sum.norm() <= 1e-12 * forces) << sum.norm() / forces;
  EXPECT_TRUE(moment.norm() <= 1e-10 * moments) << moment.norm() / moments;
}

// f.u = integral of stress times strain: V s : D^-1 s / a_e over the elements.
TEST_P(Equilibrium, WorkIsStrainEnergy) {
  Body body = torn_board();
  const auto force = pull(body, -1, 1, Vec3(3, -30, 2));
  const auto u = solve(body, force);
  const auto stress = body.stress();
  const auto scale = body.scale();
  double energy = 0;
  for (Index e = 0; e < body.problem->tet_count(); ++e) {
    const Voigt strain =
        elasticity(body.problem->small_strain(e)).ldlt().solve(stress[e] / scale[e]);
    energy += body.problem->shape(e).volume * stress[e].dot(strain);
  }
  const double work = dot(force, u);
  EXPECT_TRUE(std::abs(work - energy) <= 1e-11 * work) << work << " " << energy;
}

TEST_P(Equilibrium, TwoLoadsAreReciprocal) {
  Body body = torn_board();
  const auto f1 = pull(body, -1, 1, Vec3(0, -30, 0)), f2 = pull(body, 30, 40, Vec3(1, 0, 2));
  const auto u1 = solve(body, f1), u2 = solve(body, f2);
  const double energy = std::sqrt(dot(f1, u1) * dot(f2, u2));  // bounds |f1.u2|
  EXPECT_TRUE(std::abs(dot(f1, u2) - dot(f2, u1)) <= 1e-9 * energy);
}

TEST_P(Equilibrium, IsLinearInForceAndInverseStiffness) {
  Body body = torn_board(), softer = torn_board(4);
  const auto force = pull(body, -1, 1, Vec3(0, -30, 0));
  auto tripled = force;
  for (double& f : tripled) f *= 3;
  const Mesh& mesh = body.problem->mesh();
  const auto destroyed = body.backend->destroyed();
  auto u = solve(body, force);
  auto stress = body.stress();
  const auto soft_u = solve(softer, force);
  const auto soft_stress = softer.stress();
  const auto u3 = solve(body, tripled);
  auto four = u;
  for (double& v : u) v *= 3;
  for (double& v : four) v *= 4;
  EXPECT_TRUE(displacement_error(mesh, destroyed, u3, u) <= kIntactTolerance);
  EXPECT_TRUE(displacement_error(mesh, destroyed, soft_u, four) <= kIntactTolerance);
  EXPECT_TRUE(stress_error(destroyed, soft_stress, stress) <= kIntactTolerance);
}

TEST_P(Equilibrium, ZeroLoadGivesZeroes) {
  Body body = torn_board();
  const auto u = solve(body, std::vector<double>(body.problem->dofs().size(), 0.0));
  EXPECT_EQ(*std::max_element(u.begin(), u.end()), 0.0);
  EXPECT_EQ(*std::min_element(u.begin(), u.end()), 0.0);
  const SolveReport report = body.backend->solve();
  EXPECT_EQ(report.residual, 0.0);
  EXPECT_EQ(report.error, 0.0);
  EXPECT_FALSE(report.polished);
}

INSTANTIATE_TEST_SUITE_P(Routes, Equilibrium,
                         ::testing::Values(EquilibriumCase{"InverseIntact", Route::inverse, 0},
                                           EquilibriumCase{"InverseTorn", Route::inverse, 30},
                                           EquilibriumCase{"CgTorn", Route::cg, 30}),
                         [](const auto& p) { return p.param.name; });

TEST(Overflow, IsATypedError) {
  for (Route route : {Route::inverse, Route::cg}) {
    Scene scene = held_board();
    scene.solver.route = route;
    Body body(std::move(scene));
    std::vector<double> force(body.problem->dofs().size(), 0.0);
    force[0] = 1e308;
    force[4] = 1e308;
    body.load(force);
    EXPECT_THROW(body.backend->solve(), NumericalError);
    force.assign(force.size(), 0.0);
    body.load(force);
    EXPECT_EQ(body.backend->solve().error, 0.0) << "the backend must survive";
  }
}

}  // namespace
}  // namespace sunder::test
