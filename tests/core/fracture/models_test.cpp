// SPDX-License-Identifier: Apache-2.0
// Models none, A and B as the frame uses them (method.md "Model A", "Model B" 4, 10, 11).
#include <random>

#include "board_fixture.hpp"
#include "fracture/crack_birth.hpp"
#include "sunder/fracture_model.hpp"

namespace sunder {
namespace {

using fracture::Board;
using test::Driver;
using test::kSlitShape;
using test::tension;

std::vector<Index> elements_of(const Decision& d) {
  std::vector<Index> ids;
  for (const auto& row : d.elements) ids.push_back(row.element);
  return ids;
}

/// Decisions until nothing breaks; fails the test rather than hang.
int run_out(Driver& driver, int most = 200) {
  int events = 0;
  while (!driver.decide().elements.empty()) {
    if (++events > most) {
      ADD_FAILURE() << "no end after " << most << " events";
      break;
    }
  }
  return events;
}

// Scenes, results and the C interface name models by these.
TEST(FractureModels, HaveARowEach) {
  const auto rows = fracture_models();
  std::set<std::string> names;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(rows[i].model), i) << "row_of() finds rows by their place";
    EXPECT_TRUE(names.insert(rows[i].name).second) << rows[i].name;
    EXPECT_TRUE(rows[i].breaks || !rows[i].pristine) << rows[i].name;
    EXPECT_TRUE(rows[i].keeps_cracks || !rows[i].grows_cracks) << rows[i].name;
  }
  EXPECT_STREQ(row_of(FractureModel::none).name, "none");
  EXPECT_STREQ(row_of(FractureModel::a).name, "A");
  EXPECT_STREQ(row_of(FractureModel::b).name, "B");
}

TEST(ModelA, DestroysTheWorstElementFromRatioOne) {
  Driver driver(test::board_scene(test::structured_board(kSlitShape), FractureModel::a));
  driver.summary = {{17, 0.999}, {17, 0.999}};
  EXPECT_TRUE(driver.decide().elements.empty());
  driver.summary = {{17, 1.0}, {5, 1.0}};
  const Decision d = driver.decide();
  ASSERT_EQ(d.elements.size(), 1u);
  EXPECT_EQ(d.elements[0].element, 17);
  EXPECT_EQ(d.elements[0].cause, Cause::mss);
  EXPECT_EQ(d.elements[0].crack, kNone);
  EXPECT_EQ(d.elements[0].ratio, 1.0);
  EXPECT_TRUE(driver.criterion->cracks().empty());
}

TEST(ModelA, TakesPresetsOutButKeepsNoCracks) {
  Scene scene = test::edge_slit(3);
  scene.fracture.model = FractureModel::a;
  Driver driver(std::move(scene));
  EXPECT_EQ(std::count(driver.destroyed.begin(), driver.destroyed.end(), 1), 3 * 6);
  EXPECT_TRUE(driver.criterion->cracks().empty());
}

TEST(ModelNone, BreaksNothingAndKeepsPresets) {
  Scene scene = test::edge_slit(3);
  scene.fracture.model = FractureModel::none;
  Driver driver(std::move(scene));
  driver.summary = {{17, 9}, {17, 9}};
  driver.pull(tension(50, 90));
  EXPECT_TRUE(driver.decide().elements.empty());
  ASSERT_EQ(driver.criterion->cracks().size(), 1u);
  EXPECT_EQ(driver.criterion->cracks()[0].length, 3);
}

TEST(ModelB, RuptureStartsACrackAmongCandidatesOnly) {
  Driver driver(test::board_scene(test::structured_board(kSlitShape), FractureModel::b));
  const Index inner = 6 * (10 + 20 * 5);
  driver.current << 0, 1, 0, 0, 0, 0;
  driver.summary = {{3, 7.0}, {inner, 0.99}};
  EXPECT_TRUE(driver.decide().elements.empty());
  driver.summary.candidate.ratio = 1.25;
  const Decision d = driver.decide();
  ASSERT_EQ(elements_of(d), std::vector<Index>{inner});
  EXPECT_EQ(d.elements[0].cause, Cause::mss);
  EXPECT_EQ(d.elements[0].crack, 0);
  EXPECT_EQ(d.elements[0].ratio, 1.25);
  ASSERT_EQ(driver.criterion->cracks().size(), 1u);
  EXPECT_EQ(driver.criterion->cracks()[0].kind, CrackKind::internal);
}

