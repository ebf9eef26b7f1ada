// SPDX-License-Identifier: Apache-2.0
// Internal forces and tangent of a body: differences, balances, the patch test, the linear law's
// own path, and the yardstick.
#include "body/hyperelastic.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "body/assembly.hpp"
#include "cpu_reference/plain/finite.hpp"
#include "linear_algebra/factor.hpp"
#include "material/corotated.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "material/saint_venant_kirchhoff.hpp"
#include "support/assembled_tangent.hpp"
#include "support/loads.hpp"
#include "support/structured_board.hpp"

namespace sunder::fem {
namespace {

using test::BoardShape;

/// 4 x 3 x 2 mm, two materials, inner nodes moved, held at x = 0.
Scene block() {
  Scene scene;
  scene.mesh = test::shaken_block();
  scene.materials["stiff"] = {50, 0.3, 2.0};
  scene.materials["soft"] = {5, 0.45, 2.0};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
  return scene;
}

/// Displaced at random by up to `size`, on top of u = (F - I) X.
std::vector<double> displaced(const Mesh& mesh, const Mat3& f, double size, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> any(-size, size);
  std::vector<double> u;
  for (const Vec3& x : mesh.nodes) {
    const Vec3 moved = (f - Mat3::Identity()) * x;
    for (int axis = 0; axis < 3; ++axis) u.push_back(moved[axis] + any(generator));
  }
  return u;
}

Mat3 turned(double degrees) {
  return Eigen::AngleAxisd(degrees * EIGEN_PI / 180, Vec3(1, -2, 3).normalized())
      .toRotationMatrix();
}
Mat3 sheared() {
  Mat3 f;
  f << 1.2, 0.3, 0, -0.1, 0.9, 0.2, 0.05, 0, 1.1;
  return f;
}

std::vector<double> forces(const HyperelasticBody& body, std::span<const double> u) {
  std::vector<double> f(u.size());
  EXPECT_TRUE(std::isfinite(internal_forces(body, u, f)));
  return f;
}
double largest(std::span<const double> of) {
  double most = 0;
  for (double x : of) most = std::max(most, std::abs(x));
  return most;
}

class Hyperelastic : public testing::Test {
 protected:
  Problem problem{block()};
  /// The stiff volume by Saint Venant-Kirchhoff: a body may mix laws.
  std::vector<const Law*> mixed(const Law& soft) const {
    std::vector<const Law*> laws = one_law(problem, soft);
    for (std::size_t v = 0; v < laws.size(); ++v) {
      if (problem.mesh().volumes[v].name == "stiff") laws[v] = &kSaintVenantKirchhoff;
    }
    return laws;
  }
};

// Fourth-order central differences of 1e-3 mm: error 1e-12 and rounding 1e-13 of the energy.
TEST_F(Hyperelastic, ForcesAreTheGradientOfTheEnergyAndTheTangentIsTheirs) {
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  for (std::size_t e = 0; e < destroyed.size(); e += 7) destroyed[e] = 1;
  constexpr double kStep = 1e-3;
  for (const Law* soft : laws()) {
    const auto of = mixed(*soft);
    const HyperelasticBody body{problem, of, destroyed};
    std::vector<double> u = displaced(problem.mesh(), sheared(), 0.05);
    const std::vector<double> f = forces(body, u);
    EXPECT_EQ(energy(body, u), [&] {
      std::vector<double> same(u.size());
      return internal_forces(body, u, same);
    }());
    const Eigen::MatrixXd k = Eigen::MatrixXd(test::assemble_tangent(body, u, Tangent::exact))
                                  .selfadjointView<Eigen::Lower>();
    const auto moved = [&](std::size_t i, double by, const auto& what) {
      std::vector<double> at = u;
      at[i] += by;
      return what(at);
    };
    for (std::size_t i = 0; i < u.size(); i += 11) {
      const auto w = [&](double by) {
        return moved(i, by, [&](const auto& at) { return energy(body, at); });
      };
      const double slope =
          (8 * (w(kStep) - w(-kStep)) - (w(2 * kStep) - w(-2 * kStep))) / (12 * kStep);
      EXPECT_NEAR(f[i], slope, 1e-8 * largest(f)) << soft->name;
      const Index column = problem.dofs()[i];
      if (column == kNone) continue;
      const auto force = [&](double by) {
        return moved(i, by, [&](const auto& at) {
          const std::vector<double> nodal = forces(body, at);
          std::vector<double> unknowns(static_cast<std::size_t>(problem.dof_count()));
          gather(problem, nodal, unknowns);
          return Eigen::VectorXd(
              Eigen::Map<const Eigen::VectorXd>(unknowns.data(), problem.dof_count()));
        });
      };
      const Eigen::VectorXd change =
          (8 * (force(kStep) - force(-kStep)) - (force(2 * kStep) - force(-2 * kStep))) /
          (12 * kStep);
      EXPECT_LE((k.col(column) - change).cwiseAbs().maxCoeff(), 1e-7 * k.cwiseAbs().maxCoeff())
          << soft->name;
    }
  }
}

TEST_F(Hyperelastic, ForcesBalanceAndSoDoTheirMoments) {
  for (const Law* soft : laws()) {
    if (soft == &kLinear) continue;  // its moments balance about the undeformed places
    const auto of = mixed(*soft);
    const HyperelasticBody body{problem, of};
    const std::vector<double> u = displaced(problem.mesh(), turned(70) * sheared(), 0.05);
    const std::vector<double> f = forces(body, u);
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    for (Index n = 0; n < problem.node_count(); ++n) {
      const Vec3 force(&f[3 * n]), x = problem.mesh().nodes[n] + Vec3(&u[3 * n]);
      sum += force;
      moment += x.cross(force);
    }
    EXPECT_LE(sum.norm(), 1e-12 * largest(f)) << soft->name;
    EXPECT_LE(moment.norm(), 1e-11 * largest(f)) << soft->name;
  }
}

TEST_F(Hyperelastic, ATurnedBodyBearsNoForce) {
  for (const Law* soft : laws()) {
    if (soft == &kLinear) continue;
    const auto of = mixed(*soft);
    for (double degrees : {30.0, 90.0, 180.0}) {
      const auto u = displaced(problem.mesh(), turned(degrees), 0);
      // 1e-15 of the gradient, times the bulk modulus of 60 MPa, times areas of a mm^2.
      EXPECT_LE(largest(forces({problem, of}, u)), 1e-12) << soft->name << " " << degrees;
    }
  }
}

// Every inner node of a body of one material is in equilibrium under an affine displacement.
TEST_F(Hyperelastic, PassesThePatchTest) {
  Scene scene = block();
  scene.materials["stiff"] = scene.materials["soft"];
  const Problem even(std::move(scene));
  for (const Law* law : laws()) {
    const auto of = one_law(even, *law);
    const auto f = forces({even, of}, displaced(even.mesh(), turned(50) * sheared(), 0));
    for (Index n = 0; n < even.node_count(); ++n) {
      const Vec3& x = even.mesh().nodes[n];
      const bool inside =
          x.x() > 0 && x.x() < 4 && x.y() > 0 && x.y() < 3 && x.z() > 0 && x.z() < 2;
      if (!inside) continue;
      EXPECT_LE(Vec3(&f[3 * n]).norm(), 1e-13 * largest(f)) << law->name;
    }
  }
}

TEST_F(Hyperelastic, LawLinearIsTheStiffnessThatThereIs) {
  const auto of = one_law(problem, kLinear);
  const HyperelasticBody body{problem, of};
  const auto u = displaced(problem.mesh(), sheared(), 0.3);
  std::vector<double> expected(u.size());
  apply_stiffness(problem, {}, u, expected);
  const std::vector<double> f = forces(body, u);
  for (std::size_t i = 0; i < u.size(); ++i) {
    EXPECT_NEAR(f[i], expected[i], 1e-13 * largest(expected));
  }
  const linear_algebra::SparseMatrix k = assemble_lower(problem, {});
  for (Tangent kind : {Tangent::exact, Tangent::projected}) {
    const linear_algebra::SparseMatrix tangent = test::assemble_tangent(body, u, kind);
    EXPECT_LE((tangent - k).norm(), 1e-14 * k.norm());
  }
}

// Of every law at rest.
TEST_F(Hyperelastic, AtRestEveryTangentIsTheLinearStiffness) {
  const linear_algebra::SparseMatrix k = assemble_lower(problem, {});
  const std::vector<double> u(problem.dofs().size(), 0);
  for (const Law* law : laws()) {
    const auto of = one_law(problem, *law);
    EXPECT_LE((test::assemble_tangent({problem, of}, u, Tangent::projected) - k).norm(),
              1e-14 * k.norm());
  }
}

// What it takes away has no positive part.
TEST_F(Hyperelastic, TheProjectedTangentIsTheNearestPositiveSemidefiniteOne) {
  const auto u = displaced(problem.mesh(), turned(30) * sheared(), 0.2);
  using Eigenvalues = Eigen::SelfAdjointEigenSolver<ElementMatrix>;
  int negative = 0;
  for (const Law* law : laws()) {
    const auto of = one_law(problem, *law);
    const HyperelasticBody body{problem, of};
    if (!std::isfinite(energy(body, u))) continue;
    for (Index e = 0; e < problem.tet_count(); ++e) {
      const ElementMatrix k = element_tangent(body, e, u, Tangent::exact);
      const ElementMatrix projected = element_tangent(body, e, u, Tangent::projected);
      const double rounding = 1e-13 * k.norm();
      EXPECT_GE(Eigenvalues(projected).eigenvalues()[0], -rounding);
      EXPECT_LE(Eigenvalues(k - projected).eigenvalues()[11], rounding);
      negative += Eigenvalues(k).eigenvalues()[0] < -rounding;
    }
  }
  EXPECT_GT(negative, 100);
}

TEST_F(Hyperelastic, DestroyedElementsAddNothingAndFreezeWhatTheyAloneHold) {
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 1);
  const auto of = one_law(problem, kNeoHookean);
  const HyperelasticBody none{problem, of, destroyed};
  const auto u = displaced(problem.mesh(), -Mat3::Identity(), 0.2);  // no state of a live one
  EXPECT_EQ(energy(none, u), 0);
  EXPECT_EQ(largest(forces(none, u)), 0);
  const Eigen::MatrixXd k(test::assemble_tangent(none, u, Tangent::exact));
  EXPECT_EQ(k, Eigen::MatrixXd::Identity(k.rows(), k.cols()));
  destroyed[0] = 0;
  EXPECT_TRUE(std::isinf(energy(none, u)));
}

// Two implementations that share no formula: what one brings to rest is at rest for the other, and
// its exact tangent takes the last step.
TEST_F(Hyperelastic, IsAtRestWhereTheYardstickIs) {
  struct Row {
    const Law& law;
    const plain::Law& yardstick;
  };
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  for (std::size_t e = 30; e < 50; ++e) destroyed[e] = 1;
  for (const Row& row : {Row{kCorotated, plain::kCorotated}, Row{kNeoHookean, plain::kNeoHookean},
                         Row{kSaintVenantKirchhoff, plain::kSaintVenantKirchhoff}}) {
    const std::vector<Index> end =
        test::nodes_in(problem.mesh(), {Vec3(3.9, -1, -1), Vec3(9, 9, 9)});
    const auto force = test::shared_force(problem.mesh(), end, Vec3(2, -1.5, 0.5));
    const plain::Solution s = plain::FiniteBody(problem, row.yardstick, destroyed)
                                  .solve(test::load_of(problem, force, {}));
    EXPECT_GT(largest(s.displacement), 0.5);  // of 4 mm: far from linear
    const auto of = one_law(problem, row.law);
    const HyperelasticBody body{problem, of, destroyed};
    const std::vector<double> f = forces(body, s.displacement);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(problem.dof_count());
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (problem.dofs()[i] != kNone) r[problem.dofs()[i]] = force[i] - f[i];
    }
    EXPECT_LE(r.norm(), 1e-10 * largest(force) * std::sqrt(static_cast<double>(end.size())) * 2);
    const linear_algebra::Factor factor(
        test::assemble_tangent(body, s.displacement, Tangent::exact));
    EXPECT_LE(factor.solve(r).cwiseAbs().maxCoeff(), 1e-9 * largest(s.displacement));
  }
}

}  // namespace
}  // namespace sunder::fem
