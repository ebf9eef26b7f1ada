// SPDX-License-Identifier: Apache-2.0
// events.csv, frames.csv and the set of files, against docs/interface.md "Results".
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

using Row = std::vector<std::string>;

double value(const std::string& cell) { return std::strtod(cell.c_str(), nullptr); }

TEST(ResultFolder, HoldsExactlyTheDocumentedFiles) {
  EXPECT_EQ(names_in(torn_board()),
            (Row{"events.csv",      "figure.png",      "figure.svg",      "frames.csv",
                 "index.html",      "result.vtu",      "result_0000.vtu", "result_0001.vtu",
                 "result_0002.vtu", "result_0003.vtu", "result_0004.vtu", "series.pvd",
                 "snapshot_10.png", "snapshot_10.svg", "snapshot_10.vtu", "snapshot_3.png",
                 "snapshot_3.svg",  "snapshot_3.vtu",  "summary.json",    "tips.csv"}));
}

TEST(EventsTable, HasTheDocumentedColumns) {
  const auto rows = read_csv(torn_board() / "events.csv");
  ASSERT_GE(rows.front().size(), 18u);  // further columns may follow
  const Row documented(rows.front().begin(), rows.front().begin() + 18);
  EXPECT_EQ(documented,
            (Row{"step", "event", "element", "criterion", "crack", "ratio", "load_factor", "tip",
                 "K", "K_a", "K_b", "K_c", "theta_deg", "r", "sigma0", "beta_deg", "a", "b"}));
  for (const Row& row : rows) EXPECT_EQ(row.size(), rows.front().size());
}

TEST(EventsTable, EventsCountUpAndElementsBreakOnce) {
  const auto rows = read_csv(torn_board() / "events.csv");
  std::set<std::string> elements;
  int last_event = -1, last_step = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const int step = std::atoi(rows[i][0].c_str()), event = std::atoi(rows[i][1].c_str());
    EXPECT_TRUE(event == last_event || event == last_event + 1) << "row " << i;
    EXPECT_GE(step, last_step);
    EXPECT_DOUBLE_EQ(value(rows[i][6]), (step + 1) / 5.0);
    EXPECT_TRUE(elements.insert(rows[i][2]).second) << "element " << rows[i][2];
    last_event = event;
    last_step = step;
  }
}

TEST(EventsTable, CellsFitTheCriterion) {
  const auto rows = read_csv(torn_board() / "events.csv");
  std::set<std::string> seen;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const Row& row = rows[i];
    seen.insert(row[3]);
    EXPECT_EQ(row[5].empty(), row[3] == "script");
    EXPECT_EQ(row[8].empty(), row[3] != "sif");
    EXPECT_TRUE(row[3] != "script" || row[4].empty());
    EXPECT_TRUE(row[5].empty() || value(row[5]) >= 1.0) << "row " << i;
    if (row[3] != "sif") continue;
    EXPECT_NE(row[4], "");
    EXPECT_GE(value(row[8]), 0);  // K
  }
  EXPECT_EQ(seen, (std::set<std::string>{"mss", "script", "sif"}));
}

TEST(TipsTable, HasARowPerStepAndTip) {
  const auto tips = read_csv(torn_board() / "tips.csv");
  EXPECT_EQ(tips.front(), (Row{"step", "crack", "tip", "x", "y", "z", "K", "theta_deg", "K_I",
                               "K_II", "K_III", "J", "toughness", "field_note"}));
  const auto summary = read_json(torn_board() / "summary.json");
  std::size_t last = 0;
  for (const auto& crack : summary["cracks"]) last += crack["tips"].size();
  ASSERT_GT(last, 0u);
  ASSERT_GT(tips.size(), last);
  int step = 0;
  for (std::size_t i = 1; i < tips.size(); ++i) {
    const Row& row = tips[i];
    ASSERT_EQ(row.size(), tips.front().size());
    EXPECT_GE(std::atoi(row[0].c_str()), step);
    step = std::atoi(row[0].c_str());
    EXPECT_TRUE(row[6].empty() || value(row[6]) >= 0) << i;
    for (std::size_t later : {8u, 9u, 10u, 11u, 12u}) EXPECT_EQ(row[later], "");  // the formula
  }
  EXPECT_EQ(step, 4);
  // The last step's are where the summary has them.
  std::size_t at = tips.size() - last;
  for (const auto& crack : summary["cracks"]) {
    for (const auto& tip : crack["tips_xyz"]) {
      EXPECT_EQ(tips[at][0], "4");
      EXPECT_EQ(tips[at][1], std::to_string(crack["id"].get<int>()));
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_EQ(tip[axis].get<double>(), value(tips[at][3 + axis]));
      ++at;
    }
  }
}

