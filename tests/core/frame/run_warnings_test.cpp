// SPDX-License-Identifier: Apache-2.0
// What a run warns of: large strain, rotation, inverted elements, pieces that came off.
#include "sunder/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "body/pieces.hpp"
#include "core/frame/strip.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

/// A strip that a grip pulls: its strain is that of the board's ends, some more at the corners.
StepReport stretched(double strain, std::vector<std::string>& warnings) {
  Scene scene = strip(1e9, 0, 2);
  scene.fracture.model = FractureModel::none;
  scene.materials["board"].poisson = 0;  // so that nothing narrows: one strain everywhere
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -8 * strain, 0), Axes{7}};
  SceneRun run(std::move(scene));
  run.simulation.step();
  const StepReport report = run.simulation.step();
  warnings = run.simulation.warnings();
  return report;
}

TEST(SmallStrain, IsWarnedOfFromTenPercent) {
  std::vector<std::string> warnings;
  EXPECT_NEAR(stretched(0.099, warnings).deformation.value().strain, 0.099, 1e-8);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  EXPECT_NEAR(stretched(0.101, warnings).deformation.value().strain, 0.101, 1e-8);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("step 1 strained live tissue by over 10 % (most in step 1: 10.1 %)"),
            std::string::npos)
      << warnings[0];
  EXPECT_NEAR(stretched(-0.101, warnings).deformation.value().strain, -0.101, 1e-8);
  EXPECT_TRUE(mentions(warnings, "strained live tissue"));
}

TEST(SmallStrain, OfRouteCondensedSpeaksOfItsRegion) {
  Scene scene = strip(1e9, 0, 1);
  scene.mesh = structured_board(
      {4, 8, 1, 4, 8, 1}, [](const Vec3& x) { return std::string(x.y() < 4 ? "board" : "frame"); });
  scene.materials["frame"] = {5, 0.3, std::nullopt};  // cannot break
  scene.solver.route = Route::condensed;
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -2, 0), Axes{7}};
  SceneRun run(std::move(scene));
  run.simulation.step();
  EXPECT_TRUE(mentions(run.simulation.warnings(), "%, in the region that a frame computes)"));
  EXPECT_TRUE(mentions(run.simulation.backend().needs().left_out,
                       "largest strain and rotation of those elements"));
}

/// Simple shear turns by atan(shear / 2) and strains by half of it; the linear body has no say in
/// it, as all its nodes are gripped but for one layer.
StepReport turned(double degrees, std::vector<std::string>& warnings) {
  Scene scene = strip(1e9, 0, 1);
  scene.fracture.model = FractureModel::none;
  scene.materials["board"].poisson = 0;
  scene.mesh = structured_board({4, 1, 1, 4, 1, 1});
  scene.supports = {{band(0.9, 2), Axes{7}}};
  const double radians = degrees * std::numbers::pi / 180;
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(2 * std::tan(radians), 0, 0), Axes{7}};
  SceneRun run(std::move(scene));
  const StepReport report = run.simulation.step();
  warnings = run.simulation.warnings();
  return report;
}

TEST(SmallRotation, IsWarnedOfFromTenDegrees) {
  std::vector<std::string> warnings;
  EXPECT_NEAR(turned(9.9, warnings).deformation.value().rotation_deg, 9.9, 1e-6);
  EXPECT_FALSE(mentions(warnings, "turned live tissue"));
  EXPECT_NEAR(turned(10.1, warnings).deformation.value().rotation_deg, 10.1, 1e-6);
  EXPECT_TRUE(mentions(warnings, "step 0 turned live tissue by over 10 deg (most in step 0: 10.1"));
}

TEST(Inversion, IsWarnedOfWithTheNumberOfElements) {
  std::vector<std::string> warnings;
  EXPECT_EQ(stretched(-0.99, warnings).deformation.value().inverted, 0);
  EXPECT_FALSE(mentions(warnings, "inside out"));
  EXPECT_EQ(stretched(-1.01, warnings).deformation.value().inverted, 192);
  EXPECT_TRUE(mentions(warnings, "step 1 turned live elements inside out (most in step 1: 192"));
}

