// SPDX-License-Identifier: Apache-2.0
// `sunder sweep`: its rows are what `sunder run` says of the same scene, whatever the jobs.
#include "app/sweep/sweep_support.hpp"

namespace sunder::test {
namespace {

TEST(Sweep, HasTheResultsOfRun) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const Outcome swept = run_program(sweep_of(board, folder / "s"));
  ASSERT_EQ(swept.exit_code, 0) << swept.err;
  EXPECT_EQ(swept.err, "");
  const auto rows = sweep_rows(folder / "s");
  ASSERT_EQ(rows.size(), 6U);
  bool torn = false, whole = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    SCOPED_TRACE("run " + std::to_string(i));
    EXPECT_EQ(row.at("run"), std::to_string(i));
    EXPECT_EQ(row.at("status"), "done");
    const auto out = folder / ("r" + std::to_string(i));
    const Outcome run =
        run_program({"run", board.scene.string(), "--quiet", "--out", out.string(), "--backend",
                     "cpu", "--set", "instrument.0.force.1=" + row.at("instrument.0.force.1"),
                     "--set", "material.upper.yield=" + row.at("material.upper.yield")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto summary = read_json(out / "summary.json");
    EXPECT_EQ(std::stod(row.at("compliance")), summary["compliance"].get<double>());
    EXPECT_EQ(std::stod(row.at("residual")), summary["residual"].get<double>());
    EXPECT_EQ(std::stoul(row.at("destroyed")), summary["destroyed"].size());
    EXPECT_EQ(std::stoul(row.at("cracks")), summary["cracks"].size());
    EXPECT_EQ(std::stod(row.at("strain_max")), summary["largest"]["strain"].get<double>());
    EXPECT_EQ(std::stod(row.at("support_y")), summary["supports"][1].get<double>());
    EXPECT_EQ(std::stod(row.at("reaction_0_y")),
              summary["reactions"]["right forceps"][1].get<double>());
    EXPECT_EQ(row.at("first_element").empty(), summary["first_rupture"].is_null());
    if (!summary["first_rupture"].is_null()) {
      EXPECT_EQ(std::stoi(row.at("first_element")), summary["first_rupture"]["element"].get<int>());
      EXPECT_EQ(row.at("first_criterion"), summary["first_rupture"]["criterion"]);
    }
    (summary["first_rupture"].is_null() ? whole : torn) = true;
  }
  EXPECT_TRUE(torn && whole) << "the six runs are to differ";
  EXPECT_EQ(names_in(folder / "s"),
            (Arguments{"sweep.csv", "sweep.html", "sweep.json", "sweep.rows"}));
}

TEST(Sweep, VariedKeysComeFirstTheFirstTheSlowest) {
  const TempFolder folder;
  const TearingBoard board(folder);
  ASSERT_EQ(run_program(sweep_of(board, folder / "s", {"--steps", "2"})).exit_code, 0);
  const auto table = read_csv(folder / "s" / "sweep.csv");
  ASSERT_EQ(table.size(), 7U);
  EXPECT_EQ(table[0][0], "instrument.0.force.1");
  EXPECT_EQ(table[0][1], "material.upper.yield");
  EXPECT_EQ(table[0][2], "run");
  const char* force[] = {"-10", "-10", "-150", "-150", "-200", "-200"};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(table[i + 1][0], force[i]);
    EXPECT_EQ(table[i + 1][1], i % 2 ? "4" : "2");
  }
}

TEST(Sweep, DoesNotDependOnTheJobs) {
  const TempFolder folder;
  const TearingBoard board(folder);
  // Bodies of two kinds, the faster axis makes them.
  const auto sweep = [&](const std::string& jobs) {
    const auto out = folder / ("jobs" + jobs);
    const Outcome run = run_program(
        {"sweep", board.scene.string(), "--vary", "instrument.0.force.1=-10:-200:4", "--vary",
         "material.lower.young=8,9", "--vary", "fracture.birth=element,through", "--jobs", jobs,
         "--out", out.string(), "--quiet"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return without_times(out);
  };
  const auto one = sweep("1");
  EXPECT_EQ(one.size(), 16U);
  EXPECT_EQ(sweep("2"), one);
  EXPECT_EQ(sweep("7"), one);
}

TEST(Sweep, ARunThatFailsIsARowAndTheOthersGoOn) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const Outcome run = run_program(
      {"sweep", board.scene.string(), "--vary", "solver.tolerance=1e-4,1e-300", "--vary",
       "instrument.0.force.1=-10,-20", "--out", (folder / "s").string(), "--quiet"});
  EXPECT_EQ(run.exit_code, 5) << run.err;
  const auto rows = sweep_rows(folder / "s");
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(rows[i].at("status"), i < 2 ? "done" : "numerical");
    EXPECT_EQ(rows[i].at("message").empty(), i < 2);
  }
  EXPECT_NE(run.out.find("2 runs failed\n  run 2: "), std::string::npos) << run.out;
}

}  // namespace
}  // namespace sunder::test
