// SPDX-License-Identifier: Apache-2.0
// What a body's factor takes is known before it is computed: where it does not fit the memory,
// conjugate gradients do without, within the same accuracy.
#include <gtest/gtest.h>

#include "body/stiffness_factor.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "solver/plan.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/structured_board.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

/// A block of 13,182 elements, pulled at an edge; its factor is far larger than its stiffness.
Scene block(Route route, bool gripped = false, Index cells = 13) {
  Scene scene;
  scene.mesh = structured_board({cells, cells, cells, 10, 10, 10});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.99, -1), Vec3(11, 11, 11)}, Axes{7}});
  scene.solver.backend = "cpu";
  scene.solver.route = route;
  if (gripped) {
    Instrument grip;
    grip.name = "grip";
    grip.action = Grip{Box{Vec3(9.9, -0.1, -1), Vec3(11, 0.1, 11)}, Vec3(0.1, -0.25, 0), Axes{3}};
    scene.instruments.push_back(grip);
  }
  return scene;
}

constexpr std::size_t kBetween = 50'000'000;  // less than the factor, more than without it

std::unique_ptr<Backend> in_memory(const std::shared_ptr<const Problem>& problem,
                                   std::size_t bytes) {
  return cpu_reference::create(problem, all_needs(), {.memory = bytes});
}

std::shared_ptr<const Problem> problem_of(Scene scene) {
  return std::make_shared<const Problem>(std::move(scene));
}

bool holds(const Backend& backend, const std::string& name) {
  return std::ranges::any_of(backend.buffers(),
                             [&](const BufferPlan& b) { return b.name == name; });
}

/// The number before " bytes" in a sentence.
std::size_t bytes_in(const std::string& text) {
  const std::size_t end = text.find(" bytes");
  if (end == std::string::npos) return 0;
  return std::stoul(text.substr(text.rfind(' ', end - 1) + 1));
}

std::string refusal(const std::shared_ptr<const Problem>& problem, std::size_t bytes) {
  try {
    static_cast<void>(in_memory(problem, bytes));
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), InputFault::too_large);
    return error.what();
  }
  return {};
}

TEST(Memory, AutoTakesConjugateGradientsWhereTheFactorDoesNotFit) {
  const auto problem = problem_of(block(Route::automatic));
  const auto little = in_memory(problem, kBetween);
  const BackendInfo info = little->info();
  EXPECT_EQ(info.route, "cg");
  EXPECT_TRUE(mentions(info.why, "7644 unknowns: their factor needs")) << info.why;
  EXPECT_TRUE(mentions(info.why, "but 50000000 are free")) << info.why;
  EXPECT_TRUE(holds(*little, "incomplete factor of the intact body"));
  EXPECT_FALSE(holds(*little, "intact factor (sparse Cholesky)"));
  EXPECT_LT(info.memory_bytes, kBetween);
  EXPECT_GT(info.quiet_ms, 0);

  // Three factors: the intact body's, that of a torn one, and the next.
  const std::size_t needed = bytes_in(info.why);
  const linear_algebra::Factor factor = fem::factor_stiffness(*problem);
  EXPECT_GE(needed, 3 * 8 * factor.entries());
  EXPECT_LE(needed, 4 * 8 * factor.entries());
  EXPECT_EQ(in_memory(problem, needed - 1)->info().route, "cg");
  EXPECT_EQ(in_memory(problem, needed)->info().route, "factor");
}

TEST(Memory, AutoTakesTheFactorWhereAnInverseDoesNotFit) {
  const auto problem = problem_of(block(Route::automatic, false, 9));  // 2,700 unknowns
  EXPECT_EQ(in_memory(problem, 2 * 2700 * 2700 * 8)->info().route, "factor") << "with the factor";
  EXPECT_EQ(in_memory(problem, std::size_t{1} << 30)->info().route, "inverse");
}

