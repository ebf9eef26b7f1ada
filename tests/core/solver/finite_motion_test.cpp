// SPDX-License-Identifier: Apache-2.0
// Motion at finite deformation against what is known of it: free flight, spin, the scheme's own
// decay of a swing, order of convergence, a cut.
#include "solver/finite_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "body/lumped_mass.hpp"
#include "material/corotated.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "support/assembled_tangent.hpp"
#include "support/loads.hpp"
#include "support/structured_board.hpp"

namespace sunder::solver {
namespace {

constexpr Index kCells = 10;
constexpr double kDensity = 1e-9;  // water [t/mm^3]
const Vec3 kDown(0, -9810, 0);

/// A bar of 10 x 1 x 1 mm, supported at x = 0.
struct Bar {
  explicit Bar(const Law& law, double density = kDensity)
      : problem(scene()),
        laws(fem::one_law(problem, law)),
        out(problem.mesh().tets.size(), 0),
        mass(fem::lumped_masses(problem, std::vector<double>{density})) {}
  static Scene scene() {
    Scene of;
    of.mesh = test::structured_board({kCells, 2, 2, 10, 1, 1});
    of.materials["board"] = {5, 0.3, 2.0};
    of.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 2, 2)}, Axes{7}});
    return of;
  }
  /// The cells of column i; with the first of them the bar's only support is gone.
  std::vector<Index> column(Index i) const {
    std::vector<Index> of;
    for (Index e = 0; e < problem.tet_count(); ++e) {
      if ((e / 6) % kCells == i) of.push_back(e);
    }
    return of;
  }
  void destroy(std::span<const Index> elements) {
    for (Index e : elements) out[e] = 1;
  }
  /// Of nodes that are not supported, beyond x.
  double mass_beyond(double x) const {
    double of = 0;
    for (Index n = 0; n < problem.node_count(); ++n) {
      if (problem.mesh().nodes[n].x() > x && problem.dof(n, 0) != kNone) of += mass[n];
    }
    return of;
  }
  Vec3 centre() const {
    Vec3 of = Vec3::Zero();
    for (Index n = 0; n < problem.node_count(); ++n) {
      if (problem.dof(n, 0) != kNone) of += mass[n] * problem.mesh().nodes[n];
    }
    return of / mass_beyond(0);
  }
  std::vector<double> velocities(const std::function<Vec3(const Vec3&)>& at) const {
    std::vector<double> of;
    for (const Vec3& x : problem.mesh().nodes) {
      const Vec3 v = at(x);
      of.insert(of.end(), {v.x(), v.y(), v.z()});
    }
    return of;
  }

  Problem problem;
  std::vector<const Law*> laws;
  std::vector<std::uint8_t> out;
  std::vector<double> mass;
  fem::HyperelasticBody body{problem, laws, out};
};

TEST(FiniteMotion, FliesFreelyWithItsMomentum) {
  Bar bar(kCorotated);
  bar.destroy(bar.column(0));
  FiniteMotion motion(bar.body, bar.mass, {.gravity = kDown});
  const Vec3 start(300, 400, 500);
  motion.set_velocity(bar.velocities([&](const Vec3&) { return start; }));
  const double mass = bar.mass_beyond(0), dt = 1.0 / 200;
  for (int i = 1; i <= 40; ++i) {
    const auto report = motion.step({}, dt);
    ASSERT_FALSE(report.stuck || report.capped) << i;
    EXPECT_EQ(report.second_order, i > 1);
    const Vec3 expected = mass * (start + i * dt * kDown);
    EXPECT_LE((motion.momentum() - expected).norm(), 1e-12 * expected.norm()) << i;
  }
  EXPECT_LE(motion.strain_energy(), 1e-12 * motion.kinetic_energy());
}