TEST(ModelB, ExcludesWhatTouchesACrack) {
  Driver driver(test::edge_slit(5));
  driver.pull(tension(0.9, 90));
  ASSERT_FALSE(driver.decide().elements.empty());
  std::set<Index> nodes, expected;
  const Mesh& mesh = driver.problem.mesh();
  for (Index e : driver.criterion->cracks()[0].elements)
    nodes.insert(mesh.tets[e].begin(), mesh.tets[e].end());
  for (Index e = 0; e < mesh.tet_count(); ++e)
    for (Index n : mesh.tets[e])
      if (nodes.contains(n)) expected.insert(e);
  EXPECT_EQ(driver.excluded, expected);
}

TEST(ModelB, PropagationComesBeforeGeneration) {
  Driver driver(test::edge_slit(5));
  const Index inner = 6 * (15 + 20 * 2);
  driver.summary = {{inner, 50}, {inner, 50}};
  driver.pull(tension(0.9, 90));
  const Decision first = driver.decide();
  ASSERT_FALSE(first.elements.empty());
  for (const auto& row : first.elements) {
    EXPECT_EQ(row.cause, Cause::sif);
    EXPECT_EQ(row.crack, 0);
    ASSERT_TRUE(row.sif && row.ratio);
    EXPECT_GE(*row.ratio, 1);
    EXPECT_GT(row.sif->reach, 0);
  }
  driver.pull(Mat3::Zero());
  const Decision second = driver.decide();
  ASSERT_EQ(elements_of(second), std::vector<Index>{inner});
  EXPECT_EQ(second.elements[0].cause, Cause::mss);
  EXPECT_EQ(second.elements[0].crack, 1);
}

TEST(ModelB, NothingBreakableAsksForNoField) {
  Scene scene = test::edge_slit(
      5, test::structured_board(kSlitShape, [](const Vec3&) { return std::string("frame"); }));
  Driver driver(std::move(scene));
  FractureState state = driver.state();
  state.pristine_displacement = []() -> std::span<const double> {
    throw std::logic_error("the intact body was not planned");
  };
  Decision d;
  driver.criterion->decide(state, d);
  EXPECT_TRUE(d.elements.empty());
}

TEST(ModelB, TipStopsBelowItsCriticalStress) {
  Driver driver(test::edge_slit(5));
  driver.pull(tension(0.05, 90));
  EXPECT_TRUE(driver.decide().elements.empty());
  EXPECT_FALSE(driver.criterion->cracks()[0].tips[0].ended);
}

TEST(ModelB, AdvancesItsTipAndPath) {
  Driver driver(test::edge_slit(5));
  driver.pull(tension(0.9, 90));
  const Decision d = driver.decide();
  const Crack& crack = driver.criterion->cracks()[0];
  const double advance = crack.tips[0].position.x() - 5;
  EXPECT_GT(advance, 0);
  EXPECT_LE(advance, 1.5 * driver.board.h());
  EXPECT_NEAR(crack.length, 5 + advance, 1e-14);
  ASSERT_EQ(crack.path.size(), 3u);
  EXPECT_EQ(crack.path.back(), crack.tips[0].position);
  EXPECT_EQ(crack.elements.size(), 5 * 6 + d.elements.size());
  for (Index e : elements_of(d))
    for (Index n : driver.problem.mesh().tets[e])
      EXPECT_EQ(crack.side.at(n), driver.board.node(n).y() > 5.5 ? 1 : -1);
}

TEST(ModelB, TwoCracksGrowInOneEvent) {
  Scene scene = test::edge_slit(4);
  scene.cracks.push_back(
      {test::row_elements(kSlitShape, 5, 16, 20), Vec3(20, 5.5, 1), {Vec3(16, 5.5, 1)}});
  Driver driver(std::move(scene));
  driver.pull(tension(0.9, 90));
  const Decision d = driver.decide();
  std::set<int> grown;
  int last = 0;
  for (const auto& row : d.elements) {
    grown.insert(row.crack);
    EXPECT_GE(row.crack, last) << "by crack id";
    last = row.crack;
  }
  EXPECT_EQ(grown, (std::set<int>{0, 1}));
  const auto& cracks = driver.criterion->cracks();
  EXPECT_GT(cracks[0].tips[0].position.x(), 4);
  EXPECT_LT(cracks[1].tips[0].position.x(), 16);
}

