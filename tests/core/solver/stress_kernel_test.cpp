// SPDX-License-Identifier: Apache-2.0
// The vectorised stress against the plain one, bit by bit, for any number of threads and for
// elements that do not fill the last vector.
#include "solver/stress_kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "body/assembly.hpp"
#include "body/element.hpp"
#include "body/pools.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"
#include "support/accuracy.hpp"
#include "support/table1_board.hpp"

namespace sunder::solver {
namespace {

struct Field {
  Field() : problem(std::make_shared<Problem>(test::pulled_board())) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> any(-1, 1);
    for (std::size_t i = 0; i < problem->dofs().size(); ++i) u.push_back(5 + any(generator));
    for (Index e = 3; e < problem->tet_count(); e += 17) destroyed.push_back(e);
    live.assign(problem->mesh().tets.size(), 1);
    for (Index e : destroyed) live[e] = 0;
  }
  [[nodiscard]] Voigt plain(Index e) const {
    const Voigt s = fem::stress(problem->shape(e), problem->small_strain(e),
                                fem::corner_displacement(problem->mesh(), e, u));
    return (live[e] ? 1.0 : problem->scene().fracture.alpha) * s;
  }

  std::shared_ptr<const Problem> problem;
  std::vector<double> u;
  std::vector<Index> destroyed;
  std::vector<std::uint8_t> live;
};

TEST(StressKernel, EqualsThePlainStressBitByBitForAnyNumberOfThreads) {
  const Field field;
  for (int threads : {1, 2, 4, 7}) {
    StressKernel kernel(field.problem, {}, threads);
    kernel.destroy(field.destroyed);
    std::vector<Voigt> stress(field.live.size());
    const double largest = kernel.run(field.u, stress);
    double expected = 0;
    for (Index e = 0; e < field.problem->tet_count(); ++e) {
      ASSERT_EQ(stress[e], field.plain(e)) << "element " << e << ", " << threads << " threads";
      if (field.live[e]) expected = std::max(expected, test::tensor_norm(field.plain(e)));
    }
    EXPECT_NEAR(largest, expected, 4e-16 * expected) << threads << " threads";
  }
}

TEST(StressKernel, PooledVolumeHasThePressureOfItsPatchForAnyNumberOfThreads) {
  Scene scene = test::pulled_board();
  scene.materials["upper"].volume = MaterialVolume::pooled;  // the lower half is by element
  test::set_poisson(scene, 0.499);
  Field field;
  field.problem = std::make_shared<Problem>(std::move(scene));
  std::vector<double> scale(field.live.size(), 1.0);
  for (Index e : field.destroyed) scale[static_cast<std::size_t>(e)] = 1e-6;
  const fem::StressField right(*field.problem, scale, field.u);
  std::vector<Voigt> first;
  for (int threads : {1, 2, 4, 7}) {
    StressKernel kernel(field.problem, {}, threads);
    kernel.keep_forces();
    kernel.destroy(field.destroyed);
    std::vector<Voigt> stress(field.live.size());
    const double largest = kernel.run(field.u, stress);
    for (Index e = 0; e < field.problem->tet_count(); ++e) {
      const auto at = static_cast<std::size_t>(e);
      ASSERT_LE((stress[at] - scale[at] * right.of(e)).norm(), 1e-12 * largest) << e;
    }
    if (first.empty()) first = stress;
    EXPECT_EQ(stress, first) << threads << " threads";
    std::vector<double> forces(field.u.size()), expected(field.u.size());
    kernel.nodal_forces(forces);
    fem::apply_stiffness(*field.problem, scale, field.u, expected);
    double most = 0, off = 0;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      most = std::max(most, std::abs(expected[i]));
      off = std::max(off, std::abs(forces[i] - expected[i]));
    }
    EXPECT_LE(off, 1e-13 * most);
  }
}

class WorstRatios : public ::testing::TestWithParam<FractureModel> {};

TEST_P(WorstRatios, AreThoseThatALoopFinds) {
  Scene scene = test::pulled_board();
  scene.fracture.model = GetParam();
  Field field;
  field.problem = std::make_shared<Problem>(std::move(scene));
  const YieldMeasure measure = strength_measure(field.problem->scene().fracture);
  StressKernel kernel(field.problem, {}, 2);
  kernel.keep_bounds();
  kernel.destroy(field.destroyed);
  std::vector<Voigt> stress(field.live.size());
  std::vector<std::uint8_t> excluded(stress.size(), 0);
  for (int round = 0; round < 40; ++round) {
    kernel.run(field.u, stress);
    StressSummary expected;
    for (Index e = 0; e < field.problem->tet_count(); ++e) {
      if (!field.live[e] || !field.problem->breakable(e)) continue;
      const double ratio = yield_measure(stress[e], measure) / field.problem->yield(e);
      if (ratio >= 1) ++expected.over;
      if (ratio > expected.any.ratio) expected.any = {e, ratio};
      if (!excluded[e] && ratio > expected.candidate.ratio) expected.candidate = {e, ratio};
    }
    const StressSummary found = kernel.summarize(excluded, stress);
    EXPECT_EQ(found.over, expected.over);
    EXPECT_EQ(found.any.element, expected.any.element);
    EXPECT_EQ(found.any.ratio, expected.any.ratio);
    ASSERT_EQ(found.candidate.element, expected.candidate.element);
    EXPECT_EQ(found.candidate.ratio, expected.candidate.ratio);
    excluded[found.candidate.element] = 1;
  }
}

