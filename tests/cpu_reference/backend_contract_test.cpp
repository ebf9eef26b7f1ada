// SPDX-License-Identifier: Apache-2.0
// Order of calls, arguments and needs: what is wrong is a UsageError, what was left out is not
// allocated.
#include <gtest/gtest.h>

#include <chrono>

#include "sunder/error.hpp"
#include "support/body.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

Scene small_board() {
  Scene scene;
  scene.mesh = structured_board({3, 3, 1, 3, 3, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 2.9, -1), Vec3(4, 4, 2)}, Axes{7}});
  return scene;
}

std::vector<double> zero(const Body& body) {
  return std::vector<double>(body.problem->dofs().size(), 0.0);
}

TEST(BackendContract, OrderOfCalls) {
  Body body(small_board());
  EXPECT_THROW(body.backend->solve(), UsageError);
  EXPECT_THROW(body.backend->stress(), UsageError);
  EXPECT_THROW((void)body.displacement(), UsageError);
  EXPECT_THROW((void)body.backend->read_stress(0), UsageError);
  body.load(zero(body));
  EXPECT_THROW(body.backend->stress(), UsageError) << "stress() of an unsolved load";
  body.backend->solve();
  EXPECT_THROW((void)body.backend->read_stress(0), UsageError);
  body.backend->stress();
  EXPECT_EQ(body.backend->read_stress(0), Voigt(Voigt::Zero()));
}

TEST(BackendContract, ArgumentsOfLoads) {
  const Body body(small_board());
  const auto refused = [&](const Load& load) {
    EXPECT_THROW(body.backend->set_load(load), UsageError);
  };
  refused({{0, 1}, {1.0}, {}});  // one force per dof
  refused({{-1}, {1.0}, {}});    // below the dofs
  refused({{body.problem->dof_count()}, {1.0}, {}});
  refused({{1, 0}, {1.0, 1.0}, {}});  // not ascending
  refused({{1, 1}, {1.0, 1.0}, {}});  // twice
  refused({{0}, {std::nan("")}, {}});
  refused({{0}, {HUGE_VAL}, {}});
  refused({{}, {}, {1.0}});  // no grips here
}

TEST(BackendContract, ArgumentsOfDestroy) {
  Body body(small_board());
  const auto refused = [&](const std::vector<Index>& elements) {
    EXPECT_THROW(body.backend->destroy(elements), UsageError);
  };
  refused({-1});
  refused({body.problem->tet_count()});
  refused({3, 4, 3});
  body.backend->destroy(std::vector<Index>{3});
  refused({3});
  EXPECT_EQ(body.backend->destroyed()[3], 1);
  EXPECT_EQ(body.backend->destroyed()[4], 0);
}

TEST(BackendContract, ArgumentsOfPrepare) {
  for (Route route : {Route::inverse, Route::condensed, Route::factor, Route::cg}) {
    Scene scene = small_board();
    scene.solver.route = route;
    Body body(std::move(scene));
    EXPECT_EQ(body.backend->prepares(), route == Route::factor);
    EXPECT_THROW(body.backend->prepare(std::vector<Index>{-1}), UsageError);
    EXPECT_THROW(body.backend->prepare(std::vector<Index>{body.problem->tet_count()}), UsageError);
    body.backend->destroy(std::vector<Index>{3});
    body.backend->prepare(
        std::vector<Index>{3, 4, 4});  // what is destroyed or named twice is no error
    body.backend->destroy(std::vector<Index>{4, 5});
    const PreparationReport report = body.backend->preparation();
    EXPECT_EQ(report.destroyed, route == Route::factor ? 2 : 0);
    EXPECT_EQ(report.predicted, route == Route::factor ? 1 : 0);
  }
}

std::size_t bytes_of(const Body& body, const std::string& name) {
  for (const BufferPlan& b : body.backend->buffers()) {
    if (b.name.find(name) != std::string::npos) return b.bytes;
  }
  return 0;
}

