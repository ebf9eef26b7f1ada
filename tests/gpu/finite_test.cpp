// SPDX-License-Identifier: Apache-2.0
// Bodies at finite deformation and in motion on the device against the CPU: states, iterations,
// frames, the same pieces falling; what a submit does; a device lost in mid-step.
#include <numbers>
#include <random>

#include "body/lumped_mass.hpp"
#include "fracture_lists.hpp"
#include "gpu/finite_device.hpp"
#include "kernels_fixture.hpp"
#include "material/corotated.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "material/saint_venant_kirchhoff.hpp"
#include "solver/finite_minimiser.hpp"
#include "solver/finite_renewal.hpp"
#include "sunder/stress_measures.hpp"

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

/// The promise of both sides: what they may be apart by is the accuracy table's.
constexpr double kTight = 1e-10;

/// A sheet that hangs from its upper edge under gravity, pulled by a grip until it tears.
Scene torn_sheet(bool moves, MaterialLaw law, FractureModel model) {
  Scene scene;
  scene.mesh = structured_board({8, 8, 1, 8, 8, 1});
  scene.materials["board"] = {5, 0.4, 1.2, law, 1e-9};
  scene.supports.push_back({Box{Vec3(-1, 8 - 1e-6, -1), Vec3(9, 9, 9)}, Axes{7}});
  Instrument hand;
  hand.name = "hand";
  hand.action = Grip{Box{Vec3(6, -1, -1), Vec3(9, 1e-6, 9)}, Vec3(1, -5, 1), Axes{7}};
  hand.ramp = Ramp{0, 1};
  scene.instruments.push_back(hand);
  scene.fracture.model = model;
  scene.fracture.birth = CrackBirth::through;
  scene.fracture.max_events = 4;
  scene.steps = moves ? 24 : 8;
  scene.gravity = Vec3(0, -9810, 0);
  if (moves) {
    scene.dynamics = Dynamics{.time_step = 0.002};
    scene.dynamics->stiffness_damping = 1e-4;
  }
  scene.solver.tolerance = kTight;
  return scene;
}

struct Course {
  Fractures destroyed;
  std::vector<Vec3> displacement;
  std::vector<Voigt> stress;
  std::vector<double> kinetic;
  std::vector<std::string> warnings;
  BackendInfo info;
};

Course run(const std::shared_ptr<const Problem>& problem, std::unique_ptr<Backend> backend) {
  Simulation simulation(problem, std::move(backend));
  Course of;
  while (!simulation.done()) {
    const StepReport report = simulation.step();
    if (report.motion) of.kinetic.push_back(report.motion->kinetic);
  }
  of.destroyed = simulation.destroyed();
  of.displacement = simulation.displacement();
  of.stress = simulation.stress();
  of.warnings = simulation.warnings();
  of.info = simulation.backend().info();
  return of;
}

Course run_on_cpu(Scene scene) {
  scene.solver.precision = Precision::automatic;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  return run(problem, cpu_reference::create(problem, needs_of(*problem)));
}

double table_error(Precision precision) {
  return precision == Precision::fp32 ? kFp32Tolerance : kCrackTolerance;
}

/// What the host knows of elements at the decision at which the lists part: run again up to there.
std::function<Yielding(Index)> yielding_at(Scene scene, const Parting& parting, double error) {
  scene.solver.precision = Precision::automatic;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  std::vector<Voigt> stress;
  simulation.observe_frames([&] {
    if (simulation.steps_done() == parting.step && simulation.destroyed().size() == parting.before)
      stress = simulation.stress();
  });
  while (simulation.steps_done() <= parting.step) simulation.step();
  double largest = 0;
  for (const Voigt& s : stress) largest = std::max(largest, tensor_norm(s));
  return [=](Index e) {
    return Yielding{max_shear(stress[static_cast<std::size_t>(e)]) / problem->yield(e),
                    error * largest / problem->yield(e)};
  };
}

