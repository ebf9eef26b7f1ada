// SPDX-License-Identifier: Apache-2.0
// Dear ImGui on the window's device: its set-up, and the overlay by its pen.
#pragma once

#include <string>
#include <vector>

#include "app/view/overlay.hpp"
#include "app/view/window/glfw.hpp"
#include "app/view/window/swapchain.hpp"
// After GLFW.
#include <imgui/imgui.h>

namespace sunder::app {

/// What GLFW tells between two frames.
struct WindowEvents {
  std::vector<int> keys;           ///< pressed; some are let go again between two frames
  std::vector<std::string> files;  ///< dropped on the window
};

/// Dear ImGui for as long as this lives. What happens to the window comes to `events`.
class Panels {
 public:
  /// Without a device yet.
  Panels(GLFWwindow* window, WindowEvents& events);
  ~Panels();
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;

  /// Its part on a device, which must outlive this or leave(). Throws DeviceError, as what is drawn
  /// there does.
  void enter(view::Device& device, view::Swapchain& chain);
  void leave();

 private:
  view::Device* device_ = nullptr;  // null: none
  view::Owned<VkDescriptorPool> pool_;
};

[[nodiscard]] inline ImU32 ink(Color c) { return IM_COL32(c.r, c.g, c.b, 255); }
[[nodiscard]] inline ImVec2 at(const Vec2& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y())};
}

/// With the window's own pen, behind its panels.
void draw(const Overlay& over);

}  // namespace sunder::app
