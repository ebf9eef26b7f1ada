// SPDX-License-Identifier: Apache-2.0
// A million tetrahedra through the program: the board is made, read, solved and torn, with progress
// on stderr, in the memory at hand. Says what it took.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Of the programs run so far, the largest.
double peak_mebibytes() {
  rusage use{};
  getrusage(RUSAGE_CHILDREN, &use);
  return static_cast<double>(use.ru_maxrss) / 1024;
}

class Million : public ::testing::Test {
 protected:
  void SetUp() override {
    const Outcome made =
        run_program({"mesh", "board", "--tets", "1000000", "-o", (folder_ / "board.msh").string()});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    write_text(folder_ / "board.toml", board_toml("A million tetrahedra") + R"toml([fracture]
model = "A"
max_events = 2
[time]
steps = 2
)toml");
  }

  [[nodiscard]] Outcome run_on(const std::string& route) const {
    return run_program({"run", (folder_ / "board.toml").string(), "--backend", "cpu", "--route",
                        route, "--out", (folder_ / route).string()});
  }

  void tear(const std::string& route) {
    const auto start = Clock::now();
    const Outcome run = run_on(route);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    ASSERT_EQ(run.exit_code, 0) << run.err;
    std::printf("%s: %.0f s, at most %.0f MiB resident\n", route.c_str(), seconds,
                peak_mebibytes());

    // Plain lines, as stderr is no terminal.
    EXPECT_NE(run.err.find("preparing "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("/2, "), std::string::npos) << run.err;

    const auto summary = read_json(folder_ / route / "summary.json");
    EXPECT_GE(summary["mesh"]["tets"].get<long>(), 1'000'000);
    EXPECT_EQ(summary["route"]["name"], route);
    EXPECT_EQ(summary["steps_done"], 2);
    EXPECT_EQ(summary["failure"], nullptr);
    EXPECT_GE(summary["destroyed"].size(), 1u);
    for (const char* key : {"compliance", "residual", "error", "max_yield_ratio"}) {
      ASSERT_TRUE(summary[key].is_number()) << key << " is no number";  // null: not finite
    }
    EXPECT_GT(summary["compliance"].get<double>(), 0);
    EXPECT_LE(summary["error"].get<double>(), 1e-8);
    EXPECT_GT(summary["memory_bytes"].get<double>(), 1e8);
    EXPECT_LT(summary["memory_bytes"].get<double>(), peak_mebibytes() * 1048576);
  }

  TempFolder folder_;
};

TEST_F(Million, TearsByConjugateGradients) { tear("cg"); }

TEST_F(Million, TearsByTheFactor) { tear("factor"); }

}  // namespace
}  // namespace sunder::test
