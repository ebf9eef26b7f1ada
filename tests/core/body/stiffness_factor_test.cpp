// SPDX-License-Identifier: Apache-2.0
#include "body/stiffness_factor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "body/analysis.hpp"
#include "body/assembly.hpp"
#include "sunder/error.hpp"
#include "support/structured_board.hpp"

namespace sunder::fem {
namespace {

using linear_algebra::Factor;
using linear_algebra::SparseMatrix;
using linear_algebra::Stopped;

Problem board(const test::BoardShape& shape, Axes held = {7}) {
  Scene scene;
  scene.mesh = test::structured_board(shape);
  scene.materials = {{"board", {5, 0.4, 2.0}}};
  scene.supports.push_back({Box{Vec3(-1, -0.01, -1), Vec3(100, 0.01, 100)}, held});
  scene.supports.push_back({Box{Vec3(-1, -0.01, -1), Vec3(0.01, 100, 100)}, Axes{5}});
  return Problem(std::move(scene));
}

/// Entries of L that an event reads which touches one unknown, in the middle of all unknowns'.
std::size_t middle_path(const Factor& factor, Index unknowns) {
  std::vector<std::size_t> entries;
  for (Index d = 0; d < unknowns; d += 29) {
    const Index dofs[] = {d};
    entries.push_back(factor.path_entries(dofs));
  }
  std::sort(entries.begin(), entries.end());
  return entries[entries.size() / 2];
}

TEST(NestedDissection, OrdersEveryUnknownOnce) {
  for (const test::BoardShape& shape :
       {test::BoardShape{1, 1, 1, 1, 1, 1}, test::BoardShape{11, 7, 1, 50, 50, 2.5},
        test::BoardShape{5, 6, 7, 50, 50, 50}, test::BoardShape{1, 300, 1, 1, 50, 1}}) {
    for (Axes held : {Axes{7}, Axes{2}}) {  // nodes with three unknowns or none; with some
      const Problem problem = board(shape, held);
      std::vector<Index> place = elimination_order(problem);
      std::sort(place.begin(), place.end());
      std::vector<Index> all(static_cast<std::size_t>(problem.dof_count()));
      std::iota(all.begin(), all.end(), 0);
      EXPECT_EQ(place, all) << shape.nx << " x " << shape.ny << " x " << shape.nz << " cells";
    }
  }
}

// A plane through the nodes has a layer as thick as a patch beside it: 2.2 to 3.9 times the
// entries.
TEST(CellDissection, OrdersPooledBodiesWithFewMoreEntries) {
  for (const test::BoardShape& shape :
       {test::BoardShape{1, 1, 1, 1, 1, 1}, test::BoardShape{18, 18, 1, 50, 50, 2.5},
        test::BoardShape{8, 8, 8, 50, 50, 50}}) {
    std::size_t entries[2];
    for (bool pooled : {false, true}) {
      Scene scene = board(shape, Axes{2}).scene();
      if (pooled) scene.materials["board"].volume = MaterialVolume::pooled;
      const Problem problem(std::move(scene));
      std::vector<Index> place = elimination_order(problem);
      std::sort(place.begin(), place.end());
      std::vector<Index> all(static_cast<std::size_t>(problem.dof_count()));
      std::iota(all.begin(), all.end(), 0);
      EXPECT_EQ(place, all);
      entries[pooled] = analyse(problem)->entries();
    }
    EXPECT_LT(static_cast<double>(entries[1]), 2 * static_cast<double>(entries[0]));
  }
}

TEST(NestedDissection, OrdersANeedle) {
  Problem one = [] {  // a needle: the separators across it are tiny
    Scene scene;
    scene.mesh = test::structured_board({40, 2, 2, 1e-3, 1e-3, 1});
    scene.materials = {{"board", {5, 0.4, 2.0}}};
    scene.supports.push_back({Box{Vec3(-1, -1, -0.01), Vec3(1, 1, 0.01)}, Axes{7}});
    return Problem(std::move(scene));
  }();
  std::vector<Index> place = elimination_order(one);
  std::sort(place.begin(), place.end());
  EXPECT_EQ(std::unique(place.begin(), place.end()), place.end());
  EXPECT_EQ(static_cast<Index>(place.size()), one.dof_count());
}

TEST(NestedDissection, ShortensTheElimination) {
  const Problem thin = board({71, 71, 1, 50, 50, 2.5}), block = board({16, 16, 16, 50, 50, 50});
  const Factor thin_degree(assemble_lower(thin, {})), thin_cut = factor_stiffness(thin);
  EXPECT_LT(thin_cut.entries(), 1.1 * static_cast<double>(thin_degree.entries()));
  EXPECT_LT(middle_path(thin_cut, thin.dof_count()),
            0.85 * static_cast<double>(middle_path(thin_degree, thin.dof_count())));
  const Factor block_degree(assemble_lower(block, {})), block_cut = factor_stiffness(block);
  EXPECT_LT(block_cut.entries(), 0.9 * static_cast<double>(block_degree.entries()));
}

TEST(NestedDissection, FactorHasTheSameBitsForAnyNumberOfThreads) {
  // Large panels, which threads share, and many subtrees, which they take one by one.
  for (const test::BoardShape& size :
       {test::BoardShape{16, 16, 16, 50, 50, 50}, {40, 40, 1, 50, 50, 2.5}}) {
    const Problem problem = board(size);
    const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(problem.dof_count(), -1, 2);
    const Factor one = factor_stiffness(problem, {}, {.threads = 1});
    ASSERT_GT(one.entries(), 1'000'000u);  // enough for more threads than one
    const Eigen::VectorXd u = one.solve(f);
    for (int threads : {2, 3, 7}) {
      EXPECT_EQ(factor_stiffness(problem, {}, {.threads = threads}).solve(f), u)
          << threads << " threads";
    }
    const SparseMatrix lower = assemble_lower(problem, {});
    const Eigen::VectorXd product = lower.selfadjointView<Eigen::Lower>() * u;
    EXPECT_LE((product - f).norm(), 1e-9 * f.norm());
  }
}

TEST(NestedDissection, ThreadsFindWhatIsNotPositiveDefinite) {
  const Problem problem = board({40, 40, 1, 50, 50, 2.5});
  SparseMatrix lower = assemble_lower(problem, {});
  const std::vector<Index> place = elimination_order(problem);
  // In a subtree, and in the last panel.
  for (const Index row : {0, problem.dof_count() / 3, problem.dof_count() - 1}) {
    const auto d = static_cast<Index>(std::ranges::find(place, row) - place.begin());
    const double was = lower.coeff(d, d);
    lower.coeffRef(d, d) = -was;
    for (int threads : {1, 2, 5}) {
      const linear_algebra::FactorWork work{.threads = threads};
      EXPECT_THROW(static_cast<void>(Factor(lower, place, work)), NumericalError) << row;
    }
    lower.coeffRef(d, d) = was;
  }
}

TEST(NestedDissection, FactorStopsWhenAsked) {
  const Problem problem = board({11, 7, 1, 50, 50, 2.5});
  const std::atomic<bool> stop{true};
  EXPECT_THROW(static_cast<void>(factor_stiffness(problem, {}, {.stop = &stop})), Stopped);
}

}  // namespace
}  // namespace sunder::fem
