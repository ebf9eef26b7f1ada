// SPDX-License-Identifier: Apache-2.0
// The same scene twice: the same bytes, apart from timings.
#include <gtest/gtest.h>

#include <regex>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

std::string without_timings(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (name == "summary.json") {
    auto json = read_json(path);
    json.erase("timings_ms");
    return json.dump();
  }
  if (name == "frames.csv") {
    std::string text;
    for (auto row : read_csv(path)) {
      row.erase(row.begin() + 8, row.begin() + 14);
      for (const std::string& cell : row) text += cell + ",";
    }
    return text;
  }
  std::string text = read_file(path);
  if (name != "index.html") return text;
  const std::string begin = "<!-- timings -->", end = "<!-- end timings -->";
  for (std::size_t at = 0; (at = text.find(begin)) != std::string::npos;)
    text.erase(at, text.find(end) + end.size() - at);
  return text;
}

TEST(Determinism, TwoRunsGiveTheSameBytesApartFromTimings) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto again = folder / "again";
  const auto run = run_program({"run", board.scene.string(), "--out", again.string(), "--series",
                                "--snapshots", "3,10,9000"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto names = names_in(torn_board());
  ASSERT_EQ(names_in(again), names);
  for (const std::string& name : names)
    EXPECT_TRUE(without_timings(torn_board() / name) == without_timings(again / name)) << name;
}

}  // namespace
}  // namespace sunder::test