TEST(ModelB, TipsThatMeetShareNoElement) {
  Scene scene = test::edge_slit(9);
  scene.cracks.push_back(
      {test::row_elements(kSlitShape, 5, 10, 20), Vec3(20, 5.5, 1), {Vec3(10, 5.5, 1)}});
  Driver driver(std::move(scene));
  driver.pull(tension(0.9, 90));
  run_out(driver);  // the driver fails on an element destroyed twice
  for (Index e : test::row_elements(kSlitShape, 5, 9, 10)) EXPECT_TRUE(driver.destroyed[e]);
}

TEST(ModelB, InternalCrackGrowsAtBothTips) {
  Driver driver(test::internal_slit(9, 11));
  driver.pull(tension(1.5, 90));
  const Decision d = driver.decide();
  std::set<int> tips;
  for (const auto& row : d.elements) tips.insert(row.sif->tip);
  EXPECT_EQ(tips, (std::set<int>{0, 1}));
  const Crack& crack = driver.criterion->cracks()[0];
  EXPECT_LT(crack.tips[0].position.x(), 9);
  EXPECT_GT(crack.tips[1].position.x(), 11);
  EXPECT_EQ(crack.path.front(), crack.tips[0].position);
  EXPECT_EQ(crack.path.back(), crack.tips[1].position);
  EXPECT_NEAR(crack.length, (crack.tips[1].position - crack.tips[0].position).norm(), 1e-13);
  for (const auto& [node, side] : crack.side)
    EXPECT_EQ(side, driver.board.node(node).y() > 5.5 ? 1 : -1) << "one sense for both tips";
}

TEST(ModelB, TipThatReachesTheOutlineHasEnded) {
  for (Index length : {4, 5, 6}) {
    Driver driver(test::edge_slit(length));
    driver.pull(tension(0.9, 90));
    const CrackTip& tip = driver.criterion->cracks()[0].tips[0];
    while (!fracture::at_outline(driver.board, tip.position)) {
      ASSERT_FALSE(tip.ended);
      ASSERT_FALSE(driver.decide().elements.empty());
    }
    EXPECT_TRUE(tip.ended) << "with its last advance";
    EXPECT_TRUE(driver.decide().elements.empty());
  }
}

TEST(ModelB, PressureDrivesItsOwnCrackOnly) {
  Scene scene = test::edge_slit(4);
  scene.cracks.push_back(
      {test::row_elements(kSlitShape, 5, 16, 20), Vec3(20, 5.5, 1), {Vec3(16, 5.5, 1)}});
  const Press up{Vec3(17, 6, 1), CrackSide::upper, 1, Vec3(0, 12, 0)};
  const Press down{Vec3(17, 5, 1), CrackSide::lower, 1, Vec3(0, -12, 0)};
  scene.instruments = {{"up", up, std::nullopt}, {"down", down, std::nullopt}};
  Driver driver(std::move(scene));
  const PressedNodes above = driver.criterion->pressed_nodes(up, driver.destroyed);
  const PressedNodes below = driver.criterion->pressed_nodes(down, driver.destroyed);
  driver.presses = {{0, &up, up.force, above.list()}, {1, &down, down.force, below.list()}};
  const Decision d = driver.decide();
  ASSERT_FALSE(d.elements.empty());
  for (const auto& row : d.elements) EXPECT_EQ(row.crack, 1);
}

TEST(ModelB, UnbreakableElementsHoldTheTip) {
  Scene scene = test::edge_slit(5, test::structured_board(kSlitShape, [](const Vec3& x) {
                                  return std::string(x.x() < 8 ? "board" : "frame");
                                }));
  Driver driver(std::move(scene));
  driver.pull(tension(0.9, 90));
  run_out(driver);
  for (Index e = 0; e < driver.problem.tet_count(); ++e) {
    if (driver.problem.breakable(e)) continue;
    EXPECT_FALSE(driver.destroyed[e]);
  }
  EXPECT_LE(driver.criterion->cracks()[0].tips[0].position.x(), 8 + driver.board.h());
  EXPECT_FALSE(driver.criterion->cracks()[0].tips[0].ended) << "live elements are left in its band";
}

