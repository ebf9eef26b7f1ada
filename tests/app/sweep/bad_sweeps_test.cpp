// SPDX-License-Identifier: Apache-2.0
// Sweeps that are refused: one sentence, the right exit code, and nothing written.
#include <signal.h>

#include <chrono>
#include <thread>

#include "app/sweep/sweep_support.hpp"

namespace sunder::test {
namespace {

struct BadSweep {
  const char* name;
  Arguments arguments;  ///< behind `sweep SCENE`
  int exit_code;
  const char* message;  ///< part of it
};

class BadSweeps : public ::testing::Test {
 protected:
  void expect_refused(const BadSweep& bad) const {
    SCOPED_TRACE(bad.name);
    Arguments arguments{"sweep", board_.scene.string(), "--quiet"};
    arguments.insert(arguments.end(), bad.arguments.begin(), bad.arguments.end());
    for (std::string& argument : arguments) {
      if (argument == "OUT") argument = (folder_ / "out").string();
    }
    const Outcome run = run_program(arguments);
    EXPECT_EQ(run.exit_code, bad.exit_code);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run.err.find("sunder: error: "), 0U) << run.err;
    EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
    EXPECT_NE(run.err.find(bad.message), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }

  TempFolder folder_;
  TearingBoard board_{folder_};
};

TEST_F(BadSweeps, AreRefusedBeforeTheFirstRun) {
  const Arguments none;
  for (const BadSweep& bad : {
           BadSweep{"no_vary", {"--out", "OUT"}, 2, "a sweep needs --vary"},
           BadSweep{"no_out", {"--vary", "time.steps=1,2"}, 2, "needs --out"},
           BadSweep{"empty_out", {"--vary", "time.steps=1,2", "--out", ""}, 2, "needs --out"},
           BadSweep{"no_value", {"--vary", "time.steps", "--out", "OUT"}, 2, "--vary is"},
           BadSweep{"bracket",
                    {"--vary", "instrument.0.force=[0,1", "--out", "OUT"},
                    2,
                    "a bracket is not closed"},
           BadSweep{"twice",
                    {"--vary", "time.steps=1", "--vary", "time.steps=2", "--out", "OUT"},
                    2,
                    "the key \"time.steps\" is varied twice"},
           BadSweep{"jobs",
                    {"--vary", "time.steps=1", "--jobs", "0", "--out", "OUT"},
                    2,
                    "--jobs is \"0\""},
           BadSweep{"part",
                    {"--vary", "time.steps=1", "--part", "3/2", "--out", "OUT"},
                    2,
                    "--part is \"3/2\"; allowed is I/N"},
           BadSweep{"part_word",
                    {"--vary", "time.steps=1", "--part", "two", "--out", "OUT"},
                    2,
                    "--part is \"two\"; allowed is I/N"},
           BadSweep{"part_zero",
                    {"--vary", "time.steps=1", "--part", "0/2", "--out", "OUT"},
                    2,
                    "--part is \"0/2\"; allowed is I/N"},
           BadSweep{
               "merge_of_nothing", {"--merge", "--out", "OUT"}, 2, "there is no part of a sweep"},
           BadSweep{"merge_part",
                    {"--merge", "--part", "1/2", "--out", "OUT"},
                    2,
                    "--merge takes neither --part nor --resume"},
           BadSweep{"unknown_key",
                    {"--vary", "material.upper.yeild=1,2", "--out", "OUT"},
                    3,
                    "--vary material.upper.yeild=1"},
           BadSweep{"last_value",
                    {"--vary", "time.steps=2,3,x", "--out", "OUT"},
                    3,
                    "--vary time.steps=x"},
           BadSweep{"index",
                    {"--vary", "instrument.7.force.1=1,2", "--out", "OUT"},
                    3,
                    "--vary instrument.7.force.1=1: \"7\" is no index here"},
           BadSweep{"physical",
                    {"--vary", "material.upper.young=5,-5", "--out", "OUT"},
                    3,
                    "material \"upper\""},
           BadSweep{"no_node",
                    {"--vary", "instrument.0.box=[[90,90,90],[91,91,91]],[[0,0,0],[1,1,1]]",
                     "--out", "OUT"},
                    3,
                    "selects no node"},
           BadSweep{"mesh", {"--vary", "mesh=board.msh,none.msh", "--out", "OUT"}, 3, "none.msh"},
           BadSweep{"backend",
                    {"--vary", "solver.backend=cpu,vulkan", "--out", "OUT"},
                    4,
                    "a sweep computes by backend cpu, not by \"vulkan\""},
       })
    expect_refused(bad);
}

TEST_F(BadSweeps, AFolderThatHoldsOneIsNotTakenForAnother) {
  const auto out = folder_ / "s";
  ASSERT_EQ(run_program(sweep_of(board_, out, {"--steps", "2"})).exit_code, 0);
  const std::string table = read_file(out / "sweep.csv");
  const Outcome again = run_program(sweep_of(board_, out, {"--steps", "2"}));
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("holds a sweep with 6 runs done; go on with it by --resume"),
            std::string::npos)
      << again.err;
  const Outcome other = run_program(sweep_of(board_, out, {"--steps", "3", "--resume"}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("is another one: it has other --set or options"), std::string::npos)
      << other.err;
  EXPECT_EQ(read_file(out / "sweep.csv"), table);
}

TEST_F(BadSweeps, TwoInOneFolder) {
  const auto out = folder_ / "s";
  RunControl control;
  control.meanwhile = [&](pid_t first) {
    for (int i = 0; i < 4000 && !std::filesystem::exists(out / "sweep.rows"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    const Outcome second = run_program(sweep_of(board_, out, {"--resume"}));
    EXPECT_EQ(second.exit_code, 2) << second.err;
    EXPECT_EQ(second.err, "sunder: error: --out: results cannot go to " + out.string() +
                              ": process " + std::to_string(first) +
                              " is writing its results there; name another folder with --out, or "
                              "wait until it is done\n");
    kill(first, SIGINT);
  };
  const Outcome first = run_program(
      {"sweep", board_.scene.string(), "--vary", "instrument.0.force.1=-1:-2:300", "--vary",
       "material.upper.yield=2:3:300", "--steps", "1000", "--out", out.string(), "--quiet"},
      control);
  EXPECT_EQ(first.exit_code, 130) << first.err;
}

TEST_F(BadSweeps, AFullDiskCostsNoRunBefore) {
  const auto out = folder_ / "s";
  // sweep.json fits, the rows do not.
  RunControl control;
  control.file_size_limit = 8192;
  const Arguments many{"sweep",   board_.scene.string(),
                       "--vary",  "instrument.0.force.1=-1:-2:60",
                       "--steps", "2",
                       "--jobs",  "2",
                       "--out",   out.string(),
                       "--quiet"};
  const Outcome full = run_program(many, control);
  EXPECT_EQ(full.exit_code, 1) << full.err;
  EXPECT_NE(full.err.find("sweep.rows: File too large; the runs before are in it"),
            std::string::npos)
      << full.err;
  EXPECT_FALSE(std::filesystem::exists(out / "sweep.csv"));
  Arguments resume = many;
  resume.push_back("--resume");
  const Outcome rest = run_program(resume);
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_EQ(rest.out.find("60 runs in"), std::string::npos) << rest.out;  // some were there
  EXPECT_EQ(sweep_rows(out).size(), 60U);
}

}  // namespace
}  // namespace sunder::test