// What BDF2 leaves of a fast spin is its own: .84 and .98 of the angular momentum (finite.md).
TEST(FiniteMotion, SpinsOnAsTheSchemeLetsIt) {
  for (const auto& [rate, left] : {std::pair(60, 0.84), std::pair(200, 0.98)}) {
    Bar bar(kCorotated);
    bar.destroy(bar.column(0));
    FiniteMotion motion(bar.body, bar.mass, {.tolerance = 1e-8, .residual = 1e-8});
    const Vec3 centre = bar.centre();
    motion.set_velocity(
        bar.velocities([&](const Vec3& x) { return Vec3(0, 0, 20).cross(x - centre); }));
    const double before = motion.angular_momentum().z();
    for (int i = 0; i < rate / 2; ++i) ASSERT_FALSE(motion.step({}, 1.0 / rate).stuck);
    const double share = motion.angular_momentum().z() / before;
    std::printf("dt 1/%d s: .5 s of 20 rad/s leave %.3f of the spin\n", rate, share);
    EXPECT_NEAR(share, left, 0.02);
    EXPECT_LE(motion.momentum().norm(), 1e-6 * bar.mass_beyond(0) * 100);
  }
}

/// Of an oscillator of mass 1 after a step: where it is, and what damping and the scheme have taken
/// of its energy so far.
struct Oscillation {
  double u, v;
  double damped = 0, scheme = 0;
};

/// u'' = -w^2 u - c u' from u = 0, u' = 1 by the same scheme, step by step. Nothing works on it, so
/// that the scheme has what is missing of its energy besides c u' du.
std::vector<Oscillation> oscillator(double w, double c, double dt, int steps) {
  const auto energy = [&](double u, double v) { return (v * v + w * w * u * u) / 2; };
  std::vector<Oscillation> of{{0, 1}};
  for (int i = 1; i <= steps; ++i) {
    const auto [u, v, damped, scheme] = of.back();
    const double rate = (i == 1 ? 1 : 1.5) / dt;
    double u_from = u, v_from = v;
    if (i > 1) {
      const Oscillation& before = of[of.size() - 2];
      u_from = (4 * u - before.u) / 3;
      v_from = (4 * v - before.v) / 3;
    }
    const double now = rate * ((rate + c) * u_from + v_from) / (rate * (rate + c) + w * w);
    const double speed = rate * (now - u_from), taken = c * speed * (now - u);
    const double lost = energy(u, v) - energy(now, speed) - taken;
    // Of backward Euler it is the energy of the difference.
    if (i == 1) {
      EXPECT_NEAR(lost, energy(now - u, speed - v), 1e-14);
    }
    of.push_back({now, speed, damped + taken, scheme + lost});
  }
  return of;
}

/// The lowest frequency [rad/s] of a body and the displacements (3 * nodes) of that mode.
std::pair<double, std::vector<double>> lowest_mode(const Bar& bar) {
  std::vector<double> u(bar.problem.dofs().size(), 0.0);
  const Eigen::MatrixXd k = test::assemble_tangent(bar.body, u, fem::Tangent::exact).toDense();
  Eigen::VectorXd m(bar.problem.dof_count());
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (bar.problem.dofs()[i] != kNone) m[bar.problem.dofs()[i]] = bar.mass[i / 3];
  }
  const Eigen::VectorXd root = m.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(
      root.asDiagonal() * k * root.asDiagonal());  // reads the lower triangle
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Index d = bar.problem.dofs()[i];
    if (d != kNone) u[i] = root[d] * modes.eigenvectors()(d, 0);
  }
  return {std::sqrt(modes.eigenvalues()[0]), u};
}

