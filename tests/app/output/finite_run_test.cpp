// SPDX-License-Identifier: Apache-2.0
// Runs of scenes with laws of finite deformation: what their files say, and what is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "app/input/scene_toml.hpp"
#include "app/output/program.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

std::vector<std::string> peel(const TempFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> all{"run", SUNDER_SOURCE "/scenes/finite/peel.toml", "--out",
                               (folder / "out").string(), "--quiet"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::vector<std::string> column(const std::vector<std::vector<std::string>>& rows,
                                const std::string& name) {
  const auto at = std::ranges::find(rows.front(), name) - rows.front().begin();
  std::vector<std::string> of;
  for (std::size_t i = 1; i < rows.size(); ++i)
    of.push_back(rows[i].at(static_cast<std::size_t>(at)));
  return of;
}

// The first tenth of the way: the bond begins to let go.
TEST(FiniteRun, SaysItsLawItsStressAndWhatItCost) {
  const TempFolder folder;
  const Outcome run = run_program(peel(folder, {"--steps", "4", "--set", "fracture.stress=biot",
                                                "--set", "instrument.0.ramp=[0, 10]"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = read_json(folder / "out" / "summary.json");
  EXPECT_EQ(summary["law"], "neo-hookean");
  EXPECT_EQ(summary["stress_measure"], "biot");
  EXPECT_EQ(summary["device"]["backend"], "cpu");
  EXPECT_TRUE(mentions(summary["route"]["why"].get<std::string>(), "finite deformation"));
  EXPECT_GT(summary["destroyed"].size(), 0u);
  EXPECT_GT(summary["largest"]["strain"].get<double>(), 0.1);
  EXPECT_TRUE(summary["warnings"].empty()) << summary["warnings"];
  const auto frames = read_csv(folder / "out" / "frames.csv");
  for (const std::string& cell : column(frames, "back_solves")) EXPECT_GT(std::stoi(cell), 0);
  for (const std::string& cell : column(frames, "error")) EXPECT_LE(std::stod(cell), 1e-4);
  EXPECT_FALSE(mentions(read_file(folder / "out" / "index.html"), "Beyond small strain"));
}

TEST(FiniteRun, LinearLawHasOneStress) {
  const TempFolder folder;
  std::vector<std::string> linear{"--steps", "1"};
  for (const char* part : {"bed", "bond", "strip"}) {
    linear.insert(linear.end(), {"--set", std::string("material.") + part + ".law=linear"});
  }
  linear.insert(linear.end(), {"--set", "fracture.stress=biot"});
  const Outcome run = run_program(peel(folder, linear));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = read_json(folder / "out" / "summary.json");
  EXPECT_EQ(summary["law"], "linear");
  EXPECT_TRUE(summary["stress_measure"].is_null());
  EXPECT_TRUE(mentions(summary["warnings"].dump(), "fracture.stress is not read"));
}

// A hand that jumps a hundred lengths of the strip: what was there before stays.
TEST(FiniteRun, ALoadBeyondAnyEquilibriumEndsWithFive) {
  const TempFolder folder;
  const Outcome run = run_program(peel(
      folder, {"--steps", "2", "--set", "fracture.model=none", "--set",
               "instrument.0.displacement=[0, 0, 6000]", "--set", "instrument.0.ramp=[0.6, 1]"}));
  EXPECT_EQ(run.exit_code, 5) << run.err;
  EXPECT_TRUE(mentions(run.err, "in step 2 of 2")) << run.err;
  EXPECT_EQ(read_csv(folder / "out" / "frames.csv").size(), 2u);  // the step before stays
}

TEST(FiniteRun, OtherRoutesAreRefusedWithFour) {
  const TempFolder folder;
  const auto refused = [&](std::vector<std::string> how, const std::string& what) {
    const Outcome run = run_program(peel(folder, std::move(how)));
    EXPECT_EQ(run.exit_code, 4) << run.err;
    EXPECT_TRUE(mentions(run.err, what)) << run.err;
  };
  refused({"--backend", "cpu", "--route", "condensed"}, "route condensed");
  refused({"--backend", "cpu", "--route", "cg"}, "route cg");
}

/// How far the lips of scenes/finite/skin.toml part in the middle of the cut, as they were .5 mm
/// apart, with fibres along y and x.
double wound(const std::string& direction) {
  const auto problem = app::read_problem(SUNDER_SOURCE "/scenes/finite/skin.toml",
                                         {"material.skin.fibres.direction=" + direction});
  Simulation run(problem, std::move(create_backend(problem, needs_of(*problem)).backend));
  while (!run.done()) run.step();
  const auto& u = run.displacement();
  double parted = 0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    const Vec3& x = problem->mesh().nodes[n];
    if (std::abs(x.x()) > 1e-6 || std::abs(x.z() - 2) > 1e-6) continue;
    if (std::abs(std::abs(x.y()) - 0.25) < 1e-6) parted += x.y() > 0 ? u[n].y() : -u[n].y();
  }
  return parted;
}

// Langer's lines: a cut across fibres gapes, one along them is held by them.
TEST(FiniteRun, SkinGapesAcrossItsFibres) {
  const double across = wound("[0, 1, 0]"), along = wound("[1, 0, 0]");
  EXPECT_GT(along, 0);
  EXPECT_GT(across, 2 * along);
}

}  // namespace
}  // namespace sunder::test
