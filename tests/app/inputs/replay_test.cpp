// SPDX-License-Identifier: Apache-2.0
// A scene with inputs on the real program, and a scene written for another folder.
#include <gtest/gtest.h>

#include "app/input/scene_toml.hpp"
#include "app/output/program.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

/// The board of the results' tests with inputs of its own beside it.
struct DrivenBoard {
  TempFolder folder;
  TearingBoard board{folder};

  explicit DrivenBoard(const std::string& inputs) {
    write_text(folder / "done.inputs", inputs);
    write_text(board.scene, "inputs = \"done.inputs\"\n" + read_file(board.scene));
  }
  [[nodiscard]] Outcome run(const std::string& command = "run",
                            const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{command, board.scene.string(), "--quiet", "--out",
                                       (folder / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
};

TEST(InputsOfAScene, AreCarriedOutAndEndTheRun) {
  const DrivenBoard board("step\nremove 100 101\ndrive \"right forceps\" 0 -20 0\nframe 2\n");
  const Outcome outcome = board.run();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_csv(board.folder / "out" / "frames.csv").size(), 4U);  // with the header, of five
  const auto summary = read_json(board.folder / "out" / "summary.json");
  const auto& force = summary["reactions"]["right forceps"];
  EXPECT_DOUBLE_EQ(force[1].get<double>(), -20);
  std::vector<int> gone = summary["destroyed"];
  EXPECT_NE(std::find(gone.begin(), gone.end(), 100), gone.end());
  EXPECT_NE(std::find(gone.begin(), gone.end(), 101), gone.end());
}

TEST(InputsOfAScene, AfterTheLastStepChangeTheResultToo) {
  const DrivenBoard board("step\nremove 100\n");
  ASSERT_EQ(board.run().exit_code, 0);
  EXPECT_EQ(read_json(board.folder / "out" / "summary.json")["destroyed"].back(), 100);
}

TEST(InputsOfAScene, ThatAreWrongEndWithTheirLine) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"fly", "done.inputs:1: \"fly\" is no input"},
      {"step\nundo", "done.inputs:2: undo is for sunder view"},
      {"step 6", "done.inputs:1: here the inputs come to 6 steps; the scene has 5"},
      {"remove 99999", "done.inputs:1: there is no element 99999"},
      {"step\nremove 100\nremove 100", "done.inputs:3: element 100"},
  };
  for (const auto& [text, part] : cases) {
    const DrivenBoard board(text);
    const Outcome outcome = board.run();
    EXPECT_EQ(outcome.exit_code, 3) << text;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  }
}

TEST(InputsOfAScene, AreRefusedByASweepAndWhereThereIsNoFile) {
  const DrivenBoard board("step");
  const Outcome sweep = board.run("sweep", {"--vary", "fracture.alpha=1e-6,1e-5"});
  EXPECT_EQ(sweep.exit_code, 3);
  EXPECT_NE(sweep.err.find("inputs is for sunder run, plan and view"), std::string::npos)
      << sweep.err;
  std::filesystem::remove(board.folder / "done.inputs");
  const Outcome run = board.run();
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("done.inputs"), std::string::npos) << run.err;
}

TEST(SceneForAnotherFolder, ReadsTheSame) {
  const std::filesystem::path scenes(SUNDER_SCENES);
  for (const char* name : {"board-grip-b.toml", "finite/liver.toml", "motion/sheet.toml",
                           "two-instruments.toml", "split/board-split.toml"}) {
    SCOPED_TRACE(name);
    const TempFolder folder;
    const std::vector<std::string> overrides{"solver.tolerance=0.30000000000000004"};
    const std::filesystem::path copy = folder / "copy.toml";
    write_text(copy, app::scene_text_for(scenes / name, overrides, folder.path(), ""));
    const Scene before = app::read_scene(scenes / name, overrides);
    const Scene after = app::read_scene(copy);
    EXPECT_EQ(after.title, before.title);
    EXPECT_EQ(after.mesh.nodes, before.mesh.nodes);
    EXPECT_EQ(after.mesh.tets, before.mesh.tets);
    EXPECT_EQ(after.solver.tolerance, before.solver.tolerance);
    EXPECT_EQ(after.steps, before.steps);
    ASSERT_EQ(after.instruments.size(), before.instruments.size());
    for (std::size_t i = 0; i < after.instruments.size(); ++i) {
      EXPECT_EQ(after.instruments[i].name, before.instruments[i].name);
      ASSERT_EQ(after.instruments[i].action.index(), before.instruments[i].action.index());
      if (const auto* grip = std::get_if<Grip>(&after.instruments[i].action)) {
        EXPECT_EQ(grip->displacement, std::get<Grip>(before.instruments[i].action).displacement);
      }
    }
    ASSERT_EQ(after.materials.size(), before.materials.size());
    for (const auto& [volume, material] : before.materials) {
      EXPECT_EQ(after.materials.at(volume).young, material.young);
      EXPECT_EQ(after.materials.at(volume).yield, material.yield);
      EXPECT_EQ(after.materials.at(volume).density, material.density);
    }
    EXPECT_EQ(after.gravity, before.gravity);
    EXPECT_EQ(after.removals.size(), before.removals.size());
  }
}

}  // namespace
}  // namespace sunder::test