/// Component of live elements that share nodes, per element; kNone for destroyed ones.
std::vector<Index> live_components(const Driver& driver) {
  const Mesh& mesh = driver.problem.mesh();
  std::vector<Index> component(mesh.tets.size(), kNone);
  for (Index seed = 0; seed < mesh.tet_count(); ++seed) {
    if (driver.destroyed[seed] || component[seed] != kNone) continue;
    std::vector<Index> stack{seed};
    component[seed] = seed;
    while (!stack.empty()) {
      const Index e = stack.back();
      stack.pop_back();
      for (Index n : mesh.tets[e]) {
        for (Index f : driver.board.elements_of(n)) {
          if (driver.destroyed[f] || component[f] != kNone) continue;
          component[f] = seed;
          stack.push_back(f);
        }
      }
    }
  }
  return component;
}

/// The slit's board with its inner nodes moved at random, in the plane and across it.
Mesh jittered_board(unsigned seed) {
  Mesh mesh = test::structured_board({20, 11, 2, 20, 11, 2});
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.18, 0.18);
  for (Vec3& x : mesh.nodes) {
    const bool rim = x.x() == 0 || x.x() == 20 || x.y() == 0 || x.y() == 11;
    const Vec3 by(shift(random), shift(random), shift(random));
    if (!rim) x += Vec3(by.x(), by.y(), x.z() == 1 ? by.z() : 0);
  }
  return mesh;
}

class NoLigament : public ::testing::TestWithParam<int> {};

TEST_P(NoLigament, CrackAcrossTheBoardPartsIt) {
  const double beta = GetParam();
  for (unsigned seed : {1u, 2u, 3u}) {
    Scene scene = test::board_scene(jittered_board(seed), FractureModel::b);
    const test::BoardShape shape{20, 11, 2, 20, 11, 2};
    scene.cracks.push_back(
        {test::row_elements(shape, 5, 0, 3), Vec3(0, 5.5, 1), {Vec3(3, 5.5, 1)}});
    Driver driver(std::move(scene));
    driver.pull(tension(0.9, 90 + beta));
    EXPECT_GT(run_out(driver), 5);
    const Crack& crack = driver.criterion->cracks()[0];
    EXPECT_TRUE(crack.tips[0].ended);
    EXPECT_NEAR(crack.tips[0].position.x(), 20, driver.board.h());
    // A ligament would leave the top edge and the bottom edge in one live component.
    const auto component = live_components(driver);
    std::set<Index> top, bottom;
    for (Index e = 0; e < driver.problem.tet_count(); ++e) {
      if (component[e] == kNone) continue;
      for (Index n : driver.problem.mesh().tets[e]) {
        const double y = driver.problem.mesh().nodes[n].y();
        if (y == 11) top.insert(component[e]);
        if (y == 0) bottom.insert(component[e]);
      }
    }
    ASSERT_FALSE(top.empty() || bottom.empty());
    for (Index c : top) EXPECT_FALSE(bottom.contains(c)) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Angles, NoLigament, ::testing::Values(0, 8, -8, 15, -15));

TEST(ModelB, LabelsOfEarlierStepsAreKept) {
  Driver driver(test::edge_slit(4, test::structured_board(kSlitShape)));
  driver.pull(tension(0.9, 90));
  std::pmr::map<Index, std::int8_t> before;
  for (int event = 0; event < 6; ++event) {
    ASSERT_FALSE(driver.decide().elements.empty());
    driver.pull(tension(0.9, event % 2 ? 70 : 110));  // a zigzag
    const auto& now = driver.criterion->cracks()[0].side;
    const Vec2 tip = driver.criterion->cracks()[0].path.end()[-2];
    for (const auto& [node, side] : before) {
      if ((driver.board.node(node) - tip).norm() > driver.board.h()) continue;
      EXPECT_EQ(now.at(node), side) << "node " << node << ", event " << event;
    }
    before = now;
  }
}

TEST(ModelB, RunsAreRepeatable) {
  const auto run = [] {
    Scene scene = test::edge_slit(4);
    scene.cracks.push_back({test::row_elements(kSlitShape, 2, 9, 11),
                            std::nullopt,
                            {Vec3(9, 2.5, 1), Vec3(11, 2.5, 1)}});
    Driver driver(std::move(scene));
    driver.pull(tension(0.6, 80));
    std::vector<Index> all;
    for (int i = 0; i < 30; ++i)
      for (Index e : elements_of(driver.decide())) all.push_back(e);
    return all;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace sunder
