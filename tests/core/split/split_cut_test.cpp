// SPDX-License-Identifier: Apache-2.0
// What a blade opens where cracks split: against a body that is made anew with those faces open,
// and as a crack like any other afterwards.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/frame/run_state.hpp"
#include "cut_board.hpp"
#include "fracture/stress_intensity.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

double volume_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    const auto& x = mesh.nodes;
    sum += (x[b] - x[a]).cross(x[c] - x[a]).dot(x[d] - x[a]) / 6;
  }
  return sum;
}

class SplitCut : public ::testing::TestWithParam<CutCase> {};

INSTANTIATE_TEST_SUITE_P(
    All, SplitCut,
    ::testing::Values(CutCase{{}, Route::inverse, false}, CutCase{{}, Route::factor, true},
                      CutCase{MaterialLaw::corotated, Route::factor, false},
                      CutCase{MaterialLaw::corotated, Route::inverse, true},
                      CutCase{MaterialLaw::neo_hookean, Route::factor, true},
                      CutCase{MaterialLaw::neo_hookean, Route::inverse, false}),
    name_of);

TEST_P(SplitCut, OfHalfABoardIsTheMeshWithThoseFacesOpen) {
  CutRun run(GetParam());
  Simulation& s = run.simulation;
  s.step();
  const int before = s.backend().node_count();
  const int opened = s.cut(through({-1, 4.1}, {5.2, 4.3}));
  EXPECT_GT(opened, 25);
  EXPECT_EQ(s.crack_faces().size(), static_cast<std::size_t>(opened));
  EXPECT_GT(s.backend().node_count(), before + 10);
  expect_as_fresh(run, GetParam());  // at once, under the same load
  s.step();
  expect_as_fresh(run, GetParam());
  // Nothing is gone, and one row says what has happened.
  EXPECT_NEAR(volume_of(s.mesh()), volume_of(run.problem->mesh()), 1e-12 * volume_of(s.mesh()));
  EXPECT_EQ(std::ranges::count(s.backend().destroyed(), 1), 0);
  ASSERT_EQ(s.destroyed().size(), 1U);
  const DestroyedElement& row = s.destroyed()[0];
  EXPECT_TRUE(row.lives);
  EXPECT_EQ(row.cause, Cause::script);
  EXPECT_EQ(row.element, kNone);
  EXPECT_EQ(row.crack, 0);
  // A crack from the side x = 0 whose tip is where the blade came to rest.
  ASSERT_EQ(s.cracks().size(), 1U);
  const Crack& crack = s.cracks()[0];
  EXPECT_EQ(crack.kind, CrackKind::edge);
  ASSERT_EQ(crack.tips.size(), 1U);
  EXPECT_FALSE(crack.tips[0].ended);
  const auto tips = s.tips();
  ASSERT_EQ(tips.size(), 1U);
  EXPECT_NEAR(tips[0].position.x(), 5.2, 1);
  EXPECT_NEAR(tips[0].position.y(), 4.3, 0.7);
  EXPECT_NEAR(std::abs(crack.tips[0].direction.dot(
                  fracture::Board(run.problem->mesh(), {}).plane().project(Vec3::UnitX()))),
              1, 0.05);
  EXPECT_NEAR(crack.length, 5.2, 1);
  EXPECT_GT(tips[0].k.value_or(0), 0);
}

TEST_P(SplitCut, InSeveralGoesAndBesideAnotherIsTheMeshWithAllThoseFacesOpen) {
  CutRun run(GetParam());
  Simulation& s = run.simulation;
  s.step();
  s.cut(through({-1, 4.1}, {3, 4.2}));
  s.step();
  EXPECT_FALSE(s.cracks()[0].tips[0].ended);
  EXPECT_GT(s.cut(through({3, 4.2}, {6, 3.8})), 0);
  expect_as_fresh(run, GetParam());
  EXPECT_TRUE(s.cracks()[0].tips[0].ended) << "the second cut goes on from it";
  EXPECT_GT(s.cut(through({6, 6}, {8, 5.5})), 0);
  expect_as_fresh(run, GetParam());
  ASSERT_EQ(s.cracks().size(), 3U);
  EXPECT_EQ(s.cracks()[2].kind, CrackKind::internal);
  EXPECT_EQ(s.cracks()[2].tips.size(), 2U);
  EXPECT_EQ(s.cut(through({-1, 4.1}, {3, 4.2})), 0) << "open already";
}

TEST_P(SplitCut, IsTakenBackAndDoneAgainBitForBitAndTold) {
  CutRun run(GetParam()), other(GetParam());
  Simulation& s = run.simulation;
  s.step();
  const RunState before(s);
  const Mark mark = s.save();
  s.cut(through({-1, 4.1}, {5.2, 4.3}));
  const RunState cut(s);
  s.step();
  const RunState after(s);
  EXPECT_EQ(s.undos(), 1);
  s.undo();
  expect_same_bits(before, RunState(s));
  s.redo();
  expect_same_bits(after, RunState(s));
  s.restore(mark);
  expect_same_bits(before, RunState(s));
  EXPECT_GT(s.cut(through({-1, 4.1}, {5.2, 4.3})), 0);
  expect_same_bits(cut, RunState(s));
  s.step();
  const auto bytes = s.store();
  other.simulation.load(bytes);
  expect_same_bits(RunState(s), RunState(other.simulation));
  EXPECT_EQ(other.simulation.store(), bytes);
}

