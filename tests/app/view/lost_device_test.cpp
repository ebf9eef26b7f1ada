// SPDX-License-Identifier: Apache-2.0
// The device is lost under the pictures of sunder view --headless: they go on by another one, to
// the same bytes, or end with what was done on disk.
#include <gtest/gtest.h>

#include "app/output/program.hpp"
#include "app/output/variable.hpp"

namespace sunder::test {
namespace {

constexpr const char* kProbe = "SUNDER_VIEW_PROBE";

/// By a simulation on the processors, and by one on the device that draws.
class LostUnderPictures : public testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] std::filesystem::path out(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] Outcome view(const std::string& name, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"view",    board_.scene.string(), "--headless",
                                       "--out",   out(name).string(),    "--size",
                                       "320x240", "--backend",           GetParam()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  [[nodiscard]] std::vector<std::string> script() const {
    write_text(folder_ / "s.inputs",
               "frame 2\nremove 100\nframe\ngrasp nodes 60\nframe\nundo\nframe\n");
    return {"--script", (folder_ / "s.inputs").string()};
  }
  void expect_same(const std::string& a, const std::string& b) const {
    ASSERT_EQ(names_in(out(a)), names_in(out(b)));
    for (const std::string& name : names_in(out(a))) {
      EXPECT_EQ(read_file(out(a) / name), read_file(out(b) / name)) << name;
    }
  }

  TempFolder folder_;
  TearingBoard board_{folder_};
};

TEST_P(LostUnderPictures, GoOnToTheSameBytes) {
  ASSERT_EQ(view("whole", script()).exit_code, 0);
  for (const char* submits : {"0", "3"}) {
    const Variable probe(kProbe, std::string("submits=") + submits);
    const std::string name = std::string("lost") + submits;
    const Outcome outcome = view(name, script());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("the device was lost"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("new device"), std::string::npos) << outcome.err;
    expect_same("whole", name);
  }
}

TEST_P(LostUnderPictures, GoOnWithTheScenesOwnLoads) {
  ASSERT_EQ(view("whole").exit_code, 0);
  const Variable probe(kProbe, "submits=2");
  const Outcome outcome = view("lost");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("the device was lost"), std::string::npos) << outcome.err;
  expect_same("whole", "lost");
}

TEST_P(LostUnderPictures, WithoutAnotherDeviceARecordingIsLeft) {
  // Two a picture where the simulation leaves its places on the device.
  const bool shares = std::string(GetParam()) == "vulkan";
  const Variable probe(kProbe, shares ? "submits=4,devices=1" : "submits=2,devices=1");
  const Outcome outcome = view("a", script());
  EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
  const std::filesystem::path recording = out("a") / "recording.toml";
  EXPECT_NE(outcome.err.find(recording.string()), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("the device was lost"), std::string::npos) << outcome.err;
  EXPECT_EQ(names_in(out("a")), (std::vector<std::string>{"frame_0001.png", "frame_0002.png",
                                                          "recording.inputs", "recording.toml"}));
  EXPECT_NE(read_file(out("a") / "recording.inputs").find("step 2\nremove 100\nstep"),
            std::string::npos)
      << read_file(out("a") / "recording.inputs");
  const Outcome run =
      run_program({"run", recording.string(), "--quiet", "--out", out("run").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(read_file(out("run") / "events.csv").find(",100,script"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(By, LostUnderPictures, testing::Values("cpu", "vulkan"),
                         [](const auto& info) { return std::string(info.param); });

TEST(ViewProbe, SaysWhatItMayHave) {
  const TempFolder folder;
  const TearingBoard board(folder);
  for (const char* wrong : {"submits", "submits=-1", "submits=x", "lost=1", "submit_file="}) {
    const Variable probe(kProbe, wrong);
    const Outcome outcome =
        run_program({"view", board.scene.string(), "--headless", "--out", (folder / "a").string()});
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_NE(outcome.err.find(std::string("has \"") + wrong + "\""), std::string::npos)
        << outcome.err;
  }
}

}  // namespace
}  // namespace sunder::test
