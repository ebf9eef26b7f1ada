// SPDX-License-Identifier: Apache-2.0
// The assembled stiffness, its element-by-element product, update vectors and the factor.
#include "body/assembly.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <random>

#include "body/event_factor.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/error.hpp"
#include "support/table1_board.hpp"

namespace sunder::fem {
namespace {

std::vector<double> random_scale(std::size_t count) {
  std::mt19937 generator(7);
  std::vector<double> scale(count);
  for (double& s : scale) s = generator() % 5 == 0 ? 1e-6 : 1.0;
  return scale;
}

Eigen::VectorXd random_vector(Index n) {
  std::mt19937 generator(11);
  Eigen::VectorXd x(n);
  for (double& v : x) v = static_cast<double>(generator()) / 4294967296.0 - 0.5;
  return x;
}

TEST(Assembly, MatrixAndElementProductAgree) {
  const Problem problem(test::held_board());
  const auto scale = random_scale(problem.mesh().tets.size());
  const Eigen::VectorXd x = random_vector(problem.dof_count());
  const linear_algebra::SparseMatrix k = assemble_lower(problem, scale);
  const Eigen::VectorXd by_matrix = k.selfadjointView<Eigen::Lower>() * x;
  std::vector<double> u(problem.dofs().size()), y(u.size());
  scatter(problem, {x.data(), static_cast<std::size_t>(x.size())}, u);
  apply_stiffness(problem, scale, u, y);
  Eigen::VectorXd by_element(x.size());
  gather(problem, y, {by_element.data(), static_cast<std::size_t>(x.size())});
  EXPECT_LE((by_matrix - by_element).norm(), 1e-14 * by_matrix.norm());
}

// Bit by bit what Eigen adds up of all elements' entries in the order of the elements, in a body
// some of whose nodes are held along one axis, all or none.
TEST(Assembly, SumsElementsInTheirOrder) {
  Scene scene = test::held_board();
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(20, 10, 3)}, Axes{2}});
  scene.supports.push_back({Box{Vec3(30, -1, -1), Vec3(51, 10, 3)}, Axes{5}});
  const Problem problem(scene);
  const auto scale = random_scale(problem.mesh().tets.size());
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    ElementMatrix k = element_stiffness(problem, e);
    k *= scale[e];
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j < 12; ++j) {
        const Index row = problem.dof(problem.mesh().tets[e][i / 3], i % 3),
                    column = problem.dof(problem.mesh().tets[e][j / 3], j % 3);
        if (column != kNone && row >= column) entries.emplace_back(row, column, k(i, j));
      }
    }
  }
  for (Index d : problem.anchored_dofs()) entries.emplace_back(d, d, problem.anchor_stiffness());
  linear_algebra::SparseMatrix sum(problem.dof_count(), problem.dof_count());
  sum.setFromTriplets(entries.begin(), entries.end());
  const linear_algebra::SparseMatrix k = assemble_lower(problem, scale);
  ASSERT_EQ(k.nonZeros(), sum.nonZeros());
  EXPECT_TRUE(std::equal(k.outerIndexPtr(), k.outerIndexPtr() + k.cols() + 1, sum.outerIndexPtr()));
  EXPECT_TRUE(std::equal(k.innerIndexPtr(), k.innerIndexPtr() + k.nonZeros(), sum.innerIndexPtr()));
  EXPECT_TRUE(std::equal(k.valuePtr(), k.valuePtr() + k.nonZeros(), sum.valuePtr()));
}

TEST(Assembly, RigidModesOfTheWholeBodyGiveNoForce) {
  const Problem problem(test::held_board());
  const std::size_t n = problem.mesh().nodes.size();
  std::vector<double> u(3 * n), y(3 * n);
  const auto force_of = [&](const std::function<Vec3(const Vec3&)>& field) {
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 v = field(problem.mesh().nodes[i]);
      for (int axis = 0; axis < 3; ++axis) u[3 * i + axis] = v[axis];
    }
    apply_stiffness(problem, {}, u, y);
    double worst = 0;
    for (double f : y) worst = std::max(worst, std::abs(f));
    return worst;
  };
  const double stretch = force_of([](const Vec3& x) { return Vec3(x.x(), 0, 0); });
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(force_of([&](const Vec3&) { return Vec3::Unit(axis); }), 0.0);
    EXPECT_LE(force_of([&](const Vec3& x) { return Vec3::Unit(axis).cross(x); }), 1e-14 * stretch);
  }
}

TEST(Assembly, EventFactorIsTheDestroyedStiffness) {
  const Problem problem(test::held_board());
  const std::vector<Index> elements = {3, 700, 1953, 701};
  std::vector<double> scale(problem.mesh().tets.size(), 1.0);
  for (Index e : elements) scale[e] = problem.scene().fracture.alpha;
  const Eigen::MatrixXd removed = Eigen::MatrixXd(assemble_lower(problem, {})) -
                                  Eigen::MatrixXd(assemble_lower(problem, scale));
  const EventFactor event = event_factor(problem, elements);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(removed.rows(), removed.cols());
  expected(event.dofs, event.dofs) = event.w * event.w.transpose();
  expected.triangularView<Eigen::StrictlyUpper>().setZero();
  EXPECT_LE((removed - expected).norm(), 1e-12 * removed.norm());
}

TEST(Factor, InverseTimesMatrixIsTheIdentity) {
  const Problem problem(test::held_board());
  const linear_algebra::SparseMatrix k = assemble_lower(problem, {});
  const linear_algebra::Factor factor(k);
  const Eigen::MatrixXd x = factor.inverse();
  EXPECT_EQ((x - x.transpose()).cwiseAbs().maxCoeff(), 0.0);
  const Eigen::VectorXd b = random_vector(problem.dof_count());
  const Eigen::VectorXd u = x * b, direct = factor.solve(b);
  EXPECT_LE((u - direct).norm(), 1e-9 * direct.norm());
  const Eigen::VectorXd back = k.selfadjointView<Eigen::Lower>() * u;
  EXPECT_LE((back - b).norm(), 1e-8 * b.norm());  // cond K 6.6e7 times rounding
  const std::vector<Index> some = {0, 17, 1800};
  EXPECT_LE((factor.inverse_columns(some) - x(Eigen::all, some)).norm(), 1e-9 * x.norm());
}

TEST(Factor, IndefiniteMatrixIsATypedError) {
  linear_algebra::SparseMatrix k(2, 2);
  k.insert(0, 0) = 1;
  k.insert(1, 1) = -1;
  EXPECT_THROW(linear_algebra::Factor{k}, NumericalError);
}

}  // namespace
}  // namespace sunder::fem
