// SPDX-License-Identifier: Apache-2.0
// The program of a build without the Vulkan backend (SUNDER_GPU=OFF).
#include <gtest/gtest.h>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

Outcome run(const TempFolder& folder, const std::vector<std::string>& more) {
  const TearingBoard board(folder);
  std::vector<std::string> arguments = {"run", board.scene.string(), "--quiet", "--out",
                                        (folder / "out").string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

TEST(NoGpuProgram, RunsAScene) {
  for (const std::vector<std::string>& backend :
       {std::vector<std::string>{}, std::vector<std::string>{"--backend", "cpu"}}) {
    const TempFolder folder;
    const Outcome outcome = run(folder, backend);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto summary = read_json(folder / "out" / "summary.json");
    EXPECT_EQ(summary["device"]["backend"], "cpu");
    EXPECT_GE(read_csv(folder / "out" / "events.csv").size(), 10u) << "the board tears";
  }
}

TEST(NoGpuProgram, SaysWhatIsMissingForVulkan) {
  const TempFolder folder;
  const Outcome outcome = run(folder, {"--backend", "vulkan"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_NE(
      outcome.err.find("this build leaves out the backend vulkan (SUNDER_GPU=OFF); it has cpu"),
      std::string::npos)
      << outcome.err;
}

TEST(NoGpuProgram, ListsTheCpuAlone) {
  const Outcome outcome = run_program({"devices"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("* cpu"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("vulkan"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace sunder::test