TEST(SplitCutAll, BeforeTheFirstStepMayFollowAnother) {
  const CutCase own{{}, Route::factor, false};
  CutRun run(own);
  Simulation& s = run.simulation;
  ASSERT_GT(s.cut(through({-1, 4.1}, {3.2, 4.2})), 10);
  const Index nodes = s.backend().node_count();
  ASSERT_GT(nodes, run.problem->node_count());
  // Nothing has moved, the nodes that the cut has brought neither.
  ASSERT_EQ(s.mesh().nodes.size(), static_cast<std::size_t>(nodes));
  EXPECT_EQ(s.displacement(),
            std::vector<Vec3>(static_cast<std::size_t>(nodes), Vec3(Vec3::Zero())));
  ASSERT_GT(s.cut(through({11, 4.1}, {6.8, 4.2})), 10);
  s.step();
  expect_as_fresh(run, own);
}

TEST(SplitCutAll, OfAWholeBoardMakesTwoPieces) {
  for (const std::optional<MaterialLaw> law :
       {std::optional<MaterialLaw>(), std::optional(MaterialLaw::corotated)}) {
    const CutCase c{law, Route::factor, false};
    Scene scene = scene_of(c, cut_board());
    scene.fracture.alpha = FractureOptions{}.alpha;
    CutRun run(std::move(scene));
    Simulation& s = run.simulation;
    s.step();
    EXPECT_GT(s.cut(through({-1, 4.1}, {11, 4.3})), 0);
    ASSERT_EQ(s.cracks().size(), 1U);
    EXPECT_TRUE(s.cracks()[0].tips[0].ended);
    for (int i = 0; i < 3; ++i) s.step();
    for (const Vec3& u : s.displacement()) ASSERT_TRUE(u.allFinite());
    std::string told;
    for (const std::string& warning : s.warnings()) told += warning + "\n";
    EXPECT_NE(told.find("1 piece with "), std::string::npos) << told;
    EXPECT_NEAR(volume_of(s.mesh()), volume_of(run.problem->mesh()), 1e-12 * volume_of(s.mesh()));

    // By the linear law it still hangs, as after a tear, by the share alpha that ties leave.
    if (!law) continue;
    double most = 0;
    const Mesh mesh = s.mesh();
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      // What is held is free of load.
      if (mesh.nodes[n].y() > 6) most = std::max(most, s.displacement()[n].norm());
    }
    EXPECT_LE(most, 1e-6);
  }
}

/// Along a bent blade: nothing but two pieces comes of it.
TEST(SplitCutAll, OfABentBladeLeavesNoCrumbs) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::mt19937 random(seed);
    const CutCase c{{}, Route::factor, false};
    CutRun run(scene_of(c, shaken_board({10, 8, 2, 10, 8, 2}, random, 0.2)));
    Simulation& s = run.simulation;
    Blade blade;
    const std::vector<Vec2> edge{{2.1, -1}, {2.3, 4}, {5, 5.2}, {7.6, 4.1}, {8.2, -1}};
    for (std::size_t k = 1; k < edge.size(); ++k) {
      for (const auto& t : through(edge[k - 1], edge[k])) blade.push_back(t);
    }
    std::swap(blade[3][1], blade[3][2]);  // wound the other way
    EXPECT_GT(s.cut(blade), 0);
    s.step();
    std::string told;
    for (const std::string& warning : s.warnings()) told += warning + "\n";
    EXPECT_NE(told.find("1 piece with "), std::string::npos) << seed << told;
    ASSERT_EQ(s.cracks().size(), 1U);
    EXPECT_NEAR(s.cracks()[0].length, 13.9, 0.6);
  }
}

/// Where K reaches the tissue's toughness the cut tears on.
TEST(SplitCutAll, TearsOnFromItsTip) {
  CutCase c{{}, Route::factor, false};
  Scene scene = scene_of(c, cut_board());
  scene.materials["board"].toughness = 0.05;
  scene.fracture.sif = SifSource::field;
  scene.instruments[0].ramp = Ramp{0, 1};
  scene.instruments[0].action = Pull{Box{Vec3(-1, -1e-9, -9), Vec3(0.5, 1e-9, 9)}, Vec3(0, -3, 0)};
  CutRun run(std::move(scene));
  Simulation& s = run.simulation;
  s.step();
  EXPECT_EQ(s.destroyed().size(), 0U);
  s.cut(through({-1, 4.1}, {4.2, 4.3}));
  ASSERT_EQ(s.cracks().size(), 1U);
  const double length = s.cracks()[0].length;
  while (!s.done() && s.destroyed().size() < 4) s.step();
  ASSERT_GE(s.destroyed().size(), 4U);
  for (std::size_t i = 1; i < s.destroyed().size(); ++i) {
    const DestroyedElement& row = s.destroyed()[i];
    EXPECT_EQ(row.cause, Cause::sif);
    EXPECT_EQ(row.crack, 0);
    EXPECT_GE(row.sif->k, 0.05);
  }
  EXPECT_GT(s.cracks()[0].length, length + 1);
  s.undo(s.undos());
  EXPECT_TRUE(s.cracks().empty());
}

