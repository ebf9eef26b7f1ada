// SPDX-License-Identifier: Apache-2.0
// The door to the window, which is a module of its own: GLFW, Dear ImGui and the Vulkan loader that
// it links nobody else needs.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/view/session.hpp"
#include "app/view/vulkan/device.hpp"

namespace sunder::app {

struct WindowPlan {
  int device = kNone;  ///< as view::DeviceOptions::index
  view::DeviceProbe probe;
  PictureSize size;
  std::string name;  ///< of the window
  /// On the device that the window draws on, whichever that is.
  std::function<std::unique_ptr<Session>(view::Devices&)> make_session;
  /// Writes what was done so far; returns a sentence that says where.
  std::function<std::string(const std::string& inputs, const Origin& origin)> record;
  std::vector<std::string> warnings;  ///< told in it
};

/// Opens it and returns when it is closed. Throws DeviceError where there is no module, no display
/// or no device, and where one that was lost has none in its place: what was done is recorded then.
void open_window(const WindowPlan& plan);

/// What the module offers, by this name.
using OpenWindow = void(const WindowPlan&);
constexpr const char* kOpenWindow = "sunder_open_window";

}  // namespace sunder::app
