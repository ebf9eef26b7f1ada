// SPDX-License-Identifier: Apache-2.0
// Whole runs of model B by cracks that split.
#include <set>
#include <string>

#include "cpu_reference/cpu_reference.hpp"
#include "split_bodies.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/notch_board.hpp"

namespace sunder {
namespace {

struct Torn {
  explicit Torn(Scene scene)
      : problem(std::make_shared<const Problem>(std::move(scene))),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {}

  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

Scene split(Scene scene) {
  scene.fracture.crack = CrackWay::split;
  scene.fracture.sif = SifSource::field;
  return scene;
}

/// A plate held at its upper edge and pulled at a corner, without a notch; a stiff frame, which
/// nothing breaks, where `in_frame` says.
Scene pulled_plate(bool (*in_frame)(const Vec3&)) {
  Scene scene = split(test::board_scene(
      test::structured_board({12, 12, 2, 12, 12, 2},
                             [=](const Vec3& x) { return in_frame(x) ? "frame" : "board"; }),
      FractureModel::b));
  scene.materials["board"] = {5, 0.3, 1};
  scene.materials["frame"] = {50, 0.3, std::nullopt};
  Instrument pull{"pull", Pull{Box{Vec3(-1, -1e-9, -9), Vec3(0.5, 1e-9, 9)}, Vec3(0, -14, 0)}, {}};
  pull.ramp = Ramp{0, 1};
  scene.instruments = {pull};
  scene.steps = 20;
  scene.fracture.max_events = 1;
  return scene;
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    const auto& x = mesh.nodes;
    sum += (x[b] - x[a]).cross(x[c] - x[a]).dot(x[d] - x[a]) / 6;
  }
  return sum;
}

TEST(SplitRun, TheNotchedBoardTearsThroughWithoutLosingVolume) {
  Scene scene = split(test::notch_board(FractureModel::b));
  scene.fracture.max_events = 3;
  Torn run(std::move(scene));
  const int notch = static_cast<int>(run.problem->crack_elements()[0].size());
  int events = 0;
  const auto through = [&] {
    const auto& cracks = run.simulation.cracks();
    return !cracks.empty() && cracks[0].tips[0].ended;
  };
  while (!through()) {
    ASSERT_FALSE(run.simulation.done());
    const StepReport report = run.simulation.step();
    events += report.events;
    EXPECT_LE(report.error, 1e-8) << report.step;
    EXPECT_FALSE(report.polished) << report.step;
    EXPECT_EQ(report.destroyed, notch);
  }
  const Simulation& torn = run.simulation;
  const Mesh mesh = torn.mesh();
  EXPECT_EQ(mesh.node_count(), torn.backend().node_count());
  EXPECT_EQ(torn.displacement().size(), mesh.nodes.size());
  EXPECT_NEAR(volume(mesh), volume(run.problem->mesh()), 1e-9 * volume(mesh));
  // One crack, from the notch to the other side: rows without an element, one per event.
  ASSERT_EQ(torn.cracks().size(), 1U);
  EXPECT_TRUE(torn.cracks()[0].tips[0].ended);
  EXPECT_LT(torn.cracks()[0].tips[0].position.x(), 2);
  int rows = 0;
  for (const DestroyedElement& row : torn.destroyed()) {
    if (!row.lives) continue;
    ++rows;
    EXPECT_EQ(row.element, kNone);
    EXPECT_EQ(row.cause, Cause::sif);
    EXPECT_EQ(row.crack, 0);
  }
  EXPECT_EQ(rows, events - 1);  // the first event is the notch itself
  // The lower part has come off; nothing else has.
  std::string told;
  for (const std::string& warning : run.simulation.warnings()) told += warning + "\n";
  EXPECT_NE(told.find("1 piece with "), std::string::npos) << told;
}

/// What one opens lies where the other has it too, lip by lip.
TEST(SplitRun, BothLipsOfAFaceLieAtTheSamePlaceOfTheMesh) {
  Scene scene = split(test::notch_board(FractureModel::b));
  scene.fracture.max_events = 3;
  scene.steps = 15;
  scene.instruments[0].ramp = Ramp{0, 0.75};
  Torn run(std::move(scene));
  while (!run.simulation.done()) run.simulation.step();
  const Mesh mesh = run.simulation.mesh();
  const auto faces = run.simulation.crack_faces();
  ASSERT_FALSE(faces.empty());
  int gaping = 0;
  for (const CrackFace& face : faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(mesh.nodes[face.left[i]], mesh.nodes[face.right[i]]);
      gaping += face.left[i] != face.right[i];
    }
  }
  EXPECT_GT(gaping, 0);
}

/// A plate without a notch: strength opens a surface through the thickness where it is reached, and
/// takes no element.
TEST(SplitRun, ABirthTakesNoElement) {
  Torn run(pulled_plate([](const Vec3& x) { return x.y() < 2 || x.y() > 10; }));
  while (!run.simulation.done() && run.simulation.cracks().empty()) run.simulation.step();
  ASSERT_EQ(run.simulation.cracks().size(), 1U);
  const DestroyedElement& row = run.simulation.destroyed().front();
  EXPECT_EQ(row.cause, Cause::mss);
  EXPECT_TRUE(row.lives);
  ASSERT_NE(row.element, kNone);
  EXPECT_GE(*row.ratio, 1);
  EXPECT_EQ(run.simulation.backend().destroyed()[static_cast<std::size_t>(row.element)], 0);
  // Through the thickness: nodes on both faces and between have parted.
  std::set<double> depths;
  const Mesh mesh = run.simulation.mesh();
  for (Index n = run.problem->node_count(); n < mesh.node_count(); ++n)
    depths.insert(mesh.nodes[n].z());
  EXPECT_EQ(depths, (std::set<double>{0, 1, 2}));
}

/// A weak layer at the held edge tears: elements there have corners at new nodes, and the forces of
/// what still hangs on the support go by these.
TEST(SplitRun, TheSupportHoldsWhatIsPulledWhereElementsHaveParted) {
  Torn run(pulled_plate([](const Vec3& x) { return x.y() <= 10; }));
  const auto parted_at_support = [&] {
    const Mesh mesh = run.simulation.mesh();
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
      const auto& tet = run.problem->mesh().tets[e];
      const bool held = std::any_of(tet.begin(), tet.end(),
                                    [&](Index n) { return run.problem->dof(n, 1) == kNone; });
      if (held && mesh.tets[e] != tet) return true;
    }
    return false;
  };
  while (!parted_at_support()) {
    ASSERT_FALSE(run.simulation.done());
    run.simulation.step();
  }
  const Vec3 pulled = run.simulation.reactions()[0];
  EXPECT_LE((run.simulation.support_reaction() + pulled).norm(), 1e-6 * pulled.norm());
}