TEST(Memory, WhatIsAskedForIsRefusedWithBytes) {
  for (Route route : {Route::factor, Route::inverse, Route::condensed}) {
    const std::string message = refusal(problem_of(block(route)), kBetween);
    EXPECT_TRUE(mentions(message, "route " + solver::name_of(route))) << message;
    EXPECT_GT(bytes_in(message), kBetween) << message;
    EXPECT_TRUE(mentions(message, "50000000 are free")) << message;
    EXPECT_TRUE(mentions(message, "use route")) << message;
  }
  EXPECT_EQ(refusal(problem_of(block(Route::cg)), kBetween), "");
}

TEST(Memory, NothingFitsIsAnErrorWithBytes) {
  for (Route route : {Route::automatic, Route::cg, Route::factor}) {
    const std::string message = refusal(problem_of(block(route)), 1'000'000);
    EXPECT_TRUE(mentions(message, "even route cg needs")) << message;
    EXPECT_GT(bytes_in(message), 13182u * 1000) << message;
    EXPECT_TRUE(mentions(message, "1000000 are free")) << message;
  }
}

class WithoutFactor : public ::testing::TestWithParam<bool> {};

TEST_P(WithoutFactor, TearsWithinTheTable) {
  const auto problem = problem_of(block(Route::automatic, GetParam()));
  const auto little = in_memory(problem, kBetween);
  ASSERT_EQ(little->info().route, "cg");
  const auto reference =
      cpu_reference::create(problem_of(block(Route::factor, GetParam())), all_needs(), {});
  const auto& mesh = problem->mesh();
  const auto edge = nodes_in(mesh, {Vec3(-0.1, -0.1, -1), Vec3(0.1, 0.1, 11)});
  std::vector<double> moved;
  for (std::size_t g = 0; g < problem->gripped_dofs().size(); ++g) moved.push_back(0.01 * (g % 5));
  const auto crack = elements_across(mesh, 5.2);
  const auto displacement = [&](const Backend& backend) {
    std::vector<double> u(3 * mesh.nodes.size());
    backend.read_displacement(u);
    return u;
  };
  const auto stress = [&](const Backend& backend) {
    std::vector<Voigt> s(mesh.tets.size());
    backend.read_stress(s);
    return s;
  };
  std::size_t done = 0;
  for (std::size_t k : {0U, 1U, 40U}) {
    for (Backend* b : {little.get(), reference.get()}) {
      if (k > done) b->destroy(std::span(crack).subspan(done, k - done));
      b->set_load(load_of(*problem, shared_force(mesh, edge, Vec3(0.5, -2, 1)), moved));
      const SolveReport report = b->solve();
      EXPECT_LE(report.error, kCrackTolerance);
      EXPECT_EQ(report.iterations > 0, b == little.get());
      b->stress();
    }
    done = k;
    const double tolerance = k == 0 ? kIntactTolerance : kCrackTolerance;
    const auto dead = little->destroyed();
    EXPECT_LE(displacement_error(mesh, dead, displacement(*little), displacement(*reference)),
              tolerance);
    EXPECT_LE(stress_error(dead, stress(*little), stress(*reference)), tolerance);
    std::vector<double> a(problem->gripped_dofs().size()), b(a.size());
    little->read_reactions(a);
    reference->read_reactions(b);
    double largest = 0;
    for (double force : b) largest = std::max(largest, std::abs(force));
    for (std::size_t g = 0; g < a.size(); ++g) EXPECT_NEAR(a[g], b[g], 1e-7 * largest);
  }
  // The intact body's field, after damage.
  const Load load = load_of(*problem, shared_force(mesh, edge, Vec3(0, -1, 0)), moved);
  std::vector<double> u(3 * mesh.nodes.size()), expected(u.size());
  little->solve_pristine(load, u);
  reference->solve_pristine(load, expected);
  EXPECT_LE(displacement_error(mesh, std::vector<std::uint8_t>(mesh.tets.size(), 0), u, expected),
            kIntactTolerance);
}

INSTANTIATE_TEST_SUITE_P(Grips, WithoutFactor, ::testing::Bool(),
                         [](const auto& p) { return p.param ? "Gripped" : "Free"; });

}  // namespace
}  // namespace sunder::test
