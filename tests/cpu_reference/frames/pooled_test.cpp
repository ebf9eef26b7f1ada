// SPDX-License-Identifier: Apache-2.0
// Pooled volume by every route of the CPU: frames along fractures against a fresh factor, what they
// refuse, states that a body goes back to.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "body/assembly.hpp"
#include "body/damaged_body.hpp"
#include "body/pieces.hpp"
#include "body/pools.hpp"
#include "body/stiffness_factor.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

Scene pooled_board(Route route, double nu, Update update = Update::automatic) {
  Scene scene = pulled_board();
  set_poisson(scene, nu);
  scene.solver.route = route;
  scene.solver.update = update;
  scene.live = true;
  for (auto& [name, material] : scene.materials) material.volume = MaterialVolume::pooled;
  return scene;
}

std::vector<double> pull_at_corner(const Problem& problem) {
  std::vector<double> force(problem.dofs().size(), 0.0);
  for (Index n : problem.instrument_nodes()[0].nodes) {
    force[3 * static_cast<std::size_t>(n) + 1] = -30;
  }
  return force;
}

/// By a factor of the body, refined.
struct FreshSolution {
  FreshSolution(const fem::DamagedBody& body, std::span<const double> force) {
    const Problem& problem = body.problem();
    const linear_algebra::Factor factor = fem::factor_stiffness(body);
    Eigen::VectorXd f(problem.dof_count()), u = Eigen::VectorXd::Zero(f.size()), r = f, du;
    fem::gather(problem, force, {f.data(), static_cast<std::size_t>(f.size())});
    linear_algebra::SolveWork work;
    for (int pass = 0; pass < 3; ++pass) {
      body.apply(u, r);
      r = f - r;
      factor.solve(r, du, work);
      u += du;
    }
    displacement.resize(problem.dofs().size());
    fem::scatter(problem, {u.data(), static_cast<std::size_t>(u.size())}, displacement);
    const fem::StressField field(problem, body.scale(), displacement);
    for (Index e = 0; e < problem.tet_count(); ++e) {
      stress.push_back(body.scale()[static_cast<std::size_t>(e)] * field.of(e));
    }
  }
  std::vector<double> displacement;
  std::vector<Voigt> stress;
};

struct PooledWay {
  Route route;
  Update update = Update::automatic;
};

void follow_pooled(PooledWay way, double nu, bool crack, double tolerance, double contrast = 100) {
  Scene scene = pooled_board(way.route, nu, way.update);
  set_contrast(scene, contrast);
  const Body body(std::move(scene));
  fem::DamagedBody record(body.problem);
  const std::vector<Index> sequence =
      crack ? crack_sequence(*body.problem, 200, 12) : scattered_sequence(*body.problem, 200);
  const std::vector<double> force = pull_at_corner(*body.problem);
  std::size_t done = 0;
  for (std::size_t k :
       {std::size_t{0}, std::size_t{1}, std::size_t{10}, std::size_t{50}, std::size_t{200}}) {
    while (done < k) {
      const std::size_t size = done < 10 ? 1 : 5;
      const auto event = std::span(sequence).subspan(done, size);
      body.backend->destroy(event);
      record.destroy(event);
      done += size;
      body.load(force);
      body.backend->solve();
    }
    body.load(force);
    body.backend->solve();
    const FreshSolution right(record, force);
    std::vector<std::uint8_t> ignored(record.destroyed().begin(), record.destroyed().end());
    for (const auto& piece : find_loose_parts(*body.problem, ignored).pieces) {
      for (Index e : piece) ignored[static_cast<std::size_t>(e)] = 1;
    }
    const double of_u =
        displacement_error(body.problem->mesh(), ignored, body.displacement(), right.displacement);
    const double of_stress = stress_error(ignored, body.stress(), right.stress);
    SCOPED_TRACE("nu " + std::to_string(nu) + " after " + std::to_string(k));
    EXPECT_LE(of_u, tolerance);
    EXPECT_LE(of_stress, tolerance);
  }
}

TEST(Pooled, FactorAgreesWithAFreshFactorAlongACrack) {
  follow_pooled({Route::factor}, 0.4, true, kCrackTolerance);
  follow_pooled({Route::factor}, 0.499, true, kCrackTolerance);
}

TEST(Pooled, InverseAgreesWithAFreshFactorAlongACrack) {
  follow_pooled({Route::inverse}, 0.499, true, kCrackTolerance);
}

TEST(Pooled, ScatteredFracturesAgreeWithAFreshFactor) {
  follow_pooled({Route::factor}, 0.499, false, kCrackTolerance);
}

TEST(Pooled, FramesTenThousandTimesStifferCostNoDigits) {
  follow_pooled({Route::inverse}, 0.4, true, kCrackTolerance, 1e4);
}

/// Past what the table of accuracy asks for: contrast 100 beside nu .4999.
TEST(Pooled, TissueNextToIncompressibleAgreesToo) {
  follow_pooled({Route::factor}, 0.4999, true, kCrackTolerance * 10);
}

/// Routes that are measured by: all at once.
TEST(Pooled, ConjugateGradientsAndTheEagerUpdateAgree) {
  for (PooledWay way : {PooledWay{Route::cg}, PooledWay{Route::inverse, Update::eager}}) {
    const Body body(pooled_board(way.route, 0.499, way.update));
    fem::DamagedBody record(body.problem);
    const std::vector<Index> crack = crack_sequence(*body.problem, 20, 12);
    for (std::size_t k : {std::size_t{0}, std::size_t{10}}) {
      const auto event = std::span(crack).subspan(k, 10);
      body.backend->destroy(event);
      record.destroy(event);
    }
    const std::vector<double> force = pull_at_corner(*body.problem);
    body.load(force);
    body.backend->solve();
    const FreshSolution right(record, force);
    EXPECT_LE(displacement_error(body.problem->mesh(), record.destroyed(), body.displacement(),
                                 right.displacement),
              kCrackTolerance);
    EXPECT_LE(stress_error(record.destroyed(), body.stress(), right.stress), kCrackTolerance);
  }
}

TEST(Pooled, RouteCondensedIsRefusedWithThoseThatCan) {
  try {
    const Body body(pooled_board(Route::condensed, 0.499));
    FAIL() << "it was not refused";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("use route factor, inverse or cg"), std::string::npos)
        << error.what();
  }
}

/// A run that tears: the supports bear what pulls, and undo goes back to the same bits.
TEST(Pooled, ATearingRunIsInEquilibriumAndGoesBack) {
  Scene scene = pooled_board(Route::automatic, 0.499);
  std::get<Pull>(scene.instruments[0].action).force = Vec3(0, -300, 0);
  scene.fracture.model = FractureModel::a;
  scene.fracture.max_events = 4;
  scene.steps = 6;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  simulation.keep_history([problem] { return cpu_reference::create(problem, needs_of(*problem)); });
  for (int step = 0; step < 2; ++step) simulation.step();
  const Index gone = crack_sequence(*problem, 12, 12).back();
  const std::vector<Vec3> before = simulation.displacement();
  simulation.remove(std::vector<Index>{gone});
  simulation.step();
  ASSERT_GT(simulation.destroyed().size(), 1U);
  const Vec3 sum = simulation.support_reaction() + simulation.reactions()[0];
  EXPECT_LE(sum.norm(), 1e-6 * simulation.reactions()[0].norm());
  simulation.undo(2);  // the step that tore and the removal
  EXPECT_EQ(simulation.displacement(), before);
}

}  // namespace
}  // namespace sunder::test
