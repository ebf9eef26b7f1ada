// SPDX-License-Identifier: Apache-2.0
#include "app/view/window/glfw.hpp"

#include <string>

#include "sunder/error.hpp"

namespace sunder::app {

Glfw::Glfw() {
  if (glfwInit()) return;
  const char* why = nullptr;
  glfwGetError(&why);
  throw DeviceError(std::string("no window can be opened: ") + (why ? why : "no display") +
                    "; with --headless sunder view writes pictures instead");
}

WindowHandle make_window(const WindowPlan& plan) {
  if (!glfwVulkanSupported()) {
    throw DeviceError(
        "the window has no Vulkan to draw with; install libvulkan1 and a driver, "
        "mesa-vulkan-drivers say");
  }
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  WindowHandle window(
      glfwCreateWindow(plan.size.width, plan.size.height, plan.name.c_str(), nullptr, nullptr));
  if (window) return window;
  const char* why = nullptr;
  glfwGetError(&why);
  throw DeviceError(std::string("no window can be opened: ") + (why ? why : "unknown cause"));
}

view::DeviceOptions device_options(const WindowPlan& plan, GLFWwindow* window, WithSurface& made) {
  view::DeviceOptions options;
  options.index = plan.device;
  options.probe = plan.probe;
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (names) options.instance_extensions.assign(names, names + count);
  options.device_extensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  options.with_instance = [&made, window](VkInstance instance, PFN_vkGetInstanceProcAddr get) {
    made.instance = instance;
    made.destroy = reinterpret_cast<PFN_vkDestroySurfaceKHR>(get(instance, "vkDestroySurfaceKHR"));
    view::check(glfwCreateWindowSurface(instance, window, nullptr, &made.surface),
                "glfwCreateWindowSurface");
  };
  options.presents = [&made](VkPhysicalDevice device, std::uint32_t family) {
    return glfwGetPhysicalDevicePresentationSupport(made.instance, device, family) == GLFW_TRUE;
  };
  return options;
}

}  // namespace sunder::app
