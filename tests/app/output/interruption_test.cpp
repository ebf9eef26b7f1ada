// SPDX-License-Identifier: Apache-2.0
// Runs that end early: signals, full disks, numerical failure. What is there is whole.
#include <gtest/gtest.h>
#include <signal.h>

#include "app/output/program.hpp"
#include "app/output/whole_results.hpp"

namespace sunder::test {
namespace {

class Interruption : public ::testing::TestWithParam<int> {};

TEST_P(Interruption, BetweenStepsWritesTheResultsSoFar) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  RunControl control;
  control.meanwhile = [&](pid_t program) {
    EXPECT_TRUE(wait_for(half_written(out, "frames.csv", program), 400));
    kill(program, GetParam());
  };
  const Outcome run = run_program({"run", board.scene.string(), "--out", out.string(), "--steps",
                                   "1000000", "--set", "instrument.0.ramp=[0, 1e4]"},
                                  control);
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_NE(run.err.find("sunder: interrupted "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(" of 1000000: results so far are in " + out.string()), std::string::npos)
      << run.err;
  expect_whole_results(out);
  const auto summary = read_json(out / "summary.json");
  EXPECT_EQ(summary["interrupted"], true);
  const auto steps = summary["steps_done"].get<std::size_t>();
  EXPECT_GT(steps, 0u);
  EXPECT_LT(steps, 1000000u);
  EXPECT_EQ(read_csv(out / "frames.csv").size(), steps + 1);
}

INSTANTIATE_TEST_SUITE_P(Signals, Interruption, ::testing::Values(SIGINT, SIGTERM));

TEST(InterruptionWithinAStep, StopsAfterTheCurrentEvent) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  RunControl control;
  // The first step holds a script and a long cascade; frames.csv appears before it begins.
  control.meanwhile = [&](pid_t program) {
    EXPECT_TRUE(wait_for(half_written(out, "frames.csv", program)));
    kill(program, SIGINT);
  };
  const Outcome run =
      run_program({"run", board.scene.string(), "--out", out.string(), "--steps", "2", "--set",
                   "fracture.max_events=10000", "--set", "instrument.0.ramp=[0, 0]"},
                  control);
  EXPECT_EQ(run.exit_code, 130) << run.err;
  expect_whole_results(out);
  const auto summary = read_json(out / "summary.json");
  EXPECT_EQ(summary["interrupted"], true);
  EXPECT_EQ(read_csv(out / "frames.csv").size(), summary["steps_done"].get<std::size_t>() + 1);
  EXPECT_EQ(read_csv(out / "events.csv").size(), summary["destroyed"].size() + 1);
}

TEST(FullDisk, LeavesNoHalfWrittenFileAndSaysSo) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  RunControl control;
  control.file_size_limit = 40000;  // the VTU file has more
  const Outcome run = run_program({"run", board.scene.string(), "--out", out.string()}, control);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("sunder: error: cannot write the result file " +
                         (out / "result.vtu").string() + ": File too large"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"events.csv", "frames.csv", "tips.csv"}));
  EXPECT_EQ(read_csv(out / "frames.csv").size(), 6u);
}

TEST(FullDisk, OfStandardOutputIsAnError) {
  RunControl control;
  control.standard_output = "/dev/full";
  const Outcome run = run_program({"devices"}, control);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err, "sunder: error: cannot write to standard output\n");
}

TEST(NumericalFailure, WritesTheResultsSoFar) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  const Outcome run = run_program(
      {"run", board.scene.string(), "--out", out.string(), "--set", "solver.tolerance=1e-300"});
  EXPECT_EQ(run.exit_code, 5) << run.err;
  EXPECT_NE(run.err.find("in step 1 of 5"), std::string::npos) << run.err;
  expect_whole_results(out);
  const auto summary = read_json(out / "summary.json");
  EXPECT_TRUE(summary["failure"].is_string());
  EXPECT_EQ(summary["interrupted"], false);
  EXPECT_EQ(summary["steps_done"], 0);
}

TEST(Rerun, ReplacesTheResultsOfTheRunBefore) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  ASSERT_EQ(run_program({"run", board.scene.string(), "--out", out.string(), "--series"}).exit_code,
            0);
  write_text(out / "notes.txt", "mine");
  ASSERT_EQ(
      run_program({"run", board.scene.string(), "--out", out.string(), "--steps", "2"}).exit_code,
      0);
  EXPECT_EQ(names_in(out), (std::vector<std::string>{"events.csv", "figure.png", "figure.svg",
                                                     "frames.csv", "index.html", "notes.txt",
                                                     "result.vtu", "summary.json", "tips.csv"}));
}

}  // namespace
}  // namespace sunder::test
