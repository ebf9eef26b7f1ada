// SPDX-License-Identifier: Apache-2.0
// Two processes that want one result folder: it holds one run's files at any moment, or none.
#include <gtest/gtest.h>
#include <signal.h>

#include <thread>

#include "app/output/program.hpp"
#include "app/output/whole_results.hpp"

namespace sunder::test {
namespace {

std::vector<std::string> run_of(const TearingBoard& board, const std::filesystem::path& out,
                                const std::string& title, int steps) {
  return {"run",
          board.scene.string(),
          "--out",
          out,
          "--steps",
          std::to_string(steps),
          "--quiet",
          "--set",
          "title=\"" + title + "\"",
          "--set",
          "instrument.0.ramp=[0, 1e4]"};
}

TEST(TwoRuns, TheSecondIsRefusedAtOnce) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out", link = folder / "link";
  RunControl control;
  control.meanwhile = [&](pid_t first) {
    EXPECT_TRUE(wait_for(half_written(out, "frames.csv", first), 400));
    std::filesystem::create_directory_symlink(out, link);
    for (const auto& place : {out, link}) {
      for (const auto& arguments :
           {run_of(board, place, "second", 2),
            std::vector<std::string>{"reproduce", "--quick", "--out", place.string()}}) {
        const Outcome second = run_program(arguments);
        EXPECT_EQ(second.exit_code, 2) << second.err;
        EXPECT_EQ(second.err, "sunder: error: --out: results cannot go to " + place.string() +
                                  ": process " + std::to_string(first) +
                                  " is writing its results there; name another folder with "
                                  "--out, or wait until it is done\n");
      }
    }
    kill(first, SIGINT);
  };
  const Outcome first = run_program(run_of(board, out, "first", 1000000), control);
  EXPECT_EQ(first.exit_code, 130) << first.err;
  expect_whole_results(out);
  EXPECT_EQ(read_json(out / "summary.json")["title"], "first");
}

TEST(TwoRuns, AtTheSameMomentTheFolderHoldsOne) {
  const TempFolder folder;
  const TearingBoard board(folder);
  for (int trial = 0; trial < 8; ++trial) {
    const auto out = folder / ("out" + std::to_string(trial));
    Outcome one, two;
    std::thread other([&] { two = run_program(run_of(board, out, "two", 9)); });
    std::this_thread::sleep_for(std::chrono::milliseconds(5 * trial));
    one = run_program(run_of(board, out, "one", 5));
    other.join();
    for (const Outcome& run : {one, two})
      EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 2) << run.exit_code << run.err;
    ASSERT_TRUE(one.exit_code == 0 || two.exit_code == 0);
    // Where both came through, one began after the other was done.
    expect_whole_results(out);
    const auto summary = read_json(out / "summary.json");
    EXPECT_EQ(summary["steps_done"], summary["title"] == "one" ? 5 : 9);
    EXPECT_NE(read_file(out / "index.html").find(summary["title"].get<std::string>()),
              std::string::npos);
    if (one.exit_code != 0) {
      EXPECT_EQ(summary["title"], "two");
    }
    if (two.exit_code != 0) {
      EXPECT_EQ(summary["title"], "one");
    }
  }
}

TEST(TwoRuns, AfterOneThatWasKilledTheNextCleansUp) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "out";
  ASSERT_EQ(run_program(run_of(board, out, "before", 5)).exit_code, 0);
  RunControl control;
  control.meanwhile = [&](pid_t program) {
    EXPECT_TRUE(wait_for(half_written(out, "frames.csv", program), 400));
    kill(program, SIGKILL);
  };
  auto killed = run_of(board, out, "killed", 1000000);
  killed.push_back("--series");
  EXPECT_EQ(run_program(killed, control).exit_code, -SIGKILL);
  // Of one run: nothing of the one before, and no summary, since it is not complete.
  for (const char* name : {"summary.json", "events.csv", "result.vtu", "index.html"})
    EXPECT_FALSE(std::filesystem::exists(out / name)) << name;
  ASSERT_EQ(run_program(run_of(board, out, "after", 2)).exit_code, 0);
  expect_whole_results(out);
  EXPECT_EQ(names_in(out),
            (std::vector<std::string>{"events.csv", "figure.png", "figure.svg", "frames.csv",
                                      "index.html", "result.vtu", "summary.json", "tips.csv"}));
}

TEST(TwoRuns, AFolderThatCannotBeWrittenToIsRefused) {
  EXPECT_EQ(run_program({"reproduce", "--quick", "--out", "/proc/sunder"}).exit_code, 2);
}

}  // namespace
}  // namespace sunder::test