TEST(SplitRun, NodesThatAreSpentLetTipsRest) {
  Scene scene = split(test::notch_board(FractureModel::b));
  scene.fracture.max_new_nodes = 10;
  Torn run(std::move(scene));
  while (!run.simulation.done()) run.simulation.step();
  EXPECT_GT(run.simulation.backend().node_count(), run.problem->node_count());
  EXPECT_LE(run.simulation.backend().node_count(), run.problem->node_count() + 10);
  EXPECT_FALSE(run.simulation.cracks()[0].tips[0].ended);  // it rests
  std::string told;
  for (const std::string& warning : run.simulation.warnings()) told += warning + "\n";
  EXPECT_NE(told.find("fracture.max_new_nodes"), std::string::npos) << told;
}

/// An advance that would bring more nodes than are allowed brings none, and leaves the crack as it
/// was.
TEST(SplitRun, NoAdvancePassesTheBound) {
  for (Index most = 0; most < 24; ++most) {
    const Problem problem(
        test::board_scene(test::structured_board({10, 10, 2, 10, 10, 2}), FractureModel::b));
    test::EdgeSplit board(problem);
    board.body.allow(problem.node_count() + most);
    auto step = board.begin(0);
    if (!step.moved()) {
      EXPECT_TRUE(step.spent) << most;
      EXPECT_EQ(board.body.node_count(), problem.node_count());
      continue;
    }
    while (step.moved() && !step.spent) {
      const auto path = board.crack.path;
      const auto faces = board.split.faces.size();
      step = board.advance(0);
      EXPECT_LE(board.body.node_count(), problem.node_count() + most);
      if (step.moved()) continue;
      EXPECT_TRUE(step.spent) << most;
      EXPECT_FALSE(step.through) << most;
      EXPECT_EQ(board.crack.path, path);
      EXPECT_EQ(board.split.faces.size(), faces);
    }
    EXPECT_TRUE(step.spent) << most;
  }
}

