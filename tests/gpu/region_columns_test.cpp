// SPDX-License-Identifier: Apache-2.0
// Columns of a condensed region on the device, against the host's product with them.
#include "gpu/passes/region_columns.hpp"

#include <numeric>
#include <random>

#include "body/assembly.hpp"
#include "body/stiffness_factor.hpp"
#include "kernels_fixture.hpp"
#include "solver/condensed_base.hpp"
#include "solver/condensed_route.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

class RegionColumnsKernels : public Kernels {};

INSTANTIATE_TEST_SUITE_P(All, RegionColumnsKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::gpu, false},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& info) { return name_of(info.param); });

/// Two bases of one region, of which a product takes what it can of the second.
struct Bases {
  Bases() {
    const Problem problem(held_board());
    factor = std::make_shared<const linear_algebra::Factor>(fem::factor_stiffness(problem));
    for (Index d = 1; d < problem.dof_count(); d += 3) dofs.push_back(d);
    begin();
  }
  void begin() {
    by_host = std::make_unique<solver::CondensedBase>(factor, dofs);
    by_device = std::make_unique<solver::CondensedBase>(factor, dofs);
    by_device->multiply_by(product);
  }
  void multiply_by(solver::RegionProduct& of) {
    product = &of;
    begin();
  }
  void push(Index vectors) {
    std::vector<solver::Difference> added;
    for (Index i = 0; i < vectors; ++i) {
      const auto at = [&] { return dofs[random() % dofs.size()]; };
      added.push_back({at(), i % 3 == 0 ? kNone : at()});
      if (added.back().other == added.back().dof) added.back().other = kNone;
    }
    linear_algebra::RowMajor gram(by_host->count() + vectors, vectors + 8);
    by_host->push(added, gram);
    by_device->push(added, gram);
  }
  void pop() {
    by_host->pop();
    by_device->pop();
  }
  void expect_agreement() {
    const Index loaded = dofs[5];
    const double force = 3;
    static_cast<void>(by_host->load({{&loaded, 1}, {&force, 1}}));
    static_cast<void>(by_device->load({{&loaded, 1}, {&force, 1}}));
    const Eigen::VectorXd c = Eigen::VectorXd::Random(by_host->count() + 3);
    Eigen::VectorXd right, u;
    by_host->expand(c, right);
    by_device->expand(c, u);
    EXPECT_LE((u - right).norm(), 1e-13 * right.norm());
  }

  std::shared_ptr<const linear_algebra::Factor> factor;
  std::vector<Index> dofs;
  solver::RegionProduct* product = nullptr;
  std::unique_ptr<solver::CondensedBase> by_host, by_device;
  std::mt19937 random{7};
};

TEST_P(RegionColumnsKernels, FollowTheBase) {
  Bases bases;
  const auto unknowns = static_cast<Index>(bases.dofs.size());
  gpu::RegionColumns columns(*factory_, unknowns, static_cast<std::size_t>(10 * unknowns));
  bases.multiply_by(columns);
  bases.push(9);
  bases.expect_agreement();
  EXPECT_EQ(columns.follow(*bases.by_device), 0) << "too few columns to be worth it";
  bases.push(100);  // of which a frame takes 64
  bases.expect_agreement();
  EXPECT_EQ(columns.follow(*bases.by_device), 109);
  bases.expect_agreement();
  bases.push(20);
  bases.expect_agreement();
  bases.pop();
  bases.push(15);
  bases.expect_agreement();
  EXPECT_EQ(columns.follow(*bases.by_device), 124);
  bases.begin();
  bases.push(40);
  bases.expect_agreement();
  EXPECT_EQ(columns.follow(*bases.by_device), 40);
}

// What S has grown by since is added by the host, row by row.
TEST_P(RegionColumnsKernels, HaveTheRowsThatTheRegionBeganWith) {
  Bases bases;
  gpu::RegionColumns columns(*factory_, static_cast<Index>(bases.dofs.size()), 0);
  bases.multiply_by(columns);
  bases.push(20);
  EXPECT_EQ(columns.follow(*bases.by_device), 20);
  for (const Index beyond : {1, 4}) {
    bases.dofs.push_back(bases.dofs[5] + beyond);
    bases.push(400);
    bases.expect_agreement();
    EXPECT_EQ(columns.follow(*bases.by_device), beyond == 1 ? 148 : 340);
    bases.expect_agreement();
  }
  EXPECT_GT(bases.by_device->dofs().size(), static_cast<std::size_t>(columns.rows()));
}

TEST_P(RegionColumnsKernels, ColumnsBeyondTheRoomAreTheHosts) {
  Bases bases;
  gpu::RegionColumns columns(*factory_, static_cast<Index>(bases.dofs.size()), 0);
  bases.multiply_by(columns);
  for (int i = 0; i < 10; ++i) bases.push(64);
  for (int i = 0; i < 10; ++i) bases.expect_agreement();
  const Index there = columns.follow(*bases.by_device);
  EXPECT_EQ(there, std::min<Index>(640, solver::columns_of_a_base(bases.dofs.size())));
}

}  // namespace
}  // namespace sunder::test