TEST(BackendContract, WhatIsLeftOutIsNeitherHeldNorOffered) {
  const Body full(small_board()), bare(small_board(), Needs{});
  EXPECT_EQ(bytes_of(bare, "stress"), 0u);
  EXPECT_EQ(bytes_of(full, "stress"), full.problem->mesh().tets.size() * sizeof(Voigt));
  EXPECT_EQ(bytes_of(bare, "inverse"), 0u) << "nothing is destroyed: no dense inverse";
  const auto n = static_cast<std::size_t>(full.problem->dof_count());
  EXPECT_EQ(bytes_of(full, "inverse"), n * n * sizeof(double));
  EXPECT_EQ(bytes_of(full, "grips"), 0u);
  bare.load(zero(bare));
  bare.backend->solve();
  EXPECT_THROW(bare.backend->stress(), UsageError);
  EXPECT_THROW(bare.backend->destroy(std::vector<Index>{0}), UsageError);
  EXPECT_THROW(bare.backend->prepare(std::vector<Index>{0}), UsageError);
  EXPECT_THROW(bare.backend->exclude_candidates(std::vector<Index>{0}), UsageError);
  auto u = zero(bare);
  EXPECT_THROW(bare.backend->solve_pristine({}, u), UsageError);
}

TEST(BackendContract, TellsOfASolutionsTimeWhatItsStressTook) {
  using Clock = std::chrono::steady_clock;
  const Body body(small_board());
  body.load(zero(body));
  for (int solve = 0; solve < 3; ++solve) {
    const auto start = Clock::now();
    const SolveReport report = body.backend->solve();
    const std::chrono::duration<double, std::milli> took = Clock::now() - start;
    EXPECT_GT(report.stress_ms, 0);
    EXPECT_LT(report.stress_ms, took.count()) << "of this solution alone";
  }
}

TEST(BackendContract, InfoAddsUpTheBuffers) {
  const Body body(small_board());
  std::size_t sum = 0;
  for (const BufferPlan& b : body.backend->buffers()) sum += b.bytes;
  EXPECT_EQ(body.backend->info().memory_bytes, sum);
  EXPECT_EQ(body.backend->info().route, "inverse");
  EXPECT_EQ(body.backend->info().precision, "fp64");
}

TEST(BackendContract, RoutesAndPrecisionsThatTheCpuLacksAreTypedErrors) {
  const auto refused = [](auto change) {
    Scene scene = small_board();
    change(scene.solver);
    EXPECT_THROW(Body{std::move(scene)}, DeviceError);
  };
  refused([](SolverOptions& s) { s.precision = Precision::fp32; });
  refused([](SolverOptions& s) { s.device = 1; });
}

TEST(BackendContract, SummarySkipsDestroyedAndExcluded) {
  Scene scene = small_board();
  Body body(std::move(scene));
  auto force = zero(body);
  force[1] = -1;
  body.load(force);
  body.backend->solve();
  const StressSummary first = body.backend->stress();
  ASSERT_NE(first.any.element, kNone);
  EXPECT_EQ(first.any.element, first.candidate.element);
  body.backend->exclude_candidates(std::vector<Index>{first.any.element});
  const StressSummary second = body.backend->stress();
  EXPECT_EQ(second.any.element, first.any.element);
  EXPECT_NE(second.candidate.element, first.any.element);
  EXPECT_LT(second.candidate.ratio, second.any.ratio);
  body.backend->destroy(std::vector<Index>{first.any.element});
  body.backend->solve();
  EXPECT_NE(body.backend->stress().any.element, first.any.element);
}

// The pristine field is the intact body's, whatever has been destroyed.
TEST(BackendContract, PristineFieldIsTheIntactBodys) {
  Body body(small_board());
  auto force = zero(body);
  force[1] = -1;
  body.load(force);
  body.backend->solve();
  const auto intact = body.displacement();
  Load load{{body.problem->dof(0, 1)}, {-1.0}, {}};
  body.backend->destroy(std::vector<Index>{5, 6, 7, 20});
  body.backend->solve();
  EXPECT_GT(std::abs(body.displacement()[1] - intact[1]), 1e-3 * std::abs(intact[1]));
  auto pristine = zero(body);
  body.backend->solve_pristine(load, pristine);
  for (std::size_t i = 0; i < intact.size(); ++i) {
    EXPECT_NEAR(pristine[i], intact[i], 1e-12 * std::abs(intact[1]));
  }
}

}  // namespace
}  // namespace sunder::test
