// SPDX-License-Identifier: Apache-2.0
// `sunder reproduce --quick`, run once: page, data and pictures are there and agree.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "app/output/program.hpp"
#include "app/output/xml_file.hpp"

namespace sunder::test {
namespace {

struct Reproduced {
  Reproduced() {
    outcome = run_program({"reproduce", "--quick", "--out", (folder / "out").string()});
  }
  TempFolder folder;
  Outcome outcome;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return folder / "out" / name;
  }
};

const Reproduced& reproduced() {
  static const Reproduced once;
  return once;
}

const nlohmann::ordered_json& json() {
  static const nlohmann::ordered_json all = read_json(reproduced() / "reproduce.json");
  return all;
}

TEST(Reproduce, EndsWellAndTellsWhatItDoes) {
  const Outcome& run = reproduced().outcome;
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("chapter 1/10: experiment 1"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("index.html"), std::string::npos) << run.out;
}

TEST(Reproduce, JsonHasEveryStatementWithBothK) {
  const auto& all = json();
  EXPECT_EQ(all["quick"], true);
  ASSERT_EQ(all["chapters"].size(), 10U);
  const std::set<std::string> verdicts = {"reproduced", "partly", "not reproduced"};
  std::map<std::string, std::set<std::string>> by;
  for (const auto& chapter : all["chapters"])
    for (const auto& s : chapter["statements"]) {
      by[s["id"]].insert(s["by"].get<std::string>());
      EXPECT_TRUE(verdicts.contains(s["verdict"])) << s;
      EXPECT_FALSE(s["numbers"].empty()) << s;
      EXPECT_FALSE(s["rule"].get<std::string>().empty()) << s;
    }
  const std::set<std::string> both = {"formula K", "field K"};
  for (const char* id : {"1a", "1b", "1c", "2a", "2b", "3a", "3b", "4a", "4b", "4c", "5a", "5b"})
    EXPECT_EQ(by[id], both) << id;
}

TEST(Reproduce, VerdictsFollowFromTheirNumbers) {
  for (const auto& chapter : json()["chapters"])
    for (const auto& s : chapter["statements"]) {
      if (s["id"] != "3a" && s["id"] != "2b") continue;
      const double lower = s["numbers"][0]["value"], higher = s["numbers"][1]["value"];
      const std::string expected = lower <= 0.95 * higher ? "reproduced"
                                   : lower < higher       ? "partly"
                                                          : "not reproduced";
      EXPECT_EQ(s["verdict"], expected) << s;
    }
}

TEST(Reproduce, CriticalForcesAgreeWithTheScenes) {
  // scenes/board-pull-b.toml and board-pull-two-points-b.toml state 94 N and 115 N, rounded up to
  // the steps of their ramps.
  for (const auto& table : json()["chapters"][0]["tables"]) {
    if (table["name"] != "experiment-1-first-rupture") continue;
    EXPECT_NEAR(table["rows"][0][1].get<double>(), 93.5, 1.0);
    EXPECT_NEAR(table["rows"][1][1].get<double>(), 114.5, 1.0);
    return;
  }
  FAIL() << "no table of first ruptures";
}

TEST(Reproduce, EveryFileIsThereAndWhole) {
  for (const auto& chapter : json()["chapters"]) {
    for (const auto& figure : chapter["figures"]) {
      const std::string name = figure["file"];
      EXPECT_EQ(parse_xml(read_file(reproduced() / name)).name, "svg") << name;
    }
    for (const auto& table : chapter["tables"]) {
      const auto rows = read_csv(reproduced() / table["file"].get<std::string>());
      EXPECT_EQ(rows.size(), table["rows"].size() + 1) << table["file"];
      EXPECT_EQ(rows.front().size(), table["columns"].size()) << table["file"];
    }
  }
  for (const std::string& name : names_in(reproduced().folder / "out"))
    EXPECT_EQ(name.find(".partial"), std::string::npos) << name;
}

TEST(Reproduce, PageNeedsNoNetwork) {
  const std::string page = read_file(reproduced() / "index.html");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_EQ(page.find("@import"), std::string::npos);
  std::size_t pictures = 0;
  for (std::size_t at = page.find("data:image/png;base64,"); at != std::string::npos;
       at = page.find("data:image/png;base64,", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 4U);  // experiments 1 to 4
  for (const char* id : {"experiment-5", "mesh-sensitivity", "notch-length", "pressure-position",
                         "pressure-angle", "k-along-crack"})
    EXPECT_NE(page.find("id=\"" + std::string(id) + "\""), std::string::npos) << id;
}

TEST(Reproduce, InterruptedWritesNothing) {
  const TempFolder folder;
  RunControl control;
  control.meanwhile = [&](pid_t program) {
    for (int i = 0; i < 5000 && !std::filesystem::exists(folder / "out"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(program, SIGINT);
  };
  const Outcome run =
      run_program({"reproduce", "--quick", "--out", (folder / "out").string()}, control);
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_NE(run.err.find("interrupted: nothing was written"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(Reproduce, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(run_program({"reproduce", "--backend", "abacus"}).exit_code, 2);
  EXPECT_EQ(run_program({"reproduce", "--out", ""}).exit_code, 2);
  EXPECT_EQ(run_program({"reproduce", "scene.toml"}).exit_code, 2);
}

}  // namespace
}  // namespace sunder::test
