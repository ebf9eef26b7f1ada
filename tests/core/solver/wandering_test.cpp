// SPDX-License-Identifier: Apache-2.0
// A hand that wanders and cuts wide: what route condensed keeps stays bounded.
#include <gtest/gtest.h>

#include <algorithm>

#include "body/stiffness_factor.hpp"
#include "solver/condensed_base.hpp"
#include "solver/condensed_route.hpp"
#include "support/accuracy.hpp"
#include "support/structured_board.hpp"

namespace sunder::solver {
namespace {

/// 50 x 50 x 2.5 mm, 12,150 elements, held above; S: the unknowns of its lower right corner.
std::shared_ptr<const Problem> organ() {
  Scene scene;
  scene.mesh = test::structured_board({45, 45, 1, 50, 50, 2.5});
  scene.materials["board"] = {5, 0.4, {}};
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
  scene.live = true;
  return std::make_shared<const Problem>(std::move(scene));
}

class Wandering : public testing::Test {
 protected:
  Wandering() {
    for (Index n = 0; n < problem->node_count(); ++n) {
      const Vec3& x = problem->mesh().nodes[static_cast<std::size_t>(n)];
      if (x.x() < 44 || x.y() > 6) continue;
      for (int axis = 0; axis < 3; ++axis) inside.push_back(problem->dof(n, axis));
    }
    std::ranges::sort(inside);
    load.force_dofs = {inside[1]};
    load.forces = {-1};
  }
  [[nodiscard]] std::unique_ptr<InverseRoute> route(std::optional<std::size_t> most = {}) const {
    return condensed_route(body, intact, inside, true, {}, nullptr, nullptr, most);
  }
  static const CondensedBase& base_of(const InverseRoute& route) {
    return dynamic_cast<const CondensedBase&>(route.deferred()->base());
  }
  void destroy(InverseRoute& route, std::span<const Index> elements) {
    body.destroy(elements);
    route.follow({.leave = elements});
  }
  [[nodiscard]] Eigen::VectorXd solution(InverseRoute& route) const {
    Eigen::VectorXd u;
    static_cast<void>(route.solve(load, {}, u));
    return u(inside);
  }
  /// By a factor of the body as it is.
  [[nodiscard]] Eigen::VectorXd anew() const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(problem->dof_count());
    f[load.force_dofs[0]] = load.forces[0];
    const Eigen::VectorXd u = linear_algebra::Factor(fem::factor_stiffness(body)).solve(f);
    return u(inside);
  }
  /// Elements of one cell after the other, row by row: none of the lowest rows and the last ones.
  [[nodiscard]] static std::vector<Index> cells(int from, int count) {
    std::vector<Index> elements;
    for (int cell = from; cell < from + count; ++cell) {
      const int row = 12 + 3 * (cell / 36), column = 4 + cell % 36;
      for (int e = 0; e < 6; ++e) elements.push_back(6 * (45 * row + column) + e);
    }
    return elements;
  }

  std::shared_ptr<const Problem> problem = organ();
  fem::DamagedBody body{problem};
  std::shared_ptr<const linear_algebra::Factor> intact =
      std::make_shared<const linear_algebra::Factor>(fem::factor_stiffness(body));
  std::vector<Index> inside;
  Load load;
};

double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).norm() / b.norm();
}

// S begins anew with what it was at first, once it has grown large: a factor has the damage then.
TEST_F(Wandering, TheRegionIsSmallAgain) {
  const auto route = this->route(inside.size() + 500);
  const std::vector<Index> path = cells(0, 300);
  std::size_t most = 0, least = 0, gone = 0;
  const auto cut_on = [&] {
    destroy(*route, std::span(path).subspan(gone, 2));
    gone += 2;
    const std::size_t size = base_of(*route).dofs().size();
    if (size < most) least = size;
    most = std::max(most, size);
  };
  while (least == 0 && gone + 40 < path.size()) {
    cut_on();
    if (gone % 100 != 0) continue;
    EXPECT_LE(difference(solution(*route), anew()), test::kCrackTolerance);
  }
  EXPECT_GT(most, inside.size() + 500) << "it was large";
  EXPECT_GT(least, 0u);
  EXPECT_LT(least + 300, most) << "what had been cut when the base began is in its factor";
  EXPECT_LE(difference(solution(*route), anew()), test::kCrackTolerance);
  for (int i = 0; i < 20; ++i) cut_on();
  EXPECT_LE(difference(solution(*route), anew()), test::kCrackTolerance);
}

// One event of many elements is a new base at once, over what S was at first; there is a way back.
TEST_F(Wandering, AWideCutIsANewBase) {
  const auto route = this->route();
  destroy(*route, cells(200, 4));
  const Eigen::VectorXd before = solution(*route);
  const std::vector<Index> dofs(base_of(*route).dofs().begin(), base_of(*route).dofs().end());
  EXPECT_GT(dofs.size(), inside.size());
  const auto state = route->state();
  const auto wide = cells(0, 110);
  for (const bool again : {false, true}) {
    SCOPED_TRACE(again);
    EXPECT_EQ(route->bases(), 1);
    destroy(*route, wide);
    EXPECT_EQ(route->bases(), 2);
    EXPECT_EQ(route->new_bases().count, again ? 2 : 1);
    EXPECT_TRUE(std::ranges::equal(base_of(*route).dofs(), inside));
    EXPECT_LE(difference(solution(*route), anew()), test::kCrackTolerance);
    destroy(*route, cells(170, 1));
    EXPECT_LE(difference(solution(*route), anew()), test::kCrackTolerance);
    ASSERT_TRUE(route->go_back(*state, 1));
    body.take_back(1);
    EXPECT_TRUE(std::ranges::equal(base_of(*route).dofs(), dofs));
    EXPECT_EQ(solution(*route), before);
  }
  // Less than that is followed.
  destroy(*route, cells(0, 60));
  EXPECT_EQ(route->bases(), 1);
}

}  // namespace
}  // namespace sunder::solver
