// SPDX-License-Identifier: Apache-2.0
// GLFW's window, and what a device needs to draw into it.
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>
// Its own declarations of Vulkan's functions are not used here.
#include <GLFW/glfw3.h>

#include <memory>

#include "app/view/vulkan/device.hpp"
#include "app/view/window/open_window.hpp"

namespace sunder::app {

/// GLFW for as long as this lives. Throws DeviceError where there is no display.
class Glfw {
 public:
  Glfw();
  ~Glfw() { glfwTerminate(); }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

struct CloseWindow {
  void operator()(GLFWwindow* window) const { glfwDestroyWindow(window); }
};
using WindowHandle = std::unique_ptr<GLFWwindow, CloseWindow>;

/// Throws DeviceError.
[[nodiscard]] WindowHandle make_window(const WindowPlan& plan);

/// The surface goes before the instance.
struct WithSurface {
  VkInstance instance = VK_NULL_HANDLE;
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  PFN_vkDestroySurfaceKHR destroy = nullptr;

  void end() {
    if (surface) destroy(instance, surface, nullptr);
    surface = VK_NULL_HANDLE;
  }
};

/// Of a device that can present; the surface is `made` with the instance.
[[nodiscard]] view::DeviceOptions device_options(const WindowPlan& plan, GLFWwindow* window,
                                                 WithSurface& made);

}  // namespace sunder::app
