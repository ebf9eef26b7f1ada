// SPDX-License-Identifier: Apache-2.0
// What scripts/demo shows: a board torn by a grip, at rest in the end, drawn at true scale.
#include <gtest/gtest.h>

#include <regex>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

/// The scene that the script runs, as it names it.
std::string demo_scene() {
  const std::string script = read_file(std::filesystem::path(SUNDER_SOURCE) / "scripts" / "demo");
  std::smatch found;
  if (!std::regex_search(script, found, std::regex("sunder run (\\S+) "))) return {};
  return found[1];
}

struct DemoRun {
  TempFolder folder;
  std::filesystem::path results = folder / "demo";
  Outcome outcome =
      run_program({"run", (std::filesystem::path(SUNDER_SOURCE) / demo_scene()).string(), "--out",
                   results.string(), "--snapshots", "5,10,20,40"});
};

const DemoRun& demo() {
  static const DemoRun run;
  return run;
}

TEST(Demo, IsDrivenByAGripAndRestsByItself) {
  ASSERT_EQ(demo().outcome.exit_code, 0) << demo().outcome.err;
  const auto summary = read_json(demo().results / "summary.json");
  EXPECT_GT(summary["destroyed"].size(), 40u);
  for (const auto& warning : summary["warnings"])  // a cap would end steps, not the tear
    EXPECT_EQ(warning.get<std::string>().find("max_events"), std::string::npos) << warning;
  const auto scene = read_file(std::filesystem::path(SUNDER_SOURCE) / demo_scene());
  EXPECT_NE(scene.find("displacement = [0.0, -28.0, 0.0]"), std::string::npos);

  const auto frames = read_csv(demo().results / "frames.csv");
  ASSERT_EQ(frames[0][2], "events");
  ASSERT_EQ(frames[0][7], "max_yield_ratio");
  std::size_t last_event = 0;
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (frames[i][2] != "0") last_event = i;
  EXPECT_GT(last_event, 0u);
  EXPECT_LT(last_event + 5, frames.size());  // the grip moves on and nothing breaks
  const double ratio = std::stod(frames.back()[7]);
  EXPECT_GT(ratio, 0.0);
  EXPECT_LE(ratio, 0.5);
}

TEST(Demo, EveryPictureIsAtTrueScale) {
  for (const char* name :
       {"figure.svg", "snapshot_5.svg", "snapshot_10.svg", "snapshot_20.svg", "snapshot_40.svg"})
    EXPECT_NE(read_file(demo().results / name).find("Displacement × 1: true scale."),
              std::string::npos)
        << name;
}

}  // namespace
}  // namespace sunder::test