TEST(SplitRun, WhatCannotSplitSaysWhatCan) {
  const auto refused = [](Scene scene) -> std::string {
    try {
      const auto problem = std::make_shared<const Problem>(std::move(scene));
      static_cast<void>(cpu_reference::create(problem, needs_of(*problem)));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  for (const Route route : {Route::condensed, Route::cg}) {
    Scene scene = split(test::notch_board(FractureModel::b));
    scene.solver.route = route;
    EXPECT_NE(refused(scene).find("use route inverse or factor"), std::string::npos);
  }
  Scene eager = split(test::notch_board(FractureModel::b));
  eager.solver.update = Update::eager;
  EXPECT_NE(refused(eager).find("use update deferred or auto"), std::string::npos);
  Scene law = split(test::notch_board(FractureModel::b));
  for (auto& [name, material] : law.materials) material.law = MaterialLaw::corotated;
  EXPECT_EQ(refused(law), "");
  law.solver.route = Route::condensed;
  EXPECT_NE(refused(law).find("use route factor or auto"), std::string::npos);
  EXPECT_NE(refused(split(test::notch_board(FractureModel::a))).find("model \"B\""),
            std::string::npos);
}

/// A notched plate in tension whose tissue has a toughness: the crack starts where K reaches it,
/// whatever the mesh, and each row says how far over it K was.
TEST(SplitRun, ToughnessStartsACrackAtALoadThatDoesNotKnowTheMesh) {
  constexpr double kToughness = 2;
  std::vector<double> loads;
  for (const Index across : {20, 30, 40}) {
    const double cell = 20.0 / across;
    const Mesh mesh = test::structured_board({across, 2 * across, 1, 20, 40, cell});
    Scene scene = test::board_scene(mesh, FractureModel::b);
    scene.materials["board"] = {5, 0.3, std::nullopt};
    scene.materials["board"].toughness = kToughness;
    scene.supports.clear();
    scene.supports.push_back({Box{Vec3(-9, -9, -9), Vec3(99, 99, 99)}, Axes{4}});
    scene.supports.push_back({Box{Vec3(-9, 39.99, -9), Vec3(99, 99, 99)}, Axes{3}});
    Instrument pull{"pull", Pull{Box{Vec3(-9, -9, -9), Vec3(99, 0.01, 99)}, Vec3(0, -1, 0)}, {}};
    pull.ramp = Ramp{0, 1};
    scene.instruments = {pull};
    PresetCrack notch;  // a row of cells, 6 mm deep
    notch.elements = Box{Vec3(-1, 20 - cell, -9), Vec3(6, 20, 9)};
    notch.mouth = Vec3(0, 20 - cell / 2, 0);
    notch.tips = {Vec3(6, 20 - cell / 2, 0)};
    scene.cracks = {notch};
    scene.steps = 1;
    scene.instruments[0].ramp.reset();
    // K is linear in the force: what it is at 1 N says when it reaches the toughness.
    Torn still(split(scene));
    still.simulation.step();
    const auto tips = still.simulation.tips();
    ASSERT_EQ(tips.size(), 1U);
    ASSERT_TRUE(tips[0].toughness && tips[0].k);
    EXPECT_DOUBLE_EQ(*tips[0].toughness, kToughness);
    const double load = kToughness / *tips[0].k;
    loads.push_back(load / cell);  // per thickness
    for (const double share : {0.99, 1.01}) {
      Scene at = scene;
      std::get<Pull>(at.instruments[0].action).force = Vec3(0, -share * load, 0);
      at.fracture.max_events = 1;
      Torn run(split(std::move(at)));
      run.simulation.step();
      const auto& rows = run.simulation.destroyed();
      const bool grown = rows.back().lives;
      EXPECT_EQ(grown, share > 1);
      if (!grown) continue;
      EXPECT_NEAR(*rows.back().ratio, share, 1e-6);
      EXPECT_DOUBLE_EQ(*rows.back().sif->toughness, kToughness);
      EXPECT_GT(rows.back().sif->advance, 0);
    }
  }
  for (double load : loads) EXPECT_NEAR(load, loads.back(), 0.02 * loads.back());
}

}  // namespace
}  // namespace sunder
