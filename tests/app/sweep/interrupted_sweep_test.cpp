// SPDX-License-Identifier: Apache-2.0
// A sweep that was stopped or killed: --resume loses nothing and does nothing twice.
#include <signal.h>

#include <chrono>
#include <set>
#include <thread>

#include "app/sweep/sweep_support.hpp"

namespace sunder::test {
namespace {

using namespace std::chrono_literals;

Arguments long_sweep(const TearingBoard& board, const std::filesystem::path& out) {
  return {"sweep",   board.scene.string(),
          "--vary",  "instrument.0.force.1=-1:-200:40",
          "--vary",  "fracture.birth=element,through",
          "--jobs",  "2",
          "--out",   out.string(),
          "--quiet", "--resume"};
}

std::size_t lines(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return 0;
  const std::string text = read_file(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// Sends the signal once so many runs are done.
Outcome stop_at(const Arguments& arguments, const std::filesystem::path& out, std::size_t runs,
                int signal) {
  RunControl control;
  control.meanwhile = [&](pid_t program) {
    for (int i = 0; i < 12000 && lines(out / "sweep.rows") < runs; ++i) {
      std::this_thread::sleep_for(1ms);
    }
    kill(program, signal);
  };
  return run_program(arguments, control);
}

class InterruptedSweep : public ::testing::TestWithParam<int> {};

TEST_P(InterruptedSweep, GoesOnWhereItWas) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto out = folder / "s", whole = folder / "whole";
  ASSERT_EQ(run_program(long_sweep(board, whole)).exit_code, 0);
  std::size_t before = 0;
  for (const std::size_t runs : {1U, 17U, 40U}) {
    const Outcome stopped = stop_at(long_sweep(board, out), out, runs, GetParam());
    const std::string text = read_file(out / "sweep.rows");
    const std::size_t done = lines(out / "sweep.rows");
    EXPECT_GE(done, before);
    before = done;
    if (GetParam() == SIGKILL) {
      EXPECT_EQ(stopped.exit_code, -SIGKILL);
    } else {
      EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
      EXPECT_NE(stopped.err.find("80 runs: they are in"), std::string::npos) << stopped.err;
      EXPECT_EQ(sweep_rows(out).size(), done);
    }
    if (GetParam() == SIGKILL && runs == 17U) {
      write_text(out / "sweep.rows", text + "79,done,half a ro");  // as a full disk would leave it
    }
  }
  const Outcome rest = run_program(long_sweep(board, out));
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_NE(rest.out.find(std::to_string(80 - before) + " run"), std::string::npos) << rest.out;
  EXPECT_EQ(lines(out / "sweep.rows"), 80U) << "a run was lost or done twice";
  EXPECT_EQ(without_times(out), without_times(whole));
  // Done: nothing is computed again.
  const std::string rows = read_file(out / "sweep.rows");
  EXPECT_EQ(run_program(long_sweep(board, out)).exit_code, 0);
  EXPECT_EQ(read_file(out / "sweep.rows"), rows);
}

INSTANTIATE_TEST_SUITE_P(By, InterruptedSweep, ::testing::Values(SIGINT, SIGTERM, SIGKILL),
                         [](const auto& test) { return "signal" + std::to_string(test.param); });

}  // namespace
}  // namespace sunder::test
