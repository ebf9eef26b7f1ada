// SPDX-License-Identifier: Apache-2.0
// Wrong command lines and inputs of sunder view: one sentence each, before a device is asked for.
#include <gtest/gtest.h>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

Outcome view(const std::vector<std::string>& more, const std::string& scene = "board-grip-b") {
  std::vector<std::string> arguments{"view", std::string(SUNDER_SCENES) + "/" + scene + ".toml",
                                     "--headless", "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

void expect_refused(const Outcome& outcome, int exit_code, const std::string& part) {
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

TEST(ViewArguments, ThatAreWrongAreNamed) {
  const TempFolder folder;
  const std::string out = (folder / "out").string();
  expect_refused(view({"--frames", "0"}), 2, "--frames is \"0\"");
  expect_refused(view({"--frames", "many"}), 2, "--frames is \"many\"");
  expect_refused(view({"--size", "960"}), 2, "--size is \"960\"; allowed is WIDTHxHEIGHT");
  expect_refused(view({"--size", "10x900"}), 2, "--size is \"10x900\"");
  expect_refused(view({"--size", "900x9000"}), 2, "--size is \"900x9000\"");
  expect_refused(view({"--script", ""}), 2, "--script is \"\"");
  expect_refused(view({"--out", ""}), 2, "--out is \"\"");
  expect_refused(view({"--script", (folder / "none").string(), "--out", out}), 3, "none");
  expect_refused(view({"--headles"}), 2, "perhaps --headless was meant");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(ViewArguments, AScriptsWrongLineIsNamedBeforeAnythingIsWritten) {
  const TempFolder folder;
  const std::string script = (folder / "s.inputs").string(), out = (folder / "out").string();
  write_text(script, "camera 0 0\nremove 99999\nframe\n");
  expect_refused(view({"--script", script, "--out", out}), 3,
                 "s.inputs:2: there is no element 99999");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(ViewArguments, WrongGripsAreNamed) {
  const TempFolder folder;
  const std::string script = (folder / "s.inputs").string();
  const auto expect = [&](const std::string& line, const std::string& part,
                          const std::string& scene = "board-grip-b") {
    write_text(script, line + "\nframe\n");
    expect_refused(view({"--script", script, "--out", folder / "out"}, scene), 3,
                   "s.inputs:1: " + part);
  };
  expect("pose 0 1 2 3", "grip 0 is an instrument of the scene");
  expect("release 0", "instrument 0 holds nothing", "board-pull-b");
  expect("grasp nodes 1 99999", "there is no node 99999");
  expect("grasp 1 2 3 0", "the radius of a grip must be above 0 mm");
  expect("grasp nodes 1 stiff", "a node to grasp");
  expect("grasp 1 2 3 4 stiff", "rigid or nothing");
  expect("pose 1 1 2 3 0 0 0 0", "the grip's quaternion is 0 0 0 0");
  expect("pose 1 1 2 3 0 0", "the grip's quaternion");
}

TEST(ViewArguments, AFolderThatCannotBeWrittenToIsRefused) {
  const TempFolder folder;
  write_text(folder / "file", "x");
  expect_refused(view({"--out", (folder / "file").string()}), 2, "it is a file");
}

TEST(ViewArguments, ASceneWithInputsTakesNoScript) {
  const TempFolder folder;
  const TearingBoard board(folder);
  write_text(folder / "a.inputs", "step\n");
  write_text(board.scene, "inputs = \"a.inputs\"\n" + read_file(board.scene));
  const Outcome outcome =
      run_program({"view", board.scene.string(), "--headless", "--script",
                   (folder / "a.inputs").string(), "--out", (folder / "out").string()});
  expect_refused(outcome, 2, "the scene has inputs of its own");
}

}  // namespace
}  // namespace sunder::test