/// Half a second of the lowest mode of the clamped bar, its density such that it swings at 27.5 Hz.
/// Every node is where the same scheme has the mode's own oscillator, and damping and scheme take
/// of the energy what they take of the oscillator's, step by step. Returns the share of the energy
/// that is left, and what damping took of it.
std::pair<double, double> swing(int rate, FiniteMotionOptions options) {
  const double wanted = 2 * std::numbers::pi * 27.5;
  const double ratio = lowest_mode(Bar(kLinear)).first / wanted;
  const Bar bar(kLinear, kDensity * ratio * ratio);
  const auto [w, v] = lowest_mode(bar);
  EXPECT_NEAR(w, wanted, 1e-6 * wanted);
  options.tolerance = 1e-10;
  options.residual = 1e-12;
  FiniteMotion motion(bar.body, bar.mass, options);
  motion.set_velocity(v);
  const double before = motion.kinetic_energy();
  const auto expected =
      oscillator(w, options.damping + options.viscosity * w * w, 1.0 / rate, rate / 2);
  double apart = 0, most = 0;
  for (int s = 1; s <= rate / 2; ++s) {
    EXPECT_FALSE(motion.step({}, 1.0 / rate).stuck);
    for (std::size_t i = 0; i < v.size(); ++i) {
      apart = std::max(apart, std::abs(motion.displacement()[i] - v[i] * expected[s].u));
      most = std::max(most, std::abs(motion.displacement()[i]));
    }
    // The mode's mass is 1, and so is its first velocity.
    EXPECT_NEAR(motion.sum().damped, expected[s].damped, 1e-8 * before) << s;
    EXPECT_NEAR(motion.sum().scheme, expected[s].scheme, 1e-8 * before) << s;
  }
  EXPECT_LE(apart, 1e-8 * most);
  return {(motion.kinetic_energy() + motion.strain_energy()) / before,
          motion.sum().damped / before};
}

TEST(FiniteMotion, ASwingDecaysByTheSchemesOwnRate) {
  for (const auto& [rate, left] :
       {std::pair(60, 0.0), std::pair(200, 0.0), std::pair(1000, 0.77)}) {
    const double share = swing(rate, {}).first;
    std::printf("dt 1/%d s: .5 s of 27.5 Hz leave %.3f of the energy\n", rate, share);
    EXPECT_NEAR(share, left, 0.02);
  }
}

// Damping by mass and by stiffness: exp(-(a + b w^2) t) of the energy of a swing, besides the
// scheme's own loss.
TEST(FiniteMotion, ASwingDecaysByItsDamping) {
  const double w = 2 * std::numbers::pi * 27.5, own = swing(1000, {}).first;
  const auto [by_mass, of_mass] = swing(1000, {.damping = 2});
  const auto [by_stiffness, of_stiffness] = swing(1000, {.viscosity = 2 / (w * w)});
  EXPECT_NEAR(by_mass, own * std::exp(-1), 0.01);
  EXPECT_NEAR(by_stiffness, own * std::exp(-1), 0.01);
  EXPECT_NEAR(of_mass, of_stiffness, 1e-6);
  EXPECT_GT(of_mass, 0.4);
}

// Viscous forces know a rotation from a strain: they take nothing of a spin.
TEST(FiniteMotion, ASpinHasNoViscosity) {
  const auto left = [](double viscosity) {
    Bar bar(kCorotated);
    bar.destroy(bar.column(0));
    FiniteMotion motion(bar.body, bar.mass,
                        {.tolerance = 1e-6, .residual = 1e-6, .viscosity = viscosity});
    const Vec3 centre = bar.centre();
    motion.set_velocity(
        bar.velocities([&](const Vec3& x) { return Vec3(0, 0, 20).cross(x - centre); }));
    const double before = motion.angular_momentum().z();
    for (int i = 0; i < 100; ++i) EXPECT_FALSE(motion.step({}, 1.0 / 200).stuck);
    return motion.angular_momentum().z() / before;
  };
  const double without = left(0), with = left(0.01);
  std::printf("spin left without viscosity %.4f, with %.4f\n", without, with);
  EXPECT_NEAR(with, without, 1e-4);
}

Load pulled(const Problem& problem, double force) {
  return test::pull(problem, test::nodes_in(problem.mesh(), {Vec3(9.99, -1, -1), Vec3(11, 2, 2)}),
                    Vec3(0, -force, 0));
}

/// From 0 to 1 without a jump in the first three derivatives.
double smooth(double t) {
  return std::pow(t, 4) * (35 - 84 * t + 70 * t * t - 20 * std::pow(t, 3));
}