/// The same lists, or such as part where a ratio lies in the named band; with the same lists the
/// same fields, within the accuracy table.
void expect_alike(const Scene& scene, const Course& found, const Course& expected,
                  Precision precision) {
  const double allowed = table_error(precision);
  EXPECT_GE(expected.destroyed.size(), 4u);
  if (const auto at = parting(expected.destroyed, found.destroyed)) {
    const std::string why =
        excuse(*at, expected.destroyed, found.destroyed, yielding_at(scene, *at, allowed));
    ASSERT_NE(why, "") << "the lists part after " << at->index << " fractures, in step " << at->step
                       << ", where no ratio is near the limit";
    std::printf("the lists part after %zu fractures: %s\n", at->index, why.c_str());
    return;
  }
  const Problem problem(scene);
  std::vector<std::uint8_t> gone(problem.mesh().tets.size(), 0);
  for (const DestroyedElement& d : expected.destroyed)
    gone[static_cast<std::size_t>(d.element)] = 1;
  const auto u_of = [](const Course& of) {
    return std::span<const double>(of.displacement.front().data(), 3 * of.displacement.size());
  };
  const double u = displacement_error(problem.mesh(), gone, u_of(found), u_of(expected)),
               stress = stress_error(gone, found.stress, expected.stress);
  std::printf("%zu fractures: errors of u %.1e, of stress %.1e\n", expected.destroyed.size(), u,
              stress);
  EXPECT_LE(u, allowed);
  EXPECT_LE(stress, allowed);
  for (std::size_t i = 0; i < expected.kinetic.size(); ++i) {
    // Twice the relative error of the velocities, which differences of displacements are.
    EXPECT_NEAR(found.kinetic[i], expected.kinetic[i], 100 * allowed * expected.kinetic[i]) << i;
  }
}

struct Sheet {
  const char* name;
  bool moves;
  MaterialLaw law;
  FractureModel model;
  Precision precision = Precision::fp64;
  Route route = Route::automatic;
};

using FiniteRoutes = WithVulkan<>;
class FiniteScenes : public WithVulkan<testing::TestWithParam<Sheet>> {};

TEST_P(FiniteScenes, TearAsOnTheHost) {
  const Sheet& of = GetParam();
  Scene scene = torn_sheet(of.moves, of.law, of.model);
  if (of.route == Route::cg) scene.solver.tolerance = 10 * kTight;  // a software device's time
  const Course expected = run_on_cpu(scene);
  WatchedBackend watched(
      scene, {.precision = of.precision, .tolerance = scene.solver.tolerance, .route = of.route});
  const Course found = run(watched.problem, watched.create());
  expect_alike(scene, found, expected, of.precision);
  EXPECT_EQ(found.info.backend, "vulkan");
  EXPECT_EQ(found.info.precision, of.precision == Precision::fp64 ? "fp64" : "fp32");
  const Course again = run(watched.problem, watched.create());
  EXPECT_EQ(again.displacement, found.displacement);
}

INSTANTIATE_TEST_SUITE_P(
    All, FiniteScenes,
    ::testing::Values(
        Sheet{"corotated_A", false, MaterialLaw::corotated, FractureModel::a},
        Sheet{"neo_hookean_B", false, MaterialLaw::neo_hookean, FractureModel::b},
        Sheet{"motion_corotated_B", true, MaterialLaw::corotated, FractureModel::b},
        Sheet{"motion_neo_hookean_A", true, MaterialLaw::neo_hookean, FractureModel::a},
        Sheet{"motion_neo_hookean_A_fp32", true, MaterialLaw::neo_hookean, FractureModel::a,
              Precision::fp32},
        Sheet{"by_factor", false, MaterialLaw::corotated, FractureModel::a, Precision::fp64,
              Route::factor},
        Sheet{"motion_by_factor", true, MaterialLaw::neo_hookean, FractureModel::a, Precision::fp64,
              Route::factor},
        Sheet{"motion_corotated_by_cg", true, MaterialLaw::corotated, FractureModel::b,
              Precision::fp64, Route::cg},
        Sheet{"motion_neo_hookean_by_cg_fp32", true, MaterialLaw::neo_hookean, FractureModel::a,
              Precision::fp32, Route::cg},
        Sheet{"motion_kirchhoff_A", true, MaterialLaw::saint_venant_kirchhoff, FractureModel::a},
        Sheet{"motion_linear_A", true, MaterialLaw::linear, FractureModel::a}),
    [](const auto& tested) { return std::string(tested.param.name); });

