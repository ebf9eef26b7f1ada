// SPDX-License-Identifier: Apache-2.0
// The critical load from one step against trying loads just below and just above it.
#include "app/reproduce/critical_load.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "app/reproduce/measures.hpp"
#include "app/reproduce/notch_mesh.hpp"
#include "app/reproduce/paper_files.hpp"

namespace sunder::test {
namespace {

using namespace app::reproduce;

Laboratory laboratory() {
  return {"cpu", [] { return false; }, [](const std::string&) {}};
}

int broken_at(const Laboratory& lab, RunPlan plan, double load) {
  plan.load = load;
  return static_cast<int>(lab.run(one_event(lab, plan)).fractures().size());
}

class CriticalLoads : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(CriticalLoads, LieBetweenWhatHoldsAndWhatBreaks) {
  const Laboratory lab = laboratory();
  const auto& [scene, sif] = GetParam();
  const RunPlan plan{scene, {sif}, nullptr, 1, {}};
  const auto critical = critical_load(lab, plan);
  ASSERT_TRUE(critical.has_value());
  EXPECT_EQ(broken_at(lab, plan, critical->factor * 0.999), 0);
  EXPECT_GT(broken_at(lab, plan, critical->factor * 1.001), 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, CriticalLoads,
                         ::testing::Values(std::pair{"notch-b", "fracture.sif=formula"},
                                           std::pair{"notch-b", "fracture.sif=field"},
                                           std::pair{"pressure-near", "fracture.sif=formula"},
                                           std::pair{"notch-a", "fracture.model=A"}));

TEST(CriticalLoad, OfAnotherLawLiesBetweenWhatHoldsAndWhatGrows) {
  const Laboratory lab = laboratory().with_law(MaterialLaw::corotated);
  const RunPlan plan{"notch-b", {"fracture.sif=formula"}, nullptr, 1, {}};
  const auto critical = critical_growth(lab, plan);
  ASSERT_TRUE(critical.has_value());
  EXPECT_EQ(broken_at(lab, plan, critical->factor * 0.98), 0);
  EXPECT_GT(broken_at(lab, plan, critical->factor * 1.02), 0);
  for (const RunNote& note : lab.notes()) EXPECT_EQ(note.failure, "") << note.load;
}

// Beyond small strain J takes the place of the field's K.
TEST(CriticalLoad, OfAnotherLawGoesOnByJ) {
  const Laboratory lab = laboratory().with_law(MaterialLaw::corotated);
  const RunPlan plan{"notch-b", {"fracture.sif=field"}, nullptr, 1, {}};
  const auto critical = critical_growth(lab, plan);
  ASSERT_TRUE(critical.has_value());
  EXPECT_TRUE(std::ranges::any_of(lab.notes(), [](const RunNote& note) { return note.by_j; }));
  EXPECT_EQ(broken_at(lab, plan, critical->factor * 0.98), 0);
  EXPECT_GT(broken_at(lab, plan, critical->factor * 1.02), 0);
}

TEST(CriticalLoad, ScalesTheTermsToItself) {
  const Laboratory lab = laboratory();
  const RunPlan plan{"notch-b", {}, nullptr, 1, {}};
  const auto low = critical_growth(lab, plan);
  RunPlan higher = plan;
  higher.load = 3;
  const auto high = critical_growth(lab, higher);
  ASSERT_TRUE(low && high && low->sif && high->sif);
  EXPECT_NEAR(high->factor * 3, low->factor, 1e-9 * low->factor);
  EXPECT_NEAR(high->sif->k, low->sif->k, 1e-9 * low->sif->k);
  EXPECT_NEAR(*high->sif->k_field, *low->sif->k_field, 1e-6 * *low->sif->k_field);
  EXPECT_NEAR(high->rise_deg, low->rise_deg, 1e-6);
  EXPECT_LT(low->rise_deg, 0);  // theta > 0 turns a crack that runs to the left downwards
  EXPECT_GT(low->sif->theta, 0);
}

TEST(CriticalLoad, StopsWhenAsked) {
  const Laboratory lab(
      "cpu", [] { return true; }, [](const std::string&) {});
  EXPECT_THROW(static_cast<void>(critical_load(lab, {"notch-b", {}, nullptr, 1, {}})), Interrupted);
}

TEST(Laboratory, AGripMovesAlongThePullAndIsFreeAcrossIt) {
  RunPlan plan{"board-pull-b", {}, nullptr, 1, {}};
  plan.grip = 36;
  const Scene scene = laboratory().scene(plan);
  const auto* grip = std::get_if<Grip>(&scene.instruments.at(0).action);
  ASSERT_NE(grip, nullptr);
  EXPECT_EQ(grip->displacement, Vec3(0, -36, 0));
  EXPECT_EQ(grip->axes, Axes{2});
}

TEST(Laboratory, AnotherLawIsThatOfAllMaterialsAndStaysOnTheCpu) {
  const Laboratory any(
      "auto", [] { return false; }, [](const std::string&) {});
  const Laboratory lab = any.with_law(MaterialLaw::corotated);
  const Scene scene = lab.scene({"notch-b", {}, nullptr, 1, {}});
  EXPECT_EQ(scene.solver.backend, "cpu");
  for (const auto& [name, material] : scene.materials)
    EXPECT_EQ(material.law, MaterialLaw::corotated) << name;
  EXPECT_EQ(any.scene({"notch-b", {}, nullptr, 1, {}}).solver.backend, "auto");
}

TEST(Laboratory, ARunThatFindsNoEquilibriumKeepsWhatCameBefore) {
  // Far beyond any load that the board bears, on a mesh that is soon done with.
  const Laboratory lab = laboratory().with_law(MaterialLaw::corotated);
  RunPlan plan{"notch-b",
               {"time.steps=2", "instrument.0.ramp=[0.5,0.5]", "fracture.model=A"},
               lab.notch({16, 10, 5}),
               1e6,
               {}};
  const RunResult run = lab.run(plan);
  EXPECT_FALSE(run.failure.empty());
  ASSERT_EQ(lab.notes().size(), 1U);
  EXPECT_EQ(lab.notes()[0].failure, run.failure);
  EXPECT_EQ(lab.notes()[0].steps, static_cast<int>(run.steps.size()));
  EXPECT_EQ(run.last.displacement.size(), run.problem->mesh().nodes.size());
}

TEST(Laboratory, AnEndAtSoManyBrokenElementsIsKept) {
  RunPlan plan{"notch-b", {"fracture.sif=formula"}, nullptr, 1, {}};
  plan.until = 5;
  const RunResult run = laboratory().run(plan);
  EXPECT_GE(run.fractures().size(), 5U);
  EXPECT_LT(run.steps.size(), 50U);
  EXPECT_LT(run.fractures().size(),
            laboratory().run({"notch-b", {}, nullptr, 1, {}}).fractures().size());
}

TEST(Laboratory, LargestFreeRatioLeavesOutWhatTouchesACrack) {
  // Under a load that breaks the intact notched board elsewhere (A: 57.7 N) the ratio away from
  // the notch is that of model A's first element or less.
  const Laboratory lab = laboratory();
  const RunResult run = lab.run({"notch-b",
                                 {"fracture.model=B", "time.steps=1", "fracture.max_events=1"},
                                 nullptr,
                                 0.5,
                                 {0}});
  ASSERT_EQ(run.snapshots.size(), 1u);
  const double free = largest_free_ratio(run, run.snapshots[0]);
  const auto ratios = app::yield_ratios(*run.problem, run.snapshots[0]);
  const double all = *std::max_element(ratios.begin(), ratios.end());
  EXPECT_GT(free, 0);
  EXPECT_LT(free, all) << "the most stressed element lies at the notch's tip";
}

TEST(BoardMesh, DefaultIsTheScenesOwnGeometry) {
  EXPECT_EQ(board_geometry({}), paper_file("meshes/board1954.geo"));
  EXPECT_NE(board_geometry({2.6, 6}).find("h=2.6;"), std::string::npos);
  EXPECT_NE(board_geometry({2.6, 6}).find("Mesh.Algorithm=6;"), std::string::npos);
  const Laboratory lab = laboratory();
  EXPECT_EQ(lab.board({}), lab.board({})) << "made once";
  EXPECT_EQ(lab.board({})->tet_count(), 1954);
}

TEST(NotchMesh, TakesSizeLengthAndMesher) {
  const auto mesh = mesh_notch({6.0, 10.0, 6});
  double least = 50;
  int in_notch = 0;
  for (Index e = 0; e < mesh->tet_count(); ++e) {
    if (mesh->volumes[static_cast<std::size_t>(mesh->volume_of[e])].name != "preset-crack")
      continue;
    ++in_notch;
    for (const Index node : mesh->tets[e]) least = std::min(least, mesh->nodes[node].x());
  }
  EXPECT_GT(in_notch, 0);
  EXPECT_NEAR(least, 40, 1e-9);
  EXPECT_LT(mesh->tet_count(), 1200);
  EXPECT_EQ(mesh_notch({6.0, 10.0, 6})->tets, mesh->tets);  // the same again
}

TEST(NotchMesh, DefaultsAreTheScenesOwnGeometry) {
  EXPECT_EQ(notch_geometry({}), paper_file("meshes/board1954_notch.geo"));
  EXPECT_EQ(mesh_notch({})->tet_count(), 1954);
}

}  // namespace
}  // namespace sunder::test
