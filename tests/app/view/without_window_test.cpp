// SPDX-License-Identifier: Apache-2.0
// A build without GLFW and Dear ImGui says what to install, and what there is instead.
#include <gtest/gtest.h>

#include <string>

#include "app/view/window/open_window.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

TEST(WithoutWindow, SaysWhatToInstall) {
  try {
    app::open_window({});
    ADD_FAILURE() << "a window opened";
  } catch (const DeviceError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("install libglfw3-dev and libimgui-dev"), std::string::npos) << said;
    EXPECT_NE(said.find("--headless"), std::string::npos) << said;
    EXPECT_EQ(error.exit_code(), 4);
  }
}

}  // namespace
}  // namespace sunder::test
