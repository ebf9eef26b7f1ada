// SPDX-License-Identifier: Apache-2.0
#include "app/view/window/panels.hpp"

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_vulkan.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace sunder::app {
namespace {

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr float kFontSize = 14;

WindowEvents& events_of(GLFWwindow* window) {
  return *static_cast<WindowEvents*>(glfwGetWindowUserPointer(window));
}

/// Before Dear ImGui, which passes on to it.
void listen(GLFWwindow* window, WindowEvents& events) {
  glfwSetWindowUserPointer(window, &events);
  glfwSetKeyCallback(window, [](GLFWwindow* of, int key, int, int action, int) {
    if (action == GLFW_PRESS) events_of(of).keys.push_back(key);
  });
  glfwSetDropCallback(window, [](GLFWwindow* of, int count, const char** files) {
    events_of(of).files.insert(events_of(of).files.end(), files, files + count);
  });
}

}  // namespace

Panels::Panels(GLFWwindow* window, WindowEvents& events) {
  listen(window, events);
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  std::error_code ignored;
  if (std::filesystem::exists(kFont, ignored)) {
    ImGui::GetIO().Fonts->AddFontFromFileTTF(kFont, kFontSize);
  }
  ImGui_ImplGlfw_InitForVulkan(window, true);
}

void Panels::enter(view::Device& device, view::Swapchain& chain) {
  const std::array<VkDescriptorPoolSize, 1> sizes{
      VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 16}};
  VkDescriptorPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  pool.maxSets = 16;
  pool.poolSizeCount = 1;
  pool.pPoolSizes = sizes.data();
  const auto& vk = device.vk();
  pool_ = view::make<VkDescriptorPool>(device, vk.CreateDescriptorPool, pool,
                                       vk.DestroyDescriptorPool, "vkCreateDescriptorPool");
  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = device.instance();
  info.PhysicalDevice = device.physical();
  info.Device = device.handle();
  info.QueueFamily = device.family();
  info.Queue = device.queue();
  info.DescriptorPool = pool_.get();
  info.MinImageCount = 2;
  info.ImageCount = std::max(2U, chain.image_count());
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  info.CheckVkResultFn = [](VkResult result) { view::check(result, "the panels' part"); };
  ImGui_ImplVulkan_Init(&info, chain.pass());
  device_ = &device;
  chain.once([](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void Panels::leave() {
  if (!device_) return;
  device_->wait_idle();
  ImGui_ImplVulkan_Shutdown();
  pool_ = {};
  device_ = nullptr;
}

Panels::~Panels() {
  leave();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void draw(const Overlay& over) {
  ImDrawList& pen = *ImGui::GetBackgroundDrawList();
  for (const Overlay::Polygon& p : over.polygons) {
    std::vector<ImVec2> corners;
    for (const Vec2& c : p.corners) corners.push_back(at(c));
    pen.AddConvexPolyFilled(corners.data(), static_cast<int>(corners.size()), ink(p.fill));
  }
  for (const Overlay::Line& l : over.lines) {
    pen.AddLine(at(l.from), at(l.to), ink(l.color), static_cast<float>(l.width));
  }
  ImFont* font = ImGui::GetFont();
  for (const Overlay::Text& t : over.texts) {
    const auto size = static_cast<float>(t.size);
    const ImVec2 extent = font->CalcTextSizeA(size, 1e9F, 0, t.words.c_str());
    const float shift = t.anchor == Overlay::Text::Anchor::left     ? 0
                        : t.anchor == Overlay::Text::Anchor::middle ? extent.x / 2
                                                                    : extent.x;
    const ImVec2 corner{static_cast<float>(t.at.x()) - shift,
                        static_cast<float>(t.at.y()) - 0.85F * size};
    pen.AddText(font, size, {corner.x + 1, corner.y + 1}, ink(kBackground), t.words.c_str());
    pen.AddText(font, size, corner, ink(kInk), t.words.c_str());
  }
}

}  // namespace sunder::app
