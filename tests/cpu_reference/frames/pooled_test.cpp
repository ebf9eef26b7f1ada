// SPDX-License-Identifier: Apache-2.0
// Pooled volume by every route of the CPU: frames along fractures against a fresh factor, what they
// refuse, states that a body goes back to.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "body/pools.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/pooled_body.hpp"
#include "support/sequences.hpp"

namespace sunder::test {
namespace {

Scene routed_board(Route route, double nu, Update update = Update::automatic) {
  Scene scene = pooled_board(nu);
  scene.solver.route = route;
  scene.solver.update = update;
  scene.live = true;
  return scene;
}

struct PooledWay {
  Route route;
  Update update = Update::automatic;
};

void follow_pooled(PooledWay way, double nu, bool crack, double tolerance, double contrast = 100) {
  Scene scene = routed_board(way.route, nu, way.update);
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
    const std::vector<std::uint8_t> ignored = not_attached(record);
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
    const Body body(routed_board(way.route, 0.499, way.update));
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
    const Body body(routed_board(Route::condensed, 0.499));
    FAIL() << "it was not refused";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("use route factor, inverse or cg"), std::string::npos)
        << error.what();
  }
}

/// A run that tears: the supports bear what pulls, and undo goes back to the same bits.
void tear_and_go_back(MaterialLaw law, Route route, double nu, double force, double of_yield) {
  Scene scene = routed_board(route, nu);
  for (auto& [name, material] : scene.materials) {
    material.law = law;
    if (material.yield) *material.yield *= of_yield;
  }
  std::get<Pull>(scene.instruments[0].action).force = Vec3(0, -force, 0);
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

TEST(Pooled, ATearingRunIsInEquilibriumAndGoesBack) {
  tear_and_go_back(MaterialLaw::linear, Route::automatic, 0.499, 300, 1);
}

TEST(Pooled, ATearingRunOfAFiniteLawIsInEquilibriumAndGoesBack) {
  tear_and_go_back(MaterialLaw::neo_hookean, Route::factor, 0.49, 18, 0.08);
  tear_and_go_back(MaterialLaw::neo_hookean, Route::inverse, 0.49, 18, 0.08);
}

/// A run in which a piece comes off through patches: what is left is as if the piece had gone too,
/// the supports bear what pulls at it, and undo goes back to the same bits.
void cut_a_piece_off(PooledWay way) {
  const auto problem = std::make_shared<const Problem>(routed_board(way.route, 0.4, way.update));
  const CutAcross cut(*problem, 33);
  ASSERT_GT(cut.shared, 1);
  const std::size_t half = cut.elements.size() / 2;
  const Body body(routed_board(way.route, 0.4, way.update)), rest(routed_board(way.route, 0.4));
  fem::DamagedBody record(problem);
  record.destroy(cut.elements);
  const std::vector<double> force = inflate_beside(cut, record);
  std::vector<Index> piece;
  const std::vector<std::uint8_t> ignored = not_attached(record);
  for (Index e = 0; e < problem->tet_count(); ++e) {
    if (ignored[static_cast<std::size_t>(e)] && !record.destroyed()[e]) piece.push_back(e);
  }
  for (const Body* of : {&body, &rest}) {
    of->load(force);
    of->backend->solve();
    of->backend->destroy(std::span(cut.elements).first(half));
    of->backend->solve();
    of->backend->destroy(std::span(cut.elements).subspan(half));
    if (of == &rest) of->backend->destroy(piece);
    of->load(force);
    of->backend->solve();
  }
  const FreshSolution right(record, force);
  EXPECT_LE(displacement_error(problem->mesh(), ignored, body.displacement(), right.displacement),
            kCrackTolerance);
  EXPECT_LE(stress_error(ignored, body.stress(), right.stress), kCrackTolerance);
  EXPECT_LE(displacement_error(problem->mesh(), ignored, body.displacement(), rest.displacement()),
            100 * problem->scene().fracture.alpha);
  // And so it stays over the new bases that later events ask for.
  if (way.route == Route::cg || way.update == Update::eager) return;
  std::vector<Index> later;
  for (Index e : scattered_sequence(*problem, 900)) {
    if (!ignored[static_cast<std::size_t>(e)]) later.push_back(e);
  }
  int bases = 0;
  for (std::size_t i = 0; i < later.size() && bases < 2; ++i) {
    const auto event = std::span(later).subspan(i, 1);
    body.backend->destroy(event);
    record.destroy(event);
    body.backend->solve();
    bases += static_cast<int>(body.backend->take_new_bases().count);
  }
  EXPECT_EQ(bases, 2);
  body.load(force);
  body.backend->solve();
  const FreshSolution torn(record, force);
  const std::vector<std::uint8_t> gone = not_attached(record);
  EXPECT_LE(displacement_error(problem->mesh(), gone, body.displacement(), torn.displacement),
            kCrackTolerance);
  EXPECT_LE(stress_error(gone, body.stress(), torn.stress), kCrackTolerance);
}

TEST(Pooled, APieceThatComesOffSharesNoPressure) {
  for (PooledWay way : {PooledWay{Route::factor}, PooledWay{Route::inverse}, PooledWay{Route::cg},
                        PooledWay{Route::inverse, Update::eager}}) {
    SCOPED_TRACE(static_cast<int>(way.route));
    cut_a_piece_off(way);
  }
}

bool meet(const Problem& problem, Index a, Index b) {
  const auto &one = problem.mesh().tets[static_cast<std::size_t>(a)],
             &two = problem.mesh().tets[static_cast<std::size_t>(b)];
  return std::ranges::find_first_of(one, two) != one.end();
}

/// All that meets an element whose patch reaches the supports with another that does not meet it.
std::vector<Index> round_an_element_below_the_supports(const Problem& problem) {
  const auto at_support = [&](Index e) {
    return std::ranges::any_of(problem.mesh().tets[static_cast<std::size_t>(e)],
                               [&](Index n) { return problem.dof(n, 1) == kNone; });
  };
  std::vector<Index> found;
  for (Index e = 0; e < problem.tet_count() && found.empty(); ++e) {
    const auto patch = problem.pools()->elements(problem.pools()->of(e));
    if (std::ranges::none_of(
            patch, [&](Index other) { return at_support(other) && !meet(problem, e, other); })) {
      continue;
    }
    for (Index other = 0; other < problem.tet_count(); ++other) {
      if (other != e && meet(problem, e, other)) found.push_back(other);
    }
  }
  return found;
}

/// The supports bear what pulls at what is left, and undo goes back to the same bits.
TEST(Pooled, ARunWhosePieceComesOffIsInEquilibriumAndGoesBack) {
  Scene scene = routed_board(Route::factor, 0.499);
  std::get<Pull>(scene.instruments[0].action).nodes = Box{Vec3(0, 47.2, -1), Vec3(50, 49.5, 3)};
  scene.steps = 4;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  simulation.keep_history([problem] { return cpu_reference::create(problem, needs_of(*problem)); });
  const std::vector<Index> cut = round_an_element_below_the_supports(*problem);
  const std::size_t half = cut.size() / 2;
  simulation.step();
  simulation.remove(std::span(cut).first(half));
  simulation.step();
  const std::vector<Vec3> before = simulation.displacement();
  simulation.remove(std::span(cut).subspan(half));
  simulation.step();
  EXPECT_NE(simulation.backend().pools(), problem->pools());
  const Vec3 sum = simulation.support_reaction() + simulation.reactions()[0];
  EXPECT_LE(sum.norm(), 1e-6 * simulation.reactions()[0].norm());
  simulation.undo(1);
  EXPECT_EQ(simulation.displacement(), before);
}

}  // namespace
}  // namespace sunder::test
