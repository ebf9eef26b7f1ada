// SPDX-License-Identifier: Apache-2.0
// The tangent in the order of its factor against the one that is assembled as it is written down.
#include "body/tangent_pattern.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "material/corotated.hpp"
#include "material/neo_hookean.hpp"
#include "support/assembled_tangent.hpp"
#include "support/structured_board.hpp"

namespace sunder::fem {
namespace {

/// Held on one side, gripped on a corner, with a node that nothing reaches once elements are gone.
Scene scene() {
  Scene scene;
  scene.mesh = test::structured_board({5, 4, 2, 5, 4, 2});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 3.99, -1), Vec3(6, 5, 3)}, Axes{5}});
  Instrument grip;
  grip.action = Grip{Box{Vec3(-1, -1, -1), Vec3(0.01, 0.01, 3)}, Vec3(0, 0, 0), Axes{3}};
  scene.instruments.push_back(grip);
  return scene;
}

TEST(TangentPattern, IsTheAssembledTangentInItsOrder) {
  const Problem problem(scene());
  const TangentPattern pattern(problem);
  std::vector<double> u;
  for (std::size_t i = 0; i < problem.dofs().size(); ++i) {
    u.push_back(0.1 * std::sin(1.7 * static_cast<double>(i)));
  }
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    for (Index n : problem.mesh().tets[e]) destroyed[e] |= n == problem.node_count() / 2;
  }
  const auto gripped = problem.gripped_dofs();
  for (const double inertia : {0.0, 0.7}) {
    for (const Law* law : {&kCorotated, &kNeoHookean}) {
      for (const Tangent kind : {Tangent::exact, Tangent::projected}) {
        const auto laws = one_law(problem, *law);
        const HyperelasticBody body{problem, laws, destroyed};
        Eigen::MatrixXd expected(test::assemble_tangent(body, u, kind));
        expected.diagonal().array() += inertia;
        for (Index d : gripped) {
          expected.row(d).setZero();
          expected.col(d).setZero();
          expected(d, d) = 1;
        }
        const linear_algebra::SparseMatrix ordered = pattern.tangent(body, u, kind, {inertia});
        const Eigen::MatrixXd found = Eigen::MatrixXd(ordered).selfadjointView<Eigen::Lower>();
        const auto& place = pattern.supernodes()->place;
        double largest = 0;
        for (Index i = 0; i < expected.rows(); ++i) {
          for (Index j = 0; j <= i; ++j) {
            largest = std::max(largest, std::abs(found(place[i], place[j]) - expected(i, j)));
          }
        }
        EXPECT_LE(largest, 1e-14 * expected.cwiseAbs().maxCoeff()) << law->name << inertia;
        const Eigen::VectorXd diagonal = pattern.diagonal(ordered);
        for (Index d = 0; d < problem.dof_count(); ++d) {
          const bool held = std::ranges::binary_search(gripped, d);
          EXPECT_EQ(diagonal[d], held ? 0 : found(place[d], place[d]));
        }
      }
    }
  }
}

}  // namespace
}  // namespace sunder::fem
