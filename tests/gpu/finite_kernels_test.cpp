// SPDX-License-Identifier: Apache-2.0
// What a device answers of bodies at finite deformation against the host: states, iterations, sums,
// and what an event takes of it.
#include <numbers>
#include <random>

#include "gpu/finite_device.hpp"
#include "kernels_fixture.hpp"
#include "material/corotated.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "material/saint_venant_kirchhoff.hpp"
#include "solver/finite_minimiser.hpp"
#include "solver/finite_renewal.hpp"

namespace sunder::test {
namespace {

/// A board with a grip at its right end, some elements gone and a piece cut off.
struct Torn {
  explicit Torn(const Law& law)
      : problem(scene()),
        laws(fem::one_law(problem, law)),
        out(problem.mesh().tets.size(), 0),
        body{problem, laws, out} {
    for (Index e : {7, 8, 9, 40, 41, 77}) out[static_cast<std::size_t>(e)] = 1;
  }
  static Scene scene() {
    Scene of;
    of.mesh = structured_board({6, 4, 2, 6, 4, 2});
    of.materials["board"] = {5, 0.4, {}, MaterialLaw::corotated, 1e-9};
    of.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
    Instrument hand;
    hand.name = "hand";
    hand.action = Grip{Box{Vec3(6 - 1e-6, 1, -1), Vec3(9, 3, 9)}, Vec3(1, 1, 1), Axes{7}};
    of.instruments.push_back(hand);
    return of;
  }
  /// Turned by 80 deg about z and bent, with some noise.
  std::vector<double> displacement(double noise) const {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> of(-noise, noise);
    std::vector<double> u;
    for (const Vec3& x : problem.mesh().nodes) {
      const double turn = 80 * std::numbers::pi / 180 * x.x() / 6, radius = 6 + 2 - x.y();
      const Vec3 to(radius * std::sin(turn), 8 - radius * std::cos(turn), x.z() * 1.1);
      for (int axis = 0; axis < 3; ++axis) u.push_back(to[axis] - x[axis] + of(random));
    }
    for (std::size_t i = 0; i < u.size(); ++i) {
      if (problem.dofs()[i] == kNone) u[i] = 0;
    }
    return u;
  }
  solver::FiniteTarget target(const solver::FinitePotential& potential) const {
    Load load;
    load.displacements.assign(problem.gripped_dofs().size(), 0.5);
    solver::FiniteTarget of = potential.target(load);
    for (Index d = 0; d < of.force.size(); ++d) of.force[d] = 0.01 * std::sin(1.7 * d);
    return of;
  }

