// SPDX-License-Identifier: Apache-2.0
// A run whose tolerance its route does not keep by itself: polished and said so, or refused with
// the reason and with the results so far.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

struct TearingRun {
  TearingRun(const std::string& route, const std::string& tolerance) {
    const TempFolder folder;
    const TearingBoard board(folder);
    outcome =
        run_program({"run", board.scene.string(), "--quiet", "--backend", "cpu", "--route", route,
                     "--set", "solver.tolerance=" + tolerance, "--out", (folder / "o").string()});
    summary = read_json(folder / "o" / "summary.json");
    frames = read_csv(folder / "o" / "frames.csv");
  }

  [[nodiscard]] std::string polishing() const {
    for (const auto& warning : summary["warnings"]) {
      const auto text = warning.get<std::string>();
      if (text.find("over the tolerance, which was polished") != std::string::npos) return text;
    }
    return {};
  }

  /// Largest error of a step in frames.csv.
  [[nodiscard]] double largest_error() const {
    const auto column = std::find(frames[0].begin(), frames[0].end(), "error") - frames[0].begin();
    double largest = 0;
    for (std::size_t i = 1; i < frames.size(); ++i) {
      const std::string& text = frames[i][static_cast<std::size_t>(column)];
      double error = 0;
      std::from_chars(text.data(), text.data() + text.size(), error);
      largest = std::max(largest, error);
    }
    return largest;
  }

  Outcome outcome;
  nlohmann::ordered_json summary;
  std::vector<std::vector<std::string>> frames;
};

TEST(Polish, IsSaidInTheSummary) {
  for (const char* route : {"inverse", "condensed"}) {
    SCOPED_TRACE(route);
    const TearingRun rough(route, "1e-4"), fine(route, "2e-11");
    EXPECT_EQ(rough.outcome.exit_code, 0);
    EXPECT_EQ(rough.polishing(), "");
    EXPECT_EQ(fine.outcome.exit_code, 0) << fine.outcome.err;
    EXPECT_NE(fine.polishing(), "");
    EXPECT_LE(fine.summary["error"].get<double>(), 2e-11);
    EXPECT_LE(fine.largest_error(), 2e-11);
    EXPECT_EQ(fine.summary["failure"], nullptr);
    EXPECT_EQ(fine.summary["destroyed"], rough.summary["destroyed"]);
  }
}

TEST(Polish, FailsWithTheReasonAndTheResultsSoFar) {
  const TearingRun refused("factor", "1e-15");
  EXPECT_EQ(refused.outcome.exit_code, 5);
  const std::string reason = "the solution cannot be brought under the tolerance: estimated stress";
  EXPECT_NE(refused.outcome.err.find(reason), std::string::npos) << refused.outcome.err;
  ASSERT_TRUE(refused.summary["failure"].is_string());
  EXPECT_EQ(refused.summary["failure"].get<std::string>().find(reason), 0u);
  EXPECT_LT(refused.summary["steps_done"], 5);
  EXPECT_EQ(refused.frames.size(), 1 + refused.summary["steps_done"].get<std::size_t>());
}

}  // namespace
}  // namespace sunder::test