TEST(Deformation, IsNotMeasuredWhereNobodyAsksForStress) {
  Scene scene = strip(1e9, 2, 1);
  scene.fracture.model = FractureModel::none;
  scene.output.stress = false;
  SceneRun run(std::move(scene));
  EXPECT_FALSE(run.simulation.step().deformation);
  EXPECT_TRUE(mentions(run.simulation.backend().needs().left_out, "largest strain and rotation"));
}

TEST(Deformation, OfAPieceCutOffDoesNotCount) {
  const auto measured = [](bool cut) {
    Scene scene = strip(1e9, 0.001, 2);
    scene.fracture.model = FractureModel::none;
    scene.solver.tolerance = 1e-3;
    if (cut) scene.removals.push_back({1, Box{Vec3(0, 4, 0), Vec3(4, 5, 1)}});
    SceneRun run(std::move(scene));
    run.simulation.step();
    return run.simulation.step().deformation.value();
  };
  // The piece is pulled off by alpha of the stiffness; what is held keeps almost no load.
  EXPECT_GT(std::abs(measured(false).strain), 1e-5);
  EXPECT_LT(std::abs(measured(true).strain), 1.1 * std::abs(measured(false).strain));
  EXPECT_LT(measured(true).rotation_deg, 1.1 * measured(false).rotation_deg + 1e-6);
}

// A strip cut through: reported once, with what is cut off; the rest stays finite and right.
TEST(LooseParts, AreReported) {
  Scene scene = strip(1e9, 0.001, 2);
  scene.fracture.model = FractureModel::none;
  scene.solver.tolerance = 1e-3;
  scene.removals.push_back({1, Box{Vec3(0, 4, 0), Vec3(4, 5, 1)}});  // a row of cells
  SceneRun run(std::move(scene));
  run.simulation.step();
  EXPECT_TRUE(run.simulation.warnings().empty());
  run.simulation.step();
  EXPECT_TRUE(
      mentions(run.simulation.warnings(), "1 piece with 96 elements is cut off (since step 1)"));
  for (const Vec3& u : run.simulation.displacement()) EXPECT_TRUE(u.allFinite());
}

TEST(LooseParts, ByHand) {
  Scene scene = strip(1, 1, 1);
  const Problem problem(std::move(scene));
  std::vector<std::uint8_t> destroyed(192, 0);
  EXPECT_TRUE(find_loose_parts(problem, destroyed).none());
  for (Index e = 0; e < 48; ++e) destroyed[e] = 1;  // the two lowest rows
  LooseParts parts = find_loose_parts(problem, destroyed);
  EXPECT_EQ(parts.isolated_nodes.size(), 20u);  // y = 0 and y = 1, five by two each
  EXPECT_TRUE(parts.pieces.empty());
  std::fill(destroyed.begin(), destroyed.begin() + 24, 0);  // only the second row is out
  parts = find_loose_parts(problem, destroyed);
  EXPECT_TRUE(parts.isolated_nodes.empty());
  ASSERT_EQ(parts.pieces.size(), 1u);
  EXPECT_EQ(parts.pieces[0].size(), 24u);
}

// A crack that has split the strip all across leaves the lower half to itself.
TEST(LooseParts, OfASplitBody) {
  const Problem problem(strip(1, 1, 1));
  const std::vector<std::uint8_t> destroyed(192, 0);
  Mesh body = problem.mesh();
  std::map<Index, Index> upper;  // new nodes of the rows above
  for (auto& tet : body.tets) {
    double y = 0;
    for (const Index n : tet) y += problem.mesh().nodes[static_cast<std::size_t>(n)].y() / 4;
    if (y < 4) continue;
    for (Index& n : tet) {
      const Vec3 at = problem.mesh().nodes[static_cast<std::size_t>(n)];
      if (std::abs(at.y() - 4) > 1e-9) continue;
      const auto [node, is_new] = upper.try_emplace(n, body.node_count());
      if (is_new) body.nodes.push_back(at);
      n = node->second;
    }
  }
  ASSERT_EQ(upper.size(), 10u);
  const LooseParts parts = find_loose_parts(problem, destroyed, body);
  EXPECT_TRUE(parts.isolated_nodes.empty());
  ASSERT_EQ(parts.pieces.size(), 1u);
  EXPECT_EQ(parts.pieces[0].size(), 96u);
  EXPECT_TRUE(find_loose_parts(problem, destroyed).none());
}

}  // namespace
}  // namespace sunder::test