  Problem problem;
  std::vector<const Law*> laws;
  std::vector<std::uint8_t> out;
  fem::HyperelasticBody body;
};

const std::vector<const Law*>& all_laws() {
  static const std::vector<const Law*> list{&kLinear, &kCorotated, &kNeoHookean,
                                            &kSaintVenantKirchhoff};
  return list;
}

double apart(std::span<const double> a, std::span<const double> b) {
  double difference = 0, norm = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    norm += b[i] * b[i];
  }
  return norm > 0 ? std::sqrt(difference / norm) : std::sqrt(difference);
}

std::span<const double> span_of(const Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}
std::span<const double> span_of(const std::vector<Voigt>& s) {
  return {s.front().data(), 6 * s.size()};
}

using FiniteKernels = Kernels;

TEST_P(FiniteKernels, StatesAreTheHosts) {
  for (const Law* law : all_laws()) {
    for (const StressMeasure measure : {StressMeasure::cauchy, StressMeasure::biot}) {
      for (const bool moves : {false, true}) {
        const Torn torn(*law);
        const solver::RestingBody resting(torn.body, moves ? solver::RestingBody::Loose::moving
                                                           : solver::RestingBody::Loose::frozen);
        // The sums of an iteration by one workgroup, and by several.
        gpu::FiniteDevice device(
            *factory_, torn.body,
            {.stress = measure, .viscous = moves, .shares = law == &kNeoHookean ? 5u : 0u});
        const solver::FinitePotential host(resting, measure), there(resting, measure, &device);
        solver::FiniteTarget target = torn.target(host);
        std::vector<double> mass(static_cast<std::size_t>(torn.problem.dof_count()), 2e-9), ahead;
        fem::Viscosity viscosity(resting.body());
        ahead = torn.displacement(0);
        if (moves) {
          viscosity.start(torn.displacement(0.02), 1, ahead, 0);
          target.inertia = {4e4, mass};
          target.ahead = &ahead;
          target.viscosity = &viscosity;
          target.viscous = 0.3;
        }
        for (const double noise : {1e-3, 0.05}) {
          solver::FiniteState expected, found;
          expected.u = found.u = torn.displacement(noise);
          host.evaluate(target, true, expected);
          there.evaluate(target, true, found);
          EXPECT_NEAR(found.energy, expected.energy, 1e-12 * std::abs(expected.energy));
          EXPECT_NEAR(found.potential, expected.potential,
                      1e-12 * (std::abs(expected.energy) + std::abs(expected.potential)));
          EXPECT_NEAR(found.acting, expected.acting, 1e-11 * expected.acting);
          EXPECT_LE(apart(found.f, expected.f), 1e-12);
          EXPECT_LE(apart(found.viscous, expected.viscous), 1e-12);
          EXPECT_LE(apart(span_of(found.r), span_of(expected.r)), 1e-12);
          EXPECT_LE(apart(span_of(found.stress), span_of(expected.stress)), 1e-12);
        }
      }
    }
  }
}

// Corotated and Saint Venant-Kirchhoff know them; neo-Hookean's energy is infinite there.
TEST_P(FiniteKernels, TurnedInsideOutAndFlat) {
  for (const Law* law : all_laws()) {
    const Torn torn(*law);
    const solver::RestingBody resting(torn.body);
    gpu::FiniteDevice device(*factory_, torn.body, {.stress = StressMeasure::biot});
    const solver::FinitePotential host(resting, StressMeasure::biot),
        there(resting, StressMeasure::biot, &device);
    const solver::FiniteTarget target = torn.target(host);
    for (const double noise : {0.5, 1.5}) {
      solver::FiniteState expected, found;
      expected.u = found.u = torn.displacement(noise);
      host.evaluate(target, false, expected);
      there.evaluate(target, false, found);
      if (std::isinf(expected.potential)) {
        EXPECT_TRUE(std::isinf(found.potential));
        continue;
      }
      EXPECT_NEAR(found.energy, expected.energy, 1e-11 * expected.energy);
      EXPECT_LE(apart(found.f, expected.f), 1e-11);
    }
  }
}

// An inverse in fp32 costs iterations at most.
TEST_P(FiniteKernels, IterationsAreTheHostsInASubmitEach) {
  for (const Law* law : all_laws()) {
    Torn torn(*law);
    solver::RestingBody resting(torn.body);
    gpu::FiniteDevice device(*factory_, torn.body, {.shares = law == &kNeoHookean ? 5u : 0u});
    solver::FinitePotential host(resting, StressMeasure::cauchy),
        there(resting, StressMeasure::cauchy, &device);
    const fem::TangentPattern pattern(torn.problem);
    std::vector<double> u(torn.problem.dofs().size(), 0.0);
    int factors = 0;
    const auto base = solver::projected_base(torn.body, u, pattern, factors);
    ASSERT_TRUE(base);
    base->keep_inverse();
    for (Index e : {100, 101, 130}) torn.out[static_cast<std::size_t>(e)] = 1;
    resting.look();
    host.body_changed();
    there.body_changed();
    ASSERT_TRUE(base->follow(resting, 300));
    EXPECT_GT(base->rank(), 0);
    solver::FiniteTarget target = torn.target(host);
    target.grips.assign(target.grips.size(), 0.2);
    std::vector<double> turned = torn.displacement(0);
    for (double& x : turned) x *= 0.1;
    base->turn(resting, turned);
    EXPECT_EQ(base->turned().empty(), law == &kLinear);
    std::vector<solver::FiniteMinimiser::Result> results;
    std::vector<solver::FiniteState> states(2);
    for (const bool on_device : {false, true}) {
      const solver::FinitePotential& by = on_device ? there : host;
      solver::FiniteMinimiser minimiser(by, 5);
      minimiser.set_scale(solver::finite_scale(torn.problem));
      solver::FiniteState& state = states[on_device ? 1 : 0];
      state.u = u;
      by.put_grips(target, state.u);
      by.evaluate(target, false, state);
      const std::size_t before = device_->queue().submits();
      results.push_back(minimiser.minimise(target, base.get(), {1e-10, 1e-9}, 60, state));
      if (on_device) {
        const auto submits = static_cast<int>(device_->queue().submits() - before);
        // Shorter steps of the line search, and copies where memory is not mapped, add to them.
        EXPECT_GE(submits, results[1].back_solves);
        if (device_->physical().is_cpu() && std::getenv("SUNDER_VULKAN_PROBE") == nullptr) {
          EXPECT_LE(submits, results[1].back_solves + 6);
        }
      }
    }
    EXPECT_TRUE(results[0].at_rest);
    EXPECT_TRUE(results[1].at_rest);
    EXPECT_NEAR(results[1].back_solves, results[0].back_solves, GetParam().fp64 ? 1 : 6);
    EXPECT_LE(apart(states[1].u, states[0].u), kIntactTolerance);
    EXPECT_LE(apart(states[1].f, states[0].f), kIntactTolerance);
  }
}

// The exact tangent of every law, viscous stress and inertia included: Newton's steps converge as
// no wrong tangent lets them, to the host's rest.
TEST_P(FiniteKernels, NewtonByConjugateGradientsInASubmitEach) {
  for (const Law* law : all_laws()) {
    for (const bool moves : {false, true}) {
      const Torn torn(*law);
      const solver::RestingBody resting(torn.body, solver::RestingBody::Loose::moving);
      gpu::FiniteDevice device(*factory_, torn.body, {.route = Route::cg, .viscous = moves});
      const solver::FinitePotential host(resting, StressMeasure::cauchy),
          there(resting, StressMeasure::cauchy, &device);
      solver::FiniteTarget target = torn.target(host);
      target.grips.assign(target.grips.size(), 0.2);
      std::vector<double> u = torn.displacement(0.01);  // turned by some 8 deg
      for (double& x : u) x *= 0.1;
      std::vector<double> mass(static_cast<std::size_t>(torn.problem.dof_count()), 2e-4);
      fem::Viscosity viscosity(resting.body());
      viscosity.start(u, 1, u, 0);
      target.inertia = {1e4, mass};
      target.ahead = &u;
      if (moves) {
        target.viscosity = &viscosity;
        target.viscous = 0.3;
      }
      const fem::TangentPattern pattern(torn.problem);
      int factors = 0;
      const auto base = solver::projected_base(torn.body, u, pattern, factors, {}, target.inertia);
      ASSERT_TRUE(base);
      std::vector<solver::FiniteMinimiser::Result> results;
      std::vector<solver::FiniteState> states(2);
      for (const bool on_device : {false, true}) {
        const solver::FinitePotential& by = on_device ? there : host;
        solver::FiniteMinimiser minimiser(by, 5);
        minimiser.set_scale(solver::finite_scale(torn.problem));
        solver::FiniteState& state = states[on_device ? 1 : 0];
        state.u = u;
        by.put_grips(target, state.u);
        by.evaluate(target, false, state);
        const std::size_t before = device_->queue().submits();
        results.push_back(minimiser.minimise(target, on_device ? nullptr : base.get(),
                                             {1e-10, 1e-9}, on_device ? 20 : 200, state));
        if (on_device && device_->physical().is_cpu() &&
            std::getenv("SUNDER_VULKAN_PROBE") == nullptr) {
          const auto submits = static_cast<int>(device_->queue().submits() - before);
          EXPECT_LE(submits, results[1].back_solves + 6);
        }
      }
      EXPECT_TRUE(results[0].at_rest) << law->name;
      EXPECT_TRUE(results[1].at_rest) << law->name;
      EXPECT_LE(apart(states[1].u, states[0].u), kIntactTolerance) << law->name;
      EXPECT_LE(apart(states[1].f, states[0].f), kIntactTolerance) << law->name;
    }
  }
}

/// What an event and the rest after it take of a device.
struct Taken {
  std::size_t submits = 0, allocations = 0;
  solver::FiniteMinimiser::Result result;
  solver::FiniteState rest;
};

/// Some elements leave a body at rest, which finds another rest: by an inverse, or by conjugate
/// gradients, of which each iteration is a step of Newton.
Taken taken_by_an_event(const Numbers& numbers, bool unmapped, Route route, Index elements) {
  std::size_t allocations = 0;
  vulkan::InstanceOptions options;
  options.validation = validated();
  vulkan::DeviceProbe probe;
  probe.as_gpu = unmapped;
  probe.allocations = &allocations;
  const auto opened = watched_device(std::make_shared<vulkan::Instance>(options), probe);
  const gpu::KernelFactory factory(*opened, numbers.variant, numbers.fp64);
  Torn torn(kNeoHookean);
  const bool by_cg = route == Route::cg;
  solver::RestingBody resting(
      torn.body, by_cg ? solver::RestingBody::Loose::moving : solver::RestingBody::Loose::frozen);
  gpu::FiniteDevice device(factory, torn.body, {.route = route});
  solver::FinitePotential by(resting, StressMeasure::cauchy, &device);
  solver::FiniteState state;
  state.u.assign(torn.problem.dofs().size(), 0.0);
  std::unique_ptr<solver::FiniteBase> base;
  if (!by_cg) {
    const fem::TangentPattern pattern(torn.problem);
    int factors = 0;
    base = solver::projected_base(torn.body, state.u, pattern, factors);
    base->keep_inverse();
  }
  solver::FiniteTarget target = torn.target(by);
  target.grips.assign(target.grips.size(), 0.2);
  const std::vector<double> mass(static_cast<std::size_t>(torn.problem.dof_count()), 2e-4);
  const std::vector<double> ahead = state.u;
  if (by_cg) {
    target.inertia = {1e4, mass};
    target.ahead = &ahead;
  }
  solver::FiniteMinimiser minimiser(by, 5);
  minimiser.set_scale(solver::finite_scale(torn.problem));
  by.put_grips(target, state.u);
  by.evaluate(target, false, state);
  minimiser.minimise(target, base.get(), {1e-10, 1e-9}, 60, state);

  for (Index e = 0; e < elements; ++e) torn.out[static_cast<std::size_t>(100 + 3 * e)] = 1;
  const std::size_t submits = opened->queue().submits(), allocated = allocations;
  resting.look();
  by.body_changed();
  if (base) {
    EXPECT_TRUE(base->follow(resting, 300));
  }
  by.evaluate(target, false, state);
  Taken taken;
  taken.result = minimiser.minimise(target, base.get(), {1e-10, 1e-9}, 60, state);
  taken.submits = opened->queue().submits() - submits;
  taken.allocations = allocations - allocated;
  taken.rest = state;
  EXPECT_TRUE(taken.result.at_rest);
  EXPECT_GT(taken.result.back_solves, by_cg ? 1 : 3);
  for (const std::string& m : options.messages->texts) ADD_FAILURE() << m;
  return taken;
}

// Of memory that is not mapped the host reads a state in one submit, twice: of the body as the
// event leaves it, and at its rest. What it writes goes with the iterations.
TEST_P(FiniteKernels, AnEventAllocatesNothingAndReadsInOneSubmit) {
  for (const Route route : {Route::inverse, Route::cg}) {
    for (const Index elements : route == Route::cg ? std::vector{3} : std::vector{1, 3, 10}) {
      SCOPED_TRACE(std::string(route == Route::cg ? "cg" : "inverse") + ", elements " +
                   std::to_string(elements));
      const Taken mapped = taken_by_an_event(GetParam(), false, route, elements),
                  unmapped = taken_by_an_event(GetParam(), true, route, elements);
      EXPECT_EQ(mapped.allocations, 0u);
      EXPECT_EQ(unmapped.allocations, 0u);
      EXPECT_EQ(unmapped.rest.u, mapped.rest.u);
      EXPECT_EQ(unmapped.rest.f, mapped.rest.f);
      EXPECT_EQ(unmapped.rest.r, mapped.rest.r);
      EXPECT_EQ(unmapped.rest.stress, mapped.rest.stress);
      EXPECT_EQ(unmapped.submits, mapped.submits + 2);
      // An iteration each; the first state; shorter steps of the line search.
      EXPECT_LE(mapped.submits, static_cast<std::size_t>(mapped.result.back_solves) + 6);
    }
  }
}

// 16,536 unknowns, of which one workgroup would sum too long: five do.
TEST_P(FiniteKernels, SumsOfALargeBodyAreTheHosts) {
  if (!GetParam().fp64) GTEST_SKIP() << "states are in fp64 whatever the inverse is in";
  Scene scene = Torn::scene();
  scene.mesh = structured_board({52, 52, 1, 6, 4, 2});
  const Problem problem(scene);
  ASSERT_GT(problem.dof_count(), 16384);
  const std::vector<std::uint8_t> out(problem.mesh().tets.size(), 0);
  const std::vector<const Law*> laws = fem::one_law(problem, kCorotated);
  const fem::HyperelasticBody body{problem, laws, out};
  const solver::RestingBody resting(body);
  gpu::FiniteDevice device(*factory_, body, {.route = Route::factor});
  const solver::FinitePotential host(resting, StressMeasure::cauchy),
      there(resting, StressMeasure::cauchy, &device);
  EXPECT_TRUE(std::ranges::any_of(device.kernels(), [](const KernelPlan& kernel) {
    return kernel.name.find("finite_sums_join") == 0;
  }));
  Load load;
  load.displacements.assign(problem.gripped_dofs().size(), 0.5);
  const solver::FiniteTarget target = host.target(load);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> of(-1e-3, 1e-3);
  solver::FiniteState expected;
  for (const Index d : problem.dofs()) expected.u.push_back(d == kNone ? 0 : of(random));
  solver::FiniteState found, again;
  found.u = again.u = expected.u;
  host.evaluate(target, true, expected);
  there.evaluate(target, true, found);
  EXPECT_NEAR(found.energy, expected.energy, 1e-12 * expected.energy);
  EXPECT_NEAR(found.potential, expected.potential, 1e-12 * expected.energy);
  EXPECT_NEAR(found.acting, expected.acting, 1e-11 * expected.acting);
  EXPECT_LE(apart(span_of(found.r), span_of(expected.r)), 1e-12);
  there.evaluate(target, true, again);
  EXPECT_EQ(again.energy, found.energy);
  EXPECT_EQ(again.acting, found.acting);
}

INSTANTIATE_TEST_SUITE_P(All, FiniteKernels,
                         ::testing::Values(Numbers{gpu::Variant::gpu, false},
                                           Numbers{gpu::Variant::gpu, true},
                                           Numbers{gpu::Variant::lvp, false},
                                           Numbers{gpu::Variant::lvp, true}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
