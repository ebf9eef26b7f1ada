// SPDX-License-Identifier: Apache-2.0
// A scene in motion by the program: its columns, its film, its energies.
#include <gtest/gtest.h>

#include <cmath>

#include "app/output/program.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

std::vector<double> numbers(const std::vector<std::vector<std::string>>& rows,
                            const std::string& name) {
  const auto at = std::ranges::find(rows.front(), name) - rows.front().begin();
  std::vector<double> of;
  for (std::size_t i = 1; i < rows.size(); ++i)
    of.push_back(std::stod(rows[i].at(static_cast<std::size_t>(at))));
  return of;
}

// The first .25 s of the board: it moves, tears, and its energies add up in every step.
TEST(MotionRun, SaysWhereItsWorkWent) {
  const TempFolder folder;
  const Outcome run = run_program({"run", SUNDER_SOURCE "/scenes/motion/board.toml", "--out",
                                   (folder / "out").string(), "--quiet", "--steps", "50", "--set",
                                   "instrument.0.ramp=[0, 2.4]"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto frames = read_csv(folder / "out" / "frames.csv");
  const auto time = numbers(frames, "time"), work = numbers(frames, "work");
  const auto kinetic = numbers(frames, "kinetic"), strain = numbers(frames, "strain_energy");
  const auto lost = numbers(frames, "dissipated"), events = numbers(frames, "events");
  double ruptures = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    EXPECT_NEAR(time[i], 0.005 * static_cast<double>(i + 1), 1e-15);
    EXPECT_NEAR(work[i], kinetic[i] + strain[i] + lost[i], 1e-9 * work[i]);
    EXPECT_LE(events[i], 1);
    ruptures += events[i];
  }
  EXPECT_GT(ruptures, 5);
  const auto motion = read_json(folder / "out" / "summary.json")["motion"];
  EXPECT_NEAR(motion["time"].get<double>(), 0.25, 1e-15);
  const auto& of = motion["dissipated"];
  EXPECT_GT(of["broken"].get<double>(), 0);
  EXPECT_LE(std::abs(of["unsolved"].get<double>()), 1e-2 * work.back());
  EXPECT_NEAR(lost.back(),
              of["damping"].get<double>() + of["scheme"].get<double>() +
                  of["broken"].get<double>() + of["unsolved"].get<double>(),
              1e-9 * lost.back());
  EXPECT_GT(std::filesystem::file_size(folder / "out" / "film.png"), 10000U);
  const std::string film = read_file(folder / "out" / "film.svg");
  for (const char* at : {"0.045 s", "0.25 s"}) EXPECT_TRUE(mentions(film, at)) << at;
  const std::string page = read_file(folder / "out" / "index.html");
  for (const char* what : {"In motion", "kinetic energy", "dissipated"}) {
    EXPECT_TRUE(mentions(page, what)) << what;
  }
}

// The sheet and the liver of scenes/motion to where they have begun to tear, their hands as quick
// as in the whole scenes.
TEST(MotionRun, SheetAndLiverTear) {
  struct Scene {
    const char* name;
    std::vector<std::string> how;
  };
  const Scene scenes[] = {{"sheet", {"--steps", "60"}},
                          {"liver", {"--steps", "80", "--set", "instrument.0.ramp=[0, 1.5]"}}};
  for (const Scene& scene : scenes) {
    const TempFolder folder;
    std::vector<std::string> arguments = {
        "run", std::string(SUNDER_SOURCE "/scenes/motion/") + scene.name + ".toml", "--out",
        (folder / "out").string(), "--quiet"};
    arguments.insert(arguments.end(), scene.how.begin(), scene.how.end());
    const Outcome run = run_program(arguments);
    ASSERT_EQ(run.exit_code, 0) << scene.name << ": " << run.err;
    const auto frames = read_csv(folder / "out" / "frames.csv");
    double ruptures = 0;
    for (const char* of : {"work", "kinetic", "strain_energy", "dissipated", "events"}) {
      for (double value : numbers(frames, of)) {
        EXPECT_TRUE(std::isfinite(value)) << scene.name << ", " << of;
        if (std::string(of) == "events") ruptures += value;
      }
    }
    EXPECT_GT(ruptures, 5) << scene.name;  // the blade's cuts are five
  }
}

TEST(MotionRun, RouteThatKnowsNoMotionSaysWhatDoes) {
  const TempFolder folder;
  const Outcome run =
      run_program({"run", SUNDER_SOURCE "/scenes/motion/board.toml", "--out",
                   (folder / "out").string(), "--quiet", "--steps", "2", "--route", "condensed"});
  EXPECT_EQ(run.exit_code, 4);
  EXPECT_TRUE(mentions(run.err, "route condensed cannot serve motion")) << run.err;
}

}  // namespace
}  // namespace sunder::test
