// SPDX-License-Identifier: Apache-2.0
// sunder view --headless as a user starts it, under validation as every test here.
#include <gtest/gtest.h>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

struct Board {
  TempFolder folder;
  TearingBoard board{folder};

  [[nodiscard]] std::filesystem::path out(const std::string& name) const { return folder / name; }
  [[nodiscard]] Outcome view(const std::string& name, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"view",  board.scene.string(), "--headless", "--quiet",
                                       "--out", out(name).string(),   "--size",     "320x240"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  [[nodiscard]] std::string script(const std::string& text) const {
    write_text(folder / "s.inputs", text);
    return (folder / "s.inputs").string();
  }
  /// What a run of the recording leaves has the bits that the view left.
  void expect_replayed(const std::string& name) const {
    const Outcome run = run_program({"run", (out(name) / "recording.toml").string(), "--quiet",
                                     "--out", out(name + "-run").string()});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    for (const char* file : {"result.vtu", "events.csv"}) {
      EXPECT_EQ(read_file(out(name) / file), read_file(out(name + "-run") / file)) << file;
    }
  }
};

TEST(Headless, TheScenesOwnLoadsPlayAStepAFrame) {
  const Board board;
  const Outcome outcome = board.view("a");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(names_in(board.out("a")),
            (std::vector<std::string>{"events.csv", "film.png", "frame_0001.png", "frame_0002.png",
                                      "frame_0003.png", "frame_0004.png", "frame_0005.png",
                                      "recording.toml", "result.vtu"}));
  board.expect_replayed("a");
  // No input was recorded: the recording is the scene, and its result the scene's.
  const Outcome run = run_program(
      {"run", board.board.scene.string(), "--quiet", "--out", board.out("scene").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_file(board.out("a") / "result.vtu"), read_file(board.out("scene") / "result.vtu"));
}

TEST(Headless, TheSameSceneTwiceGivesTheSameBytes) {
  const Board board;
  const std::string script = board.script("camera 40 20\nwireframe on\nframe 2\nremove 100\nframe");
  ASSERT_EQ(board.view("a", {"--script", script}).exit_code, 0);
  ASSERT_EQ(board.view("b", {"--script", script}).exit_code, 0);
  for (const std::string& name : names_in(board.out("a"))) {
    EXPECT_EQ(read_file(board.out("a") / name), read_file(board.out("b") / name)) << name;
  }
}

TEST(Headless, AScriptPullsCutsAndGoesBackAndARunReplaysWhatIsLeft) {
  const Board board;
  const std::string script = board.script(
      "camera 0 0\n"
      "frame\n"  // 1
      "drive \"right forceps\" 0 -60 0\n"
      "frame\n"  // 2
      "pause\n"
      "stroke .2 .5 .45 .5\n"
      "frame\n"  // 3: cut
      "undo\n"
      "frame\n"  // 4: as 2
      "redo\n"
      "frame\n"  // 5: as 3
      "go\n"
      "colour displacement\n"
      "frame 2\n");
  const Outcome outcome = board.view("a", {"--script", script});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto frame = [&](int i) {
    return read_file(board.out("a") / ("frame_000" + std::to_string(i) + ".png"));
  };
  EXPECT_NE(frame(2), frame(3));
  EXPECT_EQ(frame(4), frame(2));
  EXPECT_EQ(frame(5), frame(3));
  EXPECT_NE(frame(6), frame(5));
  board.expect_replayed("a");
  const std::string inputs = read_file(board.out("a") / "recording.inputs");
  EXPECT_EQ(inputs.find("undo"), std::string::npos);
  EXPECT_NE(inputs.find("remove "), std::string::npos) << inputs;
}

TEST(Headless, AScriptGraspsTurnsAndLetsGoAndARunReplaysIt) {
  const Board board;
  const std::string script = board.script(
      "frame\n"  // 1
      "grasp 50 25 1.25 6 rigid\n"
      "pose 1 53 24 1.25 0 0 .1 1\n"
      "frame\n"  // 2
      "reset\n"  // the grasp goes, and what came after it
      "frame\n"  // 3
      "grasp nodes 60\n"
      "grasp 50 25 1.25 6 rigid\n"
      "pose 2 53 24 1.25 0 0 .1 1\n"
      "frame\n"  // 4
      "release 2\n"
      "frame\n");
  const Outcome outcome = board.view("a", {"--script", script});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string inputs = read_file(board.out("a") / "recording.inputs");
  EXPECT_NE(inputs.find("grasp nodes 60\ngrasp 50 25 1.25 6 rigid\npose 2 53 24 1.25 0 0 0.1 1\n"),
            std::string::npos)
      << inputs;
  EXPECT_NE(inputs.find("release 2"), std::string::npos) << inputs;
  board.expect_replayed("a");
}

TEST(Headless, AMeshAloneIsTissueThatAHandTears) {
  const Board board;
  const std::string script =
      board.script("frame\ngrasp 25 50 1.25 8 rigid\npose 0 25 90 1.25\nframe\nrelease 0\nframe\n");
  const Outcome outcome =
      run_program({"view", (board.folder / "board.msh").string(), "--headless", "--quiet", "--size",
                   "320x240", "--out", board.out("m").string(), "--script", script});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(board.out("m") / "frame_0003.png"));
  EXPECT_NE(read_file(board.out("m") / "events.csv").find("mss"), std::string::npos)
      << "it has torn";
  board.expect_replayed("m");
  const Outcome plain = run_program({"view", (board.folder / "board.msh").string(), "--headless",
                                     "--quiet", "--out", board.out("p").string()});
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_TRUE(std::filesystem::exists(board.out("p") / "frame_0001.png"));
  EXPECT_FALSE(std::filesystem::exists(board.out("p") / "frame_0002.png"));
  const Outcome none = run_program({"view", (board.folder / "none.msh").string(), "--headless"});
  EXPECT_EQ(none.exit_code, 3) << none.err;
  const Outcome run = run_program({"run", (board.folder / "board.msh").string()});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("is a mesh, not a scene"), std::string::npos) << run.err;
}