TEST(FiniteMotion, IsOfSecondOrderInTime) {
  for (const Law* law : {&kCorotated, &kNeoHookean}) {
    constexpr double kEnd = 0.02;
    const auto end = [&](int steps) {
      Bar bar(*law);
      FiniteMotion motion(bar.body, bar.mass, {.tolerance = 1e-9, .residual = 1e-10});
      for (int i = 1; i <= steps; ++i) {
        const double t = 1.0 * i / steps;
        EXPECT_FALSE(motion.step(pulled(bar.problem, 0.01 * smooth(t)), kEnd / steps).stuck);
      }
      return motion.displacement();
    };
    const auto coarse = end(240), fine = end(480), finest = end(960);
    double change = 0, next = 0;
    for (std::size_t i = 0; i < fine.size(); ++i) {
      change = std::max(change, std::abs(fine[i] - coarse[i]));
      next = std::max(next, std::abs(finest[i] - fine[i]));
    }
    std::printf("%s: 480 steps change 240's by %.3g mm, 960 those by %.3g: ratio %.2f\n",
                law->name.data(), change, next, change / next);
    EXPECT_GT(change / next, 3.4);
    EXPECT_LT(change / next, 4.6);
  }
}

// What is cut off falls: only gravity changes its momentum.
TEST(FiniteMotion, WhatIsCutOffFalls) {
  Bar bar(kCorotated);
  FiniteMotion motion(bar.body, bar.mass, {.tolerance = 1e-8, .residual = 1e-8, .gravity = kDown});
  constexpr double kDt = 1e-3;
  for (int i = 0; i < 20; ++i) ASSERT_FALSE(motion.step({}, kDt).stuck);
  const auto gone = bar.column(4);
  bar.destroy(gone);
  motion.destroyed(gone);
  const auto beyond = [&] {
    Vec3 of = Vec3::Zero();
    for (Index n = 0; n < bar.problem.node_count(); ++n) {
      if (bar.problem.mesh().nodes[n].x() > 4.5) {
        of += bar.mass[n] * Vec3(&motion.velocity()[static_cast<std::size_t>(3 * n)]);
      }
    }
    return of;
  };
  const Vec3 before = beyond();
  const double mass = bar.mass_beyond(4.5);
  for (int i = 1; i <= 60; ++i) {
    const auto report = motion.step({}, kDt);
    ASSERT_FALSE(report.stuck || report.capped) << i;
    EXPECT_EQ(report.second_order, i > 3);
    const Vec3 expected = before + i * kDt * mass * kDown;
    EXPECT_LE((beyond() - expected).norm(), 1e-8 * expected.norm()) << i;
  }
}

// Work, damping, gravity and ruptures: the terms of every step add up, the scheme takes energy
// through all ruptures and gives none, and takes less in shorter steps.
TEST(FiniteMotion, EnergyIsAccountedForThroughRuptures) {
  double lost = 1;
  for (const int rate : {1000, 4000}) {
    Bar bar(kNeoHookean);
    FiniteMotion motion(bar.body, bar.mass, {.damping = 5, .gravity = kDown});
    const auto energy = [&] {
      return motion.kinetic_energy() + motion.strain_energy() + motion.gravity_energy();
    };
    double work = 0, scheme = 0, unsolved = 0, broken = 0, damped = 0;
    std::vector<Index> tear;
    for (const Index at : {5, 8, 3, 10, 2, 6}) {
      const auto column = bar.column(at);
      tear.insert(tear.end(), column.begin(), column.end());
    }
    std::size_t gone = 0;
    for (int i = 1; i <= rate / 20; ++i) {
      const double t = 20.0 * i / rate;
      const auto due =
          std::min(tear.size(), static_cast<std::size_t>(200 * std::max(0.0, t - 0.5)));
      if (gone < due) {
        const std::span<const Index> next = std::span(tear).subspan(gone, due - gone);
        gone = due;
        bar.destroy(next);
        const double whole = motion.strain_energy();
        motion.destroyed(next);
        EXPECT_LE(motion.strain_energy(), whole);
      }
      const double before = energy();
      const auto report = motion.step(pulled(bar.problem, 0.02 * smooth(t)), 1.0 / rate);
      ASSERT_FALSE(report.stuck) << i;
      const auto& b = report.balance;
      const double terms =
          std::abs(b.work) + std::abs(b.damped) + std::abs(b.scheme) + std::abs(before);
      EXPECT_NEAR(b.work, energy() - before + b.damped + b.scheme + b.unsolved, 1e-12 * terms) << i;
      EXPECT_GE(b.broken, 0);
      EXPECT_GE(b.damped, 0);
      work += b.work;
      scheme += b.scheme;
      unsolved += b.unsolved;
      broken += b.broken;
      damped += b.damped;
    }
    std::printf(
        "dt 1/%d s: %zu ruptures, work %.4f, broken %.4f, damped %.4f, scheme %.5f, unsolved %.1e "
        "N mm\n",
        rate, gone, work, broken, damped, scheme, unsolved);
    EXPECT_GE(gone, 90U);
    EXPECT_LE(std::abs(unsolved), 1e-2 * work);
    EXPECT_GE(scheme, 0);
    EXPECT_LT(scheme / work, lost);
    lost = scheme / work;
  }
}

