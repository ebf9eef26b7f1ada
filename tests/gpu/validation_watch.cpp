// SPDX-License-Identifier: Apache-2.0
#include "validation_watch.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace sunder::test {
namespace {

/// A pipe that the layer takes for its log file, and the settings that say so. A regular file would
/// not do: each instance would truncate what an earlier one reported.
class Log {
 public:
  Log() {
    // Both ends outlive an exec: instances of child processes report here too. The layer drops
    // repetitions of a message beyond ten, so that a full pipe never stops a test.
    if (pipe2(ends_.data(), O_NONBLOCK) != 0) throw std::runtime_error("no pipe");
    std::string name = (std::filesystem::temp_directory_path() / "sunder-layer-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    folder_ = name;
    std::ofstream(folder_ / "vk_layer_settings.txt")
        << "khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG\n"
        << "khronos_validation.report_flags = error,warn,perf\n"
        << "khronos_validation.log_filename = /proc/self/fd/" << ends_[1] << "\n"
        << "khronos_validation.enable_message_limit = true\n"
        << "khronos_validation.duplicate_message_limit = 10\n"
        << "khronos_validation.enables = "
           "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT\n";
    setenv("VK_LAYER_SETTINGS_PATH", (folder_ / "vk_layer_settings.txt").c_str(), 1);
    setenv("SUNDER_TEST_LAYER_LOG", std::to_string(ends_[1]).c_str(), 1);
  }
  ~Log() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  std::string take() {
    std::string text;
    std::array<char, 4096> part;
    for (ssize_t got; (got = read(ends_[0], part.data(), part.size())) > 0;) {
      text.append(part.data(), static_cast<std::size_t>(got));
    }
    return text;
  }

 private:
  std::array<int, 2> ends_{};
  std::filesystem::path folder_;
};

Log& log() {
  static Log log;
  return log;
}

class Watch : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo&) override { fail_on_messages("before this test"); }
  void OnTestEnd(const testing::TestInfo&) override { fail_on_messages("during this test"); }
  void OnEnvironmentsTearDownStart(const testing::UnitTest&) override {
    fail_on_messages("after the last test");
  }
  static void fail_on_messages(const char* when) {
    const std::string text = take_validation_messages();
    if (!text.empty()) ADD_FAILURE() << "Vulkan validation " << when << ":\n" << text;
  }
};

}  // namespace

void choose_layers(bool validation) {
  std::string layers;  // the first is the program's next
  if (std::getenv("SUNDER_TEST_LAYER")) {
    layers = "VK_LAYER_SUNDER_other_device";
    setenv("VK_ADD_LAYER_PATH", SUNDER_TEST_LAYER_FOLDER, 1);
  }
  if (validation)
    layers += (layers.empty() ? "" : ":") + std::string("VK_LAYER_KHRONOS_validation");
  if (!layers.empty()) setenv("VK_INSTANCE_LAYERS", layers.c_str(), 1);
}

void watch_with_validation() {
  log();
  testing::UnitTest::GetInstance()->listeners().Append(new Watch);  // GoogleTest owns it
}

std::string take_validation_messages() { return log().take(); }

}  // namespace sunder::test