TEST(Headless, LawCrackWayAndMaterialChangeAndTheRecordingIsOfTheChangedBody) {
  const Board board;
  const std::string script = board.script(
      "frame 2\n"
      "grasp 50 25 1.25 6 rigid\n"
      "set material.lower.young=2 \"material.'upper'.yield=3\"\n"
      "pose 1 52 24 1.25\n"  // the grip that has gone along
      "frame\n"
      "set fracture.crack=split fracture.sif=field\n"
      "cut -1 30 -1 -1 30 5 18 30 -1 18 30 5\n"
      "frame 2\n"
      "set material.lower.law=corotated\n"
      "frame\n");
  const Outcome outcome = board.view("a", {"--script", script});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(board.out("a") / "frame_0006.png"));
  const std::string scene = read_file(board.out("a") / "recording.toml");
  for (const char* part : {"young = 2", "'split'", "'corotated'"}) {
    EXPECT_NE(scene.find(part), std::string::npos) << part << "\n" << scene;
  }
  EXPECT_NE(read_file(board.out("a") / "recording.inputs").find("grasp nodes"), std::string::npos);
  board.expect_replayed("a");
}

TEST(Headless, AChangeOnVulkanIsPreparedOnTheDeviceThatDraws) {
  const Board board;
  const Outcome outcome =
      board.view("a", {"--backend", "vulkan", "--script",
                       board.script("frame\nremove 100\nset material.lower.young=2\nframe\n")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("vulkan"), std::string::npos) << outcome.out;
  board.expect_replayed("a");
}

TEST(Headless, AnotherFileIsOpenedAndABadOneNamesItsLine) {
  const Board board;
  const std::string mesh = (board.folder / "board.msh").string();
  ASSERT_EQ(board.view("a", {"--script", board.script("frame\nopen \"" + mesh + "\"\nframe\n")})
                .exit_code,
            0);
  board.expect_replayed("a");
  EXPECT_NE(read_file(board.out("a") / "recording.toml").find("0.05"), std::string::npos)
      << "the scene of the mesh";
  const Outcome bad = board.view("b", {"--script", board.script("frame\nopen none.toml\nframe\n")});
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_NE(bad.err.find("s.inputs:2: "), std::string::npos) << bad.err;
  EXPECT_NE(bad.err.find("none.toml"), std::string::npos) << bad.err;
  const Outcome odd =
      board.view("c", {"--script", board.script("frame\nset material.lower.law=lineal\nframe\n")});
  EXPECT_EQ(odd.exit_code, 3);
  EXPECT_NE(odd.err.find("s.inputs:2: --set material.lower.law=lineal"), std::string::npos)
      << odd.err;
}

TEST(Headless, FramesBoundTheScriptAndGoOnAfterIt) {
  const Board board;
  const std::string script = board.script("frame 3\nremove 100\n");
  ASSERT_EQ(board.view("a", {"--script", script, "--frames", "2"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(board.out("a") / "frame_0003.png"));
  ASSERT_EQ(board.view("b", {"--script", script, "--frames", "4"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(board.out("b") / "frame_0004.png"));
  EXPECT_NE(read_file(board.out("b") / "events.csv").find(",100,script"), std::string::npos);
}

TEST(Headless, PicturesOfAnEarlierRunGoAndOtherFilesStay) {
  const Board board;
  ASSERT_EQ(board.view("a").exit_code, 0);
  write_text(board.out("a") / "mine.txt", "x");
  ASSERT_EQ(board.view("a", {"--frames", "1"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(board.out("a") / "frame_0002.png"));
  EXPECT_EQ(read_file(board.out("a") / "mine.txt"), "x");
}

TEST(Headless, AnInputThatTheBodyRefusesNamesItsLine) {
  const Board board;
  const Outcome outcome =
      board.view("a", {"--script", board.script("frame\nremove 100\nremove 100\nframe")});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("s.inputs:3: element 100"), std::string::npos) << outcome.err;
  EXPECT_EQ(board.view("b", {"--script", board.script("undo")}).exit_code, 3);
}

TEST(Headless, ARunOnVulkanSharesTheDevice) {
  const Board board;
  const Outcome outcome = board.view(
      "a", {"--backend", "vulkan", "--script", board.script("frame 2\nremove 100\nframe")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("vulkan"), std::string::npos) << outcome.out;
  board.expect_replayed("a");
}

}  // namespace
}  // namespace sunder::test