// The linear law's base is right in every state: the first serves all steps. It has the inertia of
// the first step, of backward Euler, and yet few back-solves do.
TEST(FiniteMotion, ALinearBodyHasOneBaseForAll) {
  for (const int rate : {200, 1000}) {
    Bar bar(kLinear);
    FiniteMotion motion(bar.body, bar.mass, {.gravity = kDown});
    int factors = 0, bases = 0, back_solves = 0;
    for (int i = 1; i <= rate; ++i) {
      const double t = 1.0 * i / rate;
      const auto report =
          motion.step(pulled(bar.problem, 0.01 * smooth(std::min(1.0, 2 * t))), 1.0 / rate);
      ASSERT_FALSE(report.stuck) << i;
      factors += report.factors;
      bases += report.bases;
      back_solves += report.back_solves;
    }
    std::printf("dt 1/%d s: %.2f back-solves a step\n", rate, 1.0 * back_solves / rate);
    EXPECT_EQ(factors, 1);
    EXPECT_EQ(bases, 0);
    EXPECT_LE(back_solves, 5 * rate);
  }
}

// A body at rest: no iteration, no base, the same bits; a load moves it again.
TEST(FiniteMotion, ABodyAtRestAsksForNothing) {
  for (const double viscosity : {0.0, 0.02}) {
    Bar bar(kNeoHookean);
    FiniteMotion motion(bar.body, bar.mass, {.viscosity = viscosity});
    for (int i = 0; i < 5; ++i) {
      const auto report = motion.step({}, 5e-3);
      EXPECT_TRUE(report.still);
      EXPECT_EQ(report.back_solves + report.factors, 0);
    }
    EXPECT_EQ(motion.displacement(), std::vector<double>(motion.displacement().size(), 0.0));
  }
  for (const double viscosity : {0.0, 0.02}) {
    Bar bar(kNeoHookean);
    FiniteMotion motion(bar.body, bar.mass,
                        {.damping = 100, .viscosity = viscosity, .gravity = kDown});
    const Load load = pulled(bar.problem, 0.005);
    int moving = 0;
    while (moving < 1000 && !motion.step(load, 5e-3).still) ++moving;
    std::printf("viscosity %.2f s: %d steps to rest\n", viscosity, moving);
    EXPECT_GT(moving, 5);
    EXPECT_LT(moving, 300);
    const auto rest = motion.displacement();
    const FiniteMotionBalance so_far = motion.sum();
    for (int i = 0; i < 50; ++i) {
      const auto report = motion.step(load, 5e-3);
      ASSERT_TRUE(report.still);
      ASSERT_EQ(report.back_solves + report.factors, 0);
    }
    EXPECT_EQ(motion.displacement(), rest);
    EXPECT_EQ(motion.kinetic_energy(), 0);
    EXPECT_EQ(motion.sum().work, so_far.work);
    const auto again = motion.step(pulled(bar.problem, 0.0051), 5e-3);
    EXPECT_FALSE(again.still || again.stuck);
    EXPECT_GT(motion.kinetic_energy(), 0);
    EXPECT_NE(motion.displacement(), rest);
  }
}

