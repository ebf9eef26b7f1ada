// SPDX-License-Identifier: Apache-2.0
// The key `recording`: what a host did, done again by the program.
#include <gtest/gtest.h>

#include <fstream>

#include "app/input/scene_toml.hpp"
#include "app/output/program.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

/// What a host does: grasps, pulls until it tears, lets go, cuts; with `interrupt` the first step
/// that breaks ends after its first event, as by a clock.
struct Host {
  Host(const std::filesystem::path& scene, bool interrupt) {
    problem = app::read_problem(scene, {"solver.backend=\"cpu\"", "solver.route=\"inverse\""});
    simulation = std::make_unique<Simulation>(
        problem, std::move(create_backend(problem, needs_of(*problem)).backend));
    Simulation& s = *simulation;
    s.keep_history();
    if (interrupt) s.observe_events([](const auto&) { return false; });
    s.step();
    const int grip = s.grasp(Vec3(10, 5, 0.5), 1.5, true);
    for (int i = 1; i <= 3; ++i) {
      s.pose(grip, {s.centre_of(grip) + Vec3(0.5, -0.2, 0.1), {0, 0, 0.05, 1}});
      s.step();
    }
    s.release(grip);
    const int push = s.push(std::vector<Index>{0, 1}, Vec3(0, -0.1, 0));
    s.step();
    s.drop(push);
    Index live = 0;
    while (s.backend().destroyed()[live]) ++live;
    s.remove(std::vector<Index>{live});
    stored = s.store();
  }
  std::shared_ptr<const Problem> problem;
  std::unique_ptr<Simulation> simulation;
  std::vector<std::uint8_t> stored;
};

void write_bytes(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
}

struct Recorded {
  explicit Recorded(const TempFolder& at, bool interrupt = false) : folder(at), board(at) {
    host.emplace(board.scene, interrupt);
    write_bytes(folder / "r.rec", host->stored);
  }
  Outcome run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"run",
                                       board.scene.string(),
                                       "--out",
                                       folder / "out",
                                       "--quiet",
                                       "--backend",
                                       "cpu",
                                       "--route",
                                       "inverse",
                                       "--set",
                                       "recording=\"r.rec\""};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  const TempFolder& folder;
  TearingBoard board;
  std::optional<Host> host;
};

TEST(RecordingRun, DoesWhatAHostDid) {
  for (const bool interrupt : {false, true}) {
    const TempFolder folder;
    const Recorded recorded(folder, interrupt);
    const Outcome outcome = recorded.run();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Simulation& s = *recorded.host->simulation;
    const auto events = read_csv(folder / "out" / "events.csv");
    ASSERT_EQ(events.size(), s.destroyed().size() + 1);
    ASSERT_GT(events.size(), 4u);
    const auto column = std::ranges::find(events[0], "element") - events[0].begin();
    for (std::size_t i = 0; i < s.destroyed().size(); ++i) {
      EXPECT_EQ(events[i + 1][static_cast<std::size_t>(column)],
                std::to_string(s.destroyed()[i].element));
    }
    const auto frames = read_csv(folder / "out" / "frames.csv");
    EXPECT_EQ(frames.size(), 5u + 1);
    EXPECT_EQ(read_json(folder / "out" / "summary.json")["destroyed"].size(), s.destroyed().size());
  }
}

TEST(RecordingRun, RefusesWhatIsNoRecordingOfThisScene) {
  const TempFolder folder;
  const Recorded recorded(folder);
  const std::string file = (folder / "r.rec").string();
  const auto expect = [&](const std::string& what, const std::vector<std::string>& more = {}) {
    const Outcome outcome = recorded.run(more);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  };
  expect(file + ": the recording is of another body", {"--set", "fracture.alpha=1e-5"});
  expect("recording stands beside inputs", {"--set", "inputs=\"x\""});
  expect("is empty", {"--set", "recording=\"\""});
  expect("no such file", {"--set", "recording=\"none.rec\""});
  auto damaged = recorded.host->stored;
  damaged[damaged.size() / 2] ^= 1;
  write_bytes(folder / "r.rec", damaged);
  expect(file + ": the recording is damaged");
  write_bytes(folder / "r.rec", {'x'});
  expect(file + ": these bytes are no recording");
  damaged = recorded.host->stored;
  damaged[8] = 200;
  write_bytes(folder / "r.rec", damaged);
  expect("of version 200");
  const Outcome sweep =
      run_program({"sweep", recorded.board.scene.string(), "--vary", "time.steps=1,2", "--set",
                   "recording=\"r.rec\"", "--out", folder / "sweep"});
  EXPECT_EQ(sweep.exit_code, 3);
  EXPECT_NE(sweep.err.find("recording is for sunder run and plan"), std::string::npos) << sweep.err;
}

}  // namespace
}  // namespace sunder::test