// A notch that rests under a load that grows: K in every step, in proportion to the load.
TEST(TipsTable, HasTheKOfTipsThatRest) {
  for (const std::string sif : {"formula", "field"}) {
    const TempFolder folder;
    const auto out = folder / "out";
    const Outcome run = run_program({"run", SUNDER_SOURCE "/scenes/notch-b.toml", "--out",
                                     out.string(), "--backend", "cpu", "--quiet", "--steps", "3",
                                     "--set", "instrument.0.force=[0, -20, 0]", "--set",
                                     "instrument.0.ramp=[0, 1]", "--set", "fracture.sif=" + sif});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto tips = read_csv(out / "tips.csv");
    ASSERT_EQ(tips.size(), 4u) << "a row per step";
    const auto frames = read_csv(out / "frames.csv");
    for (std::size_t step = 0; step < 3; ++step) {
      const Row& row = tips[step + 1];
      EXPECT_EQ(row[0], std::to_string(step));
      EXPECT_EQ(row[3], "45.96");  // it rests
      for (std::size_t k : {6u, 8u, 9u, 10u}) {
        if (sif == "formula" && k > 6) continue;
        ASSERT_NE(row[k], "") << sif << " " << step << " " << k;
        const double growth = value(frames[step + 1][1]) / value(frames[1][1]);  // of the load
        EXPECT_NEAR(value(row[k]), growth * value(tips[1][k]), 1e-7 * value(row[6]))
            << sif << " " << k;
      }
    }
    // The board stands in x and y, its middle at z = 1: so do paths in the plane and in space.
    const auto crack = read_json(out / "summary.json")["cracks"][0];
    ASSERT_EQ(crack["path"].size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& flat = crack["path"][i];
      EXPECT_EQ(crack["path_xyz"][i], (nlohmann::ordered_json{flat[0], flat[1], 1}));
    }
    EXPECT_EQ(crack["mouth_xyz"], crack["path_xyz"][0]);
  }
}

TEST(FramesTable, HasARowPerStepThatAgreesWithTheEvents) {
  const auto frames = read_csv(torn_board() / "frames.csv");
  const auto events = read_csv(torn_board() / "events.csv");
  EXPECT_EQ(frames.front(), (Row{"step",
                                 "load_factor",
                                 "events",
                                 "destroyed",
                                 "compliance",
                                 "residual",
                                 "error",
                                 "max_yield_ratio",
                                 "ms_load",
                                 "ms_solve",
                                 "ms_stress",
                                 "ms_decide",
                                 "ms_update",
                                 "ms_total",
                                 "iterations",
                                 "ms_gpu_solve",
                                 "ms_gpu_stress",
                                 "ms_gpu_residual",
                                 "ms_gpu_estimate",
                                 "ms_gpu_refine",
                                 "ms_gpu_update",
                                 "strain_max",
                                 "rotation_max_deg",
                                 "inverted",
                                 "back_solves",
                                 "time",
                                 "kinetic",
                                 "strain_energy",
                                 "work",
                                 "dissipated",
                                 "momentum_x",
                                 "momentum_y",
                                 "momentum_z"}));
  ASSERT_EQ(frames.size(), 6u);
  for (int step = 0; step < 5; ++step) {
    const Row& row = frames[static_cast<std::size_t>(step) + 1];
    ASSERT_EQ(row.size(), frames.front().size());
    EXPECT_EQ(row[0], std::to_string(step));
    EXPECT_DOUBLE_EQ(value(row[1]), (step + 1) / 5.0);
    std::set<std::string> of_step;
    long destroyed = 0;
    for (std::size_t i = 1; i < events.size(); ++i) {
      if (std::atoi(events[i][0].c_str()) == step) of_step.insert(events[i][1]);
      if (std::atoi(events[i][0].c_str()) <= step) ++destroyed;
    }
    EXPECT_EQ(row[2], std::to_string(of_step.size())) << "step " << step;
    EXPECT_EQ(row[3], std::to_string(destroyed)) << "step " << step;
    double stages = 0;
    for (int i = 8; i < 13; ++i) stages += value(row[static_cast<std::size_t>(i)]);
    EXPECT_GT(stages, 0);
    EXPECT_LE(stages, value(row[13]) * (1 + 1e-9));
    EXPECT_LE(value(row[6]), 1e-4);  // error: solver.tolerance
  }
}

TEST(FramesTable, SummaryIsItsLastRow) {
  const auto frames = read_csv(torn_board() / "frames.csv");
  const auto summary = read_json(torn_board() / "summary.json");
  EXPECT_EQ(summary["compliance"].get<double>(), value(frames.back()[4]));
  EXPECT_EQ(summary["residual"].get<double>(), value(frames.back()[5]));
  EXPECT_EQ(summary["error"].get<double>(), value(frames.back()[6]));
  std::vector<double> total;
  for (std::size_t i = 1; i < frames.size(); ++i) total.push_back(value(frames[i][13]));
  std::sort(total.begin(), total.end());
  EXPECT_EQ(summary["timings_ms"]["total"]["median"].get<double>(), total[2]);
  EXPECT_EQ(summary["timings_ms"]["total"]["max"].get<double>(), total[4]);
}

}  // namespace
}  // namespace sunder::test