TEST(FiniteMotion, HasTheSameBitsWhateverTheThreadDoes) {
  const auto run = [](std::chrono::milliseconds rest) {
    Bar bar(kNeoHookean);
    FiniteMotion motion(bar.body, bar.mass, {.gravity = kDown, .renew_after = 1, .rest = rest});
    for (int i = 0; i < 30; ++i) {
      if (i == 20) {
        const auto gone = bar.column(6);
        bar.destroy(std::span(gone).first(9));
        motion.destroyed(std::span(gone).first(9));
      }
      EXPECT_FALSE(motion.step(pulled(bar.problem, 0.02), 2e-3).stuck);
    }
    return motion.displacement();
  };
  EXPECT_EQ(run(std::chrono::milliseconds(0)), run(std::chrono::milliseconds(4)));
}

TEST(FiniteMotion, ACapEndsAStepAndSaysSo) {
  Bar bar(kCorotated);
  FiniteMotion motion(bar.body, bar.mass,
                      {.tolerance = 1e-9, .gravity = kDown, .most_iterations = 2});
  int capped = 0;
  for (int i = 0; i < 20; ++i) {
    const auto report = motion.step(pulled(bar.problem, 0.05), 5e-3);
    ASSERT_FALSE(report.stuck);
    EXPECT_LE(report.back_solves, 2);
    capped += report.capped;
    if (report.capped) {
      EXPECT_FALSE(motion.step(pulled(bar.problem, 0.05), 5e-3).second_order);
    }
  }
  EXPECT_GE(capped, 1);
}

// Steps that their cap ends one after the other, the load shaken as fast as they come: no step ends
// with more energy than it began with and got by work.
TEST(FiniteMotion, ACapDoesNotPumpUpTheBody) {
  for (const auto& [law, cap] : {std::pair<const Law*, int>{&kCorotated, 2},
                                 {&kNeoHookean, 2},
                                 {&kCorotated, 4},
                                 {&kNeoHookean, 4}}) {
    Bar bar(*law);
    FiniteMotion motion(bar.body, bar.mass, {.most_iterations = cap});
    int capped = 0;
    double energy = 0;
    for (int i = 1; i <= 400; ++i) {
      const auto report = motion.step(pulled(bar.problem, 0.03 * std::sin(0.4 * i)), 5e-3);
      ASSERT_FALSE(report.stuck) << i;
      capped += report.capped;
      const double before = std::exchange(energy, motion.kinetic_energy() + motion.strain_energy());
      const double won = energy - before - report.balance.work;
      if (report.capped) {
        EXPECT_LE(won, 1e-12 * (before + energy)) << i;
      }
    }
    EXPECT_GE(capped, 40) << law->name;
  }
}

// A base no longer does after 8 back-solves, 5 of short steps, and in any case where the cap ended
// the step: the next one takes a new base then, and only then.
TEST(FiniteMotion, ABaseIsRenewedAfterStepsThatAreHard) {
  struct Case {
    int rate, cap, most;
  };
  for (const auto& [rate, cap, most] :
       {Case{200, 0, 8}, {200, 12, 8}, {200, 8, 7}, {200, 3, 2}, {1000, 8, 5}, {1000, 0, 5}}) {
    Bar bar(kNeoHookean);
    FiniteMotion motion(
        bar.body, bar.mass,
        {.tolerance = 1e-7, .residual = 1e-6, .most_iterations = cap, .taken_after = 1});
    int bases = 0;
    bool hard = false;
    for (int i = 1; i <= 40; ++i) {
      const auto report = motion.step(pulled(bar.problem, 0.01 * i), 1.0 / rate);
      ASSERT_FALSE(report.stuck || report.parts > 1);
      EXPECT_EQ(report.bases, hard ? 1 : 0) << "step " << i << ", cap " << cap;
      hard = report.back_solves > most;
      bases += report.bases;
    }
    EXPECT_GE(bases, 1) << "1/" << rate << " s, cap " << cap;
  }
}

}  // namespace
}  // namespace sunder::solver
