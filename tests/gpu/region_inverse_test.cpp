// SPDX-License-Identifier: Apache-2.0
// X_SS of a condensed region on the device, against the host's product with it.
#include "gpu/passes/region_inverse.hpp"

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

class RegionInverseKernels : public Kernels {};

INSTANTIATE_TEST_SUITE_P(All, RegionInverseKernels,
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

using Extent = gpu::RegionInverse::Extent;

// Where there is room for all of it, that is there from the start; a later base's comes with the
// products, columns that these need first.
TEST_P(RegionInverseKernels, FollowsTheBase) {
  Bases bases;
  const auto unknowns = static_cast<Index>(bases.dofs.size());
  for (const Extent extent : {Extent::whole, Extent::columns}) {
    SCOPED_TRACE(extent == Extent::whole ? "whole" : "columns");
    const bool whole = extent == Extent::whole;
    const std::size_t panel = 128 * 8 * static_cast<std::size_t>(unknowns + 512);
    gpu::RegionInverse inverse(*factory_, unknowns, panel, static_cast<std::size_t>(15 * unknowns),
                               extent);
    bases.multiply_by(inverse);
    EXPECT_EQ(inverse.count(), whole ? unknowns : 0);
    bases.push(5);
    bases.expect_agreement();
    EXPECT_EQ(inverse.count(), whole ? unknowns : 0) << "too few columns to be worth it";
    bases.push(100);  // of which a frame takes 64
    bases.expect_agreement();
    EXPECT_EQ(inverse.count(), whole ? unknowns : 64);
    for (int i = 0; i < 4; ++i) bases.expect_agreement();
    const Index of_damage = inverse.count();
    EXPECT_GT(of_damage, 100);
    bases.expect_agreement();
    EXPECT_EQ(inverse.count(), of_damage) << "brings what is there";
    bases.push(20);
    bases.expect_agreement();
    bases.pop();
    bases.push(15);
    bases.expect_agreement();
    bases.begin();
    EXPECT_EQ(inverse.count(), 0) << "another base";
    bases.push(40);
    bases.expect_agreement();
    EXPECT_GE(inverse.count(), 40);
    EXPECT_LE(inverse.count(), 64 + (whole ? 8 : 0));
    if (!whole) continue;
    for (Index left = unknowns; left > 0; left -= 8) bases.expect_agreement();
    EXPECT_EQ(inverse.count(), unknowns) << "the rest comes in time";
  }
}

// What S has grown by since is added by the host, row by row; its columns come as others do, and
// go with it.
TEST_P(RegionInverseKernels, HasTheRowsThatTheRegionBeganWith) {
  for (const Extent extent : {Extent::whole, Extent::columns}) {
    Bases bases;
    const auto unknowns = static_cast<Index>(bases.dofs.size());
    gpu::RegionInverse inverse(*factory_, unknowns, 0, 0, extent);
    bases.multiply_by(inverse);
    bases.push(20);
    bases.expect_agreement();
    for (const Index beyond : {1, 4}) {
      bases.dofs.push_back(bases.dofs[5] + beyond);
      bases.push(400);
      for (int i = 0; i < 9; ++i) bases.expect_agreement();
      EXPECT_TRUE(inverse.has(unknowns)) << beyond;
    }
    EXPECT_GT(bases.by_device->dofs().size(), static_cast<std::size_t>(inverse.rows()));
    bases.pop();
    bases.pop();
    EXPECT_FALSE(inverse.has(unknowns));
    bases.expect_agreement();
    if (extent == Extent::columns) continue;                          // others have the room
    std::swap(bases.dofs[bases.dofs.size() - 2], bases.dofs.back());  // others at these places
    bases.push(400);
    for (int i = 0; i < 9; ++i) bases.expect_agreement();
    EXPECT_TRUE(inverse.has(unknowns));
  }
}

TEST_P(RegionInverseKernels, WhatIsBeyondTheRoomIsTheHosts) {
  Bases bases;
  const auto unknowns = static_cast<Index>(bases.dofs.size());
  gpu::RegionInverse inverse(*factory_, unknowns, 0, 0, Extent::columns);
  bases.multiply_by(inverse);
  for (int i = 0; i < 10; ++i) bases.push(64);
  for (int i = 0; i < 12; ++i) bases.expect_agreement();
  EXPECT_EQ(static_cast<std::size_t>(inverse.count()), inverse.most());
  EXPECT_LT(inverse.most(), static_cast<std::size_t>(unknowns));
}

}  // namespace
}  // namespace sunder::test
