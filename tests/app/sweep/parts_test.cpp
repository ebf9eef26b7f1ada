// SPDX-License-Identifier: Apache-2.0
// --part and --merge: parts in folders of their own make the table that one sweep makes.
#include "app/sweep/sweep_support.hpp"

namespace sunder::test {
namespace {

TEST(SweepParts, MergeToTheTableOfTheWhole) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "parts", whole = folder / "whole";
  ASSERT_EQ(run_program(sweep_of(board, whole)).exit_code, 0);
  for (const char* part : {"1/4", "2/4", "4/4"}) {
    const Outcome run = run_program(sweep_of(board, out, {"--part", part}));
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  EXPECT_EQ(names_in(out), (Arguments{"part-1-of-4", "part-2-of-4", "part-4-of-4"}));
  // Runs 0 and 4, 1 and 5, 3.
  EXPECT_EQ(sweep_rows(out / "part-2-of-4").size(), 2U);
  EXPECT_EQ(sweep_rows(out / "part-4-of-4").size(), 1U);

  const Outcome some = run_program(sweep_of(board, out, {"--merge"}));
  EXPECT_EQ(some.exit_code, 0);
  EXPECT_EQ(some.err, "sunder: warning: part-3-of-4 is not there\n");
  EXPECT_NE(some.out.find("5 of 6 runs in"), std::string::npos) << some.out;
  EXPECT_EQ(sweep_rows(out).size(), 5U);

  EXPECT_EQ(run_program(sweep_of(board, out, {"--part", "3/4"})).exit_code, 0);
  const Outcome all =
      run_program({"sweep", board.scene.string(), "--merge", "--out", out.string()});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_EQ(all.err, "");
  EXPECT_EQ(without_times(out), without_times(whole));
}

TEST(SweepParts, AnUnfinishedOneIsNamed) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "parts";
  for (const char* part : {"1/2", "2/2"}) {
    ASSERT_EQ(run_program(sweep_of(board, out, {"--part", part})).exit_code, 0);
  }
  const auto rows = out / "part-2-of-2" / "sweep.rows";
  const std::string text = read_file(rows);
  write_text(rows, text.substr(0, text.find('\n') + 10));  // one run and a half
  const Outcome merged = run_program(sweep_of(board, out, {"--merge"}));
  EXPECT_EQ(merged.exit_code, 0);
  EXPECT_EQ(merged.err, "sunder: warning: part-2-of-2 has 1 of its 3 runs\n");
  EXPECT_EQ(run_program(sweep_of(board, out, {"--part", "2/2", "--resume"})).exit_code, 0);
  EXPECT_EQ(run_program(sweep_of(board, out, {"--merge"})).err, "");
}

TEST(SweepParts, OfAnotherSweepOrDivisionAreRefused) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "parts";
  ASSERT_EQ(run_program(sweep_of(board, out, {"--part", "1/2"})).exit_code, 0);
  const Outcome plain = run_program(sweep_of(board, out));
  EXPECT_EQ(plain.exit_code, 2);
  EXPECT_NE(plain.err.find("holds parts of a sweep; use --part or --merge"), std::string::npos)
      << plain.err;
  ASSERT_EQ(run_program(sweep_of(board, out, {"--part", "2/2", "--steps", "3"})).exit_code, 0);
  const Outcome other = run_program(sweep_of(board, out, {"--merge"}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("part-2-of-2 is of another sweep than the parts before: it has other"),
            std::string::npos)
      << other.err;
  ASSERT_EQ(run_program(sweep_of(board, out, {"--part", "1/3"})).exit_code, 0);
  const Outcome divisions = run_program(sweep_of(board, out, {"--merge"}));
  EXPECT_EQ(divisions.exit_code, 2);
  EXPECT_NE(divisions.err.find("holds parts of"), std::string::npos) << divisions.err;
  const Outcome varied = run_program(
      {"sweep", board.scene.string(), "--vary", "time.steps=1", "--merge", "--out", out.string()});
  EXPECT_EQ(varied.exit_code, 2);
}

}  // namespace
}  // namespace sunder::test