/// The lips of a cut that is pressed together are kept apart where the scene asks for it.
TEST(SplitCutAll, KeepsItsLipsApart) {
  const CutCase c{{}, Route::factor, false};
  Scene scene = scene_of(c, cut_board());
  scene.fracture.contact = true;
  std::get<Pull>(scene.instruments[0].action).force = Vec3(0, 2, 0);
  CutRun run(std::move(scene));
  Simulation& s = run.simulation;
  s.step();
  s.cut(through({-1, 4.1}, {5.2, 4.3}));
  const auto plane = fracture::Board(run.problem->mesh(), {}).plane();
  const auto& path = s.cracks()[0].path;
  const Vec3 left =
      plane.lift_direction(fracture::left_of((path.back() - path.front()).normalized()));
  const auto u = s.displacement();
  double overlap = 0;
  for (const CrackFace& face : s.crack_faces()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 apart =
          u[static_cast<std::size_t>(face.left[i])] - u[static_cast<std::size_t>(face.right[i])];
      overlap = std::max(overlap, -apart.dot(left));
    }
  }
  double most = 0;
  for (const Vec3& x : u) most = std::max(most, x.norm());
  EXPECT_GT(most, 0.01);
  EXPECT_LE(overlap, 1e-3 * most);
}

/// In motion a body that was cut before it moved moves as the mesh whose faces are open.
TEST(SplitCutAll, InMotionMovesAsTheMeshWithThoseFacesOpen) {
  const CutCase c{MaterialLaw::corotated, Route::factor, false};
  const auto moving = [&](const Mesh& mesh) {
    Scene scene = scene_of(c, mesh);
    scene.materials["board"].density = 1e-9;
    scene.dynamics = Dynamics{};
    scene.dynamics->time_step = 1e-4;
    return scene;
  };
  CutRun run(moving(cut_board()));
  EXPECT_GT(run.simulation.cut(through({-1, 4.1}, {5.2, 4.3})), 0);
  CutRun fresh(moving(run.simulation.mesh()));
  const std::vector<std::uint8_t> none(run.problem->mesh().tets.size(), 0);
  for (int i = 0; i < 5; ++i) {
    run.simulation.step();
    // After an event three steps are by backward Euler, at the start of a run one.
    if (i == 1 || i == 2) fresh.simulation.set_velocity(fresh.simulation.velocity());
    fresh.simulation.step();
    EXPECT_LE(displacement_error(fresh.problem->mesh(), none, flat(run.simulation.displacement()),
                                 flat(fresh.simulation.displacement())),
              1e-6);
  }
  EXPECT_GT(run.simulation.backend().motion().kinetic, 0);
}

void refused(Simulation& s, const Blade& blade, const std::string& why) {
  const RunState before(s);
  const auto bytes = s.store();
  try {
    s.cut(blade);
    ADD_FAILURE() << why;
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
  expect_same_bits(before, RunState(s));
  EXPECT_EQ(s.store(), bytes);
}

// Beside cuts that were made before, one face that lies flat may be all that a blade opens.
TEST(SplitCutAll, ByABladeThatStandsIsNeverSaidToLie) {
  std::mt19937 random(3);
  const auto part = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  CutRun run(CutCase{{}, Route::factor, false});
  Simulation& s = run.simulation;
  int cuts = 0;
  for (int i = 0; i < 400 && s.crack_faces().size() < 300; ++i) {
    const Vec2 from{5 + 4 * part(), 4 + 3 * part()}, way{0.7 * part(), 0.7 * part()};
    EXPECT_NO_THROW(cuts += s.cut(through(from, from + way)) > 0) << i;
  }
  EXPECT_GT(cuts, 30);
}

TEST(SplitCutAll, RefusesABladeThatCannotCut) {
  const CutCase c{{}, Route::factor, false};
  Scene scene = scene_of(c, cut_board());
  scene.fracture.max_new_nodes = 20;
  CutRun run(std::move(scene));
  Simulation& s = run.simulation;
  s.step();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused(s, {{Vec3(nan, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}}, "must be finite");
  refused(s, through({-1, 4.1}, {9, 4.3}), "fracture.max_new_nodes");
  const Vec3 p(-1, -1, 1.05), q(11, -1, 1.05), r(-1, 5, 1.05), t(11, 5, 1.05);
  refused(s, {{p, q, r}, {q, t, r}}, "lies along the board's plane");
  EXPECT_EQ(s.cut({}), 0);
  EXPECT_EQ(s.cut(through({-3, 4}, {-2, 4})), 0) << "beside the board";
  EXPECT_EQ(s.cut(Blade{{p, p, p}}), 0) << "without an area";
  EXPECT_EQ(s.undos(), 0);
  EXPECT_GT(s.cut(through({-1, 4.1}, {2.2, 4.3})), 0);
}

}  // namespace
}  // namespace sunder::test