INSTANTIATE_TEST_SUITE_P(StressKernel, WorstRatios,
                         ::testing::Values(FractureModel::a, FractureModel::p));

TEST(StressKernel, CountsWhatIsOverYieldWhereSomeElementIsJustThere) {
  for (YieldMeasure measure :
       {YieldMeasure::max_shear, YieldMeasure::tresca, YieldMeasure::principal}) {
    Scene scene = test::pulled_board();
    scene.fracture.yield_measure = measure;
    Field field;
    field.problem = std::make_shared<Problem>(std::move(scene));
    StressKernel kernel(field.problem, {}, 1);
    kernel.keep_bounds();
    std::vector<Voigt> stress(field.live.size());
    kernel.run(field.u, stress);
    const auto ratio = [&](Index e) {
      return yield_measure(stress[e], measure) / field.problem->yield(e);
    };
    for (Index at = 0; at < field.problem->tet_count(); at += 97) {
      if (!field.problem->breakable(at) || !(ratio(at) > 0)) continue;  // compression
      for (double& d : field.u) d /= ratio(at);
      kernel.run(field.u, stress);
      Index over = 0;
      for (Index e = 0; e < field.problem->tet_count(); ++e) {
        over += field.problem->breakable(e) && ratio(e) >= 1;
      }
      EXPECT_NEAR(ratio(at), 1, 1e-9);
      EXPECT_EQ(kernel.summarize({}, stress).over, over) << "element " << at;
    }
  }
}

TEST(StressKernel, SumsUpTheForcesOfTheStressTheSameForAnyNumberOfThreads) {
  const Field field;
  std::vector<double> scale;
  for (std::uint8_t live : field.live) {
    scale.push_back(live ? 1.0 : field.problem->scene().fracture.alpha);
  }
  std::vector<double> expected(field.u.size()), first;
  fem::apply_stiffness(*field.problem, scale, field.u, expected);
  double largest = 0;
  for (double f : expected) largest = std::max(largest, std::abs(f));
  for (int threads : {1, 2, 4, 7}) {
    StressKernel kernel(field.problem, {}, threads);
    kernel.keep_forces();
    kernel.destroy(field.destroyed);
    kernel.run(field.u, {});
    const double norm = kernel.largest(std::vector<double>(field.u.size(), 0.0));
    EXPECT_EQ(norm, 0);
    std::vector<double> forces(field.u.size());
    kernel.nodal_forces(forces);
    for (std::size_t i = 0; i < forces.size(); ++i) {
      ASSERT_NEAR(forces[i], expected[i], 1e-13 * largest) << "dof " << i;
    }
    if (first.empty()) first = forces;
    EXPECT_EQ(forces, first) << threads << " threads";
  }
}

TEST(StressKernel, SaysWhenALiveElementIsNotFinite) {
  Field field;
  const Index e = field.problem->tet_count() - 1;
  StressKernel kernel(field.problem, {}, 1);
  field.u[3 * static_cast<std::size_t>(field.problem->mesh().tets[e][2])] = std::nan("");
  EXPECT_TRUE(std::isnan(kernel.run(field.u, {})));
}

TEST(StressKernel, TakesSomeElementsOnly) {
  const Field field;
  const std::vector<Index> some{1, 5, 6, 700, 701, 702, 703, 704, 1500};
  StressKernel kernel(field.problem, some, 1);
  std::vector<Voigt> stress(some.size());
  kernel.run(field.u, stress);
  EXPECT_EQ(kernel.size(), some.size());
  EXPECT_EQ(kernel.place(0), kNone);
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(kernel.place(some[i]), static_cast<Index>(i));
    const Index e = some[i];
    EXPECT_EQ(stress[i], fem::stress(field.problem->shape(e), field.problem->small_strain(e),
                                     fem::corner_displacement(field.problem->mesh(), e, field.u)));
  }
}

}  // namespace
}  // namespace sunder::solver