// Small bodies by an inverse, others in motion without a base at all, at rest by the host's factor.
TEST_F(FiniteRoutes, AutoGoesBySize) {
  const auto info_of = [](bool moves, Index cells) {
    Scene scene = torn_sheet(moves, MaterialLaw::corotated, FractureModel::a);
    scene.mesh = structured_board({cells, cells, cells, 8, 8, 8});
    scene.solver.backend = "vulkan";
    scene.solver.tolerance = 1e-4;
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    const auto backend = gpu::create(problem, needs_of(*problem), {});
    const std::vector<std::string>& left_out = backend->needs().left_out;
    const bool without_forces = std::ranges::any_of(left_out, [](const std::string& text) {
      return text.find("forces of grips between frames") == 0;
    });
    EXPECT_EQ(without_forces, backend->info().route == "cg");
    EXPECT_EQ(backend->instrument_forces() == nullptr, backend->info().route == "cg");
    return backend->info();
  };
  EXPECT_EQ(info_of(true, 4).route, "inverse");
  EXPECT_EQ(info_of(false, 4).route, "inverse");
  const BackendInfo moving = info_of(true, 11);
  EXPECT_EQ(moving.route, "cg");
  EXPECT_NE(moving.why.find("conjugate gradients on the tangent of every state, on the device"),
            std::string::npos);
  const BackendInfo resting = info_of(false, 11);
  EXPECT_EQ(resting.route, "factor");
  EXPECT_NE(resting.why.find("by the host; forces and stress on the device"), std::string::npos);
}

struct Loss {
  bool moves;
  Route route;
};
class FiniteDeviceLost : public WithVulkan<testing::TestWithParam<Loss>> {};

TEST_P(FiniteDeviceLost, InMidStepTheHostGoesOnFromTheLastState) {
  Scene scene = torn_sheet(GetParam().moves, MaterialLaw::neo_hookean, FractureModel::a);
  const Course expected = run_on_cpu(scene);
  WatchedBackend watched(scene, {.tolerance = kTight, .route = GetParam().route});
  int losses = 0;
  for (const int submits : {2, 9, 40, 77, 150, 400}) {
    watched.options.probe.submits_until_lost = submits;
    std::unique_ptr<Backend> backend;
    try {
      backend = watched.create();
    } catch (const sunder::DeviceLost&) {
      continue;  // while it was made
    }
    const Course found = run(watched.problem, std::move(backend));
    expect_alike(scene, found, expected, Precision::fp64);
    const bool lost = found.info.why.find("took over") != std::string::npos;
    losses += lost;
    EXPECT_EQ(std::ranges::any_of(found.warnings,
                                  [](const std::string& text) {
                                    return text.find("backend vulkan failed in mid-run") == 0;
                                  }),
              lost);
  }
  EXPECT_GE(losses, 3);
}

INSTANTIATE_TEST_SUITE_P(All, FiniteDeviceLost,
                         ::testing::Values(Loss{false, Route::inverse}, Loss{true, Route::inverse},
                                           Loss{true, Route::cg}),
                         [](const auto& tested) {
                           return std::string(tested.param.moves ? "moving_" : "resting_") +
                                  (tested.param.route == Route::cg ? "cg" : "inverse");
                         });

using FiniteRefusals = WithVulkan<>;

TEST_F(FiniteRefusals, SayWhatWouldDo) {
  const auto refusal = [](Scene scene,
                          const std::function<void(gpu::VulkanOptions&)>& adjust = {}) {
    scene.solver.backend = "vulkan";
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    gpu::VulkanOptions options;
    if (adjust) adjust(options);
    return message_of(
        [&] { static_cast<void>(gpu::create(problem, needs_of(*problem), options)); });
  };
  Scene resting = torn_sheet(false, MaterialLaw::corotated, FractureModel::a);
  resting.solver.tolerance = 1e-4;
  resting.solver.route = Route::cg;
  EXPECT_EQ(refusal(resting),
            "route cg cannot serve law \"corotated\": whether a rest is stable is judged by a "
            "factor of its tangent; use route inverse, factor or auto");
  Scene scene = torn_sheet(true, MaterialLaw::corotated, FractureModel::a);
  scene.solver.tolerance = 1e-4;
  EXPECT_NE(refusal(scene, [](gpu::VulkanOptions& o) { o.probe.no_float64 = true; })
                .find("lacks shaderFloat64, which motion needs"),
            std::string::npos);
  EXPECT_NE(refusal(scene, [](gpu::VulkanOptions& o) { o.probe.memory = 100000; })
                .find("bytes on the device"),
            std::string::npos);
}

}  // namespace
}  // namespace sunder::test
