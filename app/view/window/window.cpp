// SPDX-License-Identifier: Apache-2.0
// The window: what the mouse and the keys do, and what stands beside the picture. Everything else
// is app/view's, which knows neither GLFW nor Dear ImGui.
#define VK_NO_PROTOTYPES
#include "app/view/window/open_window.hpp"
// Its own declarations of Vulkan's functions are not used here.
#include <GLFW/glfw3.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_vulkan.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/output/text.hpp"
#include "app/view/live_session.hpp"
#include "app/view/painter.hpp"
#include "app/view/window/swapchain.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

using view::Device;
using view::DeviceOptions;

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr float kFontSize = 14;
constexpr double kTurn = 0.4;       // [deg] of the camera a pixel
constexpr double kZoom = 1.12;      // a notch of the wheel
constexpr double kReach = 60;       // [px] within which an instrument is taken
constexpr double kForceDrag = 160;  // [px] that a force's whole value is
constexpr double kStrokeStep = 6;   // [px] between points of a stroke
constexpr double kWaitSeconds = 1.0 / 60;

/// GLFW for as long as this lives.
class Glfw {
 public:
  Glfw() {
    if (glfwInit()) return;
    const char* why = nullptr;
    glfwGetError(&why);
    throw DeviceError(std::string("no window can be opened: ") + (why ? why : "no display") +
                      "; with --headless sunder view writes pictures instead");
  }
  ~Glfw() { glfwTerminate(); }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

struct CloseWindow {
  void operator()(GLFWwindow* window) const { glfwDestroyWindow(window); }
};
using WindowHandle = std::unique_ptr<GLFWwindow, CloseWindow>;

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

/// The surface goes before the instance.
struct WithSurface {
  VkInstance instance = VK_NULL_HANDLE;
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  PFN_vkDestroySurfaceKHR destroy = nullptr;
};

DeviceOptions device_options(const WindowPlan& plan, GLFWwindow* window, WithSurface& made) {
  DeviceOptions options;
  options.index = plan.device;
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

/// Keys as they come: some are pressed and let go between two frames.
std::vector<int>& keys_of(GLFWwindow* window) {
  return *static_cast<std::vector<int>*>(glfwGetWindowUserPointer(window));
}

/// Before Dear ImGui, which passes on to it.
void listen(GLFWwindow* window, std::vector<int>& keys) {
  glfwSetWindowUserPointer(window, &keys);
  glfwSetKeyCallback(window, [](GLFWwindow* of, int key, int, int action, int) {
    if (action == GLFW_PRESS) keys_of(of).push_back(key);
  });
}

/// Dear ImGui for as long as this lives.
class Panels {
 public:
  Panels(GLFWwindow* window, std::vector<int>& keys, Device& device, view::Swapchain& chain)
      : device_(device) {
    listen(window, keys);
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    std::error_code ignored;
    if (std::filesystem::exists(kFont, ignored)) {
      ImGui::GetIO().Fonts->AddFontFromFileTTF(kFont, kFontSize);
    }
    ImGui_ImplGlfw_InitForVulkan(window, true);
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
    ImGui_ImplVulkan_Init(&info, chain.pass());
    chain.once([](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
    ImGui_ImplVulkan_DestroyFontUploadObjects();
  }
  ~Panels() {
    device_.vk().DeviceWaitIdle(device_.handle());
    ImGui_ImplVulkan_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;

 private:
  Device& device_;
  view::Owned<VkDescriptorPool> pool_;
};

ImU32 ink(Color c) { return IM_COL32(c.r, c.g, c.b, 255); }
ImVec2 at(const Vec2& p) { return {static_cast<float>(p.x()), static_cast<float>(p.y())}; }
Vec2 mouse() { return {ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y}; }

/// With the window's own pen, behind its panels.
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

/// In motion as fast as it is; else as a film.
std::chrono::duration<double> pace_of(const Problem& problem) {
  constexpr double kFilm = 1.0 / 30;  // [s]
  return std::chrono::duration<double>(problem.moves() ? problem.scene().dynamics->time_step
                                                       : kFilm);
}

class Window {
 public:
  explicit Window(const WindowPlan& plan)
      : plan_(plan),
        window_(make_window(plan)),
        device_(device_options(plan, window_.get(), surface_)),
        chain_(device_, surface_.surface),
        session_(plan.make_session(device_)),
        shown_points_(shown_points(session_->problem())),
        panels_(window_.get(), keys_, device_, chain_),
        live_(*session_, pace_of(session_->problem())) {
    look_.camera = standard_camera(session_->problem().mesh());
    look_.colour = input::Colour{standard_field(session_->problem()), {}};
  }
  ~Window() { device_.vk().DeviceWaitIdle(device_.handle()); }

  void run() {
    while (!glfwWindowShouldClose(window_.get())) {
      glfwWaitEventsTimeout(kWaitSeconds);
      now_ = live_.now();
      ImGui_ImplVulkan_NewFrame();
      ImGui_ImplGlfw_NewFrame();
      ImGui::NewFrame();
      take_size();
      const Camera camera(look_.camera, look_.at, shown_points_, size_);
      if (!ImGui::GetIO().WantCaptureMouse || holds_ != Holds::nothing) take_mouse(camera);
      if (!ImGui::GetIO().WantTextInput) take_keys();
      keys_.clear();
      picture(camera);
      draw(painter_->over());
      draw_stroke();
      panel();
      ImGui::Render();
      chain_.show(
          painter_->renderer().image(),
          {static_cast<std::uint32_t>(size_.width), static_cast<std::uint32_t>(size_.height)},
          [](VkCommandBuffer commands) {
            ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
          });
    }
  }

 private:
  enum class Holds { nothing, camera, middle, instrument, blade };

  void take_size() {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_.get(), &width, &height);
    if (width < 64 || height < 64) {
      if (painter_) return;
      width = plan_.size.width;
      height = plan_.size.height;
    }
    if (painter_ && width == size_.width && height == size_.height) return;
    size_ = {width, height};
    painter_.emplace(device_, session_->problem(), size_);
    live_.drawn(0);
  }

  /// Where an instrument acts now; none: it does not.
  [[nodiscard]] std::optional<Vec3> place_of(std::size_t instrument) const {
    const Shown& shown = *now_.shown;
    const auto& nodes = instrument < shown.state.instruments.size()
                            ? shown.state.instruments[instrument].nodes
                            : session_->problem().instrument_nodes()[instrument].nodes;
    if (nodes.empty()) return std::nullopt;
    Vec3 middle = Vec3::Zero();
    for (const Index n : nodes) middle += shown.places[static_cast<std::size_t>(n)];
    return middle / static_cast<double>(nodes.size());
  }

  [[nodiscard]] std::optional<std::size_t> instrument_near(const Vec2& p, const Camera& camera) {
    std::optional<std::size_t> nearest;
    double least = kReach;
    for (std::size_t i = 0; i < session_->problem().scene().instruments.size(); ++i) {
      const auto place = place_of(i);
      if (!place) continue;
      const double distance = (camera.project(*place) - p).norm();
      if (distance < least) {
        least = distance;
        nearest = i;
      }
    }
    return nearest;
  }

  void take_mouse(const Camera& camera) {
    const Vec2 p = mouse();
    const ImGuiIO& io = ImGui::GetIO();
    if (holds_ == Holds::nothing) {
      if (io.MouseWheel != 0) look_.camera.zoom *= std::pow(kZoom, io.MouseWheel);
      if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
        const auto near = instrument_near(p, camera);
        holds_ = near ? Holds::instrument : Holds::camera;
        if (near) {
          held_ = *near;
          value_at_ = now_.values.at(held_);
        }
      } else if (ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
        holds_ = Holds::blade;
        stroke_ = {p};
      } else if (ImGui::IsMouseClicked(ImGuiMouseButton_Middle)) {
        holds_ = Holds::middle;
      }
      from_ = last_ = p;
      return;
    }
    const Vec2 moved = p - last_;
    last_ = p;
    switch (holds_) {
      case Holds::camera:
        look_.camera.azimuth -= kTurn * moved.x();
        look_.camera.elevation =
            std::clamp(look_.camera.elevation + kTurn * moved.y(), -89.0, 89.0);
        if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) holds_ = Holds::nothing;
        break;
      case Holds::middle:
        look_.at = camera.lift(camera.project(camera.middle()) - moved);
        if (!ImGui::IsMouseDown(ImGuiMouseButton_Middle)) holds_ = Holds::nothing;
        break;
      case Holds::instrument:
        if (!moved.isZero()) pull(camera.lift(p) - camera.lift(from_), camera);
        if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) holds_ = Holds::nothing;
        break;
      case Holds::blade:
        if ((p - stroke_.back()).norm() > kStrokeStep) stroke_.push_back(p);
        if (!ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
          cut(camera);
          holds_ = Holds::nothing;
        }
        break;
      default:
        break;
    }
  }

  /// A grip goes with the mouse, in the plane of the picture; a force grows with the way.
  void pull(const Vec3& way, const Camera& camera) {
    const Instrument& tool = session_->problem().scene().instruments[held_];
    double factor = 1;
    if (!std::holds_alternative<Grip>(tool.action)) {
      const auto* force = std::get_if<Pull>(&tool.action);
      const double most = force ? force->force.norm() : std::get<Press>(tool.action).force.norm();
      factor = (most > 0 ? most : 1) * camera.pixels_per_mm() / kForceDrag;
    }
    live_.post(input::Drive{tool.name, value_at_ + factor * way, false, held_});
    if (live_.paused()) live_.pause(false);
  }

  void cut(const Camera& camera) {
    if (stroke_.size() > 1) {
      input::Stroke stroke;
      for (const Vec2& p : stroke_) {
        stroke.line.emplace_back(p.x() / size_.width, p.y() / size_.height);
      }
      live_.post(cut_along(stroke, camera));
    }
    stroke_.clear();
  }

  void draw_stroke() const {
    ImDrawList& pen = *ImGui::GetBackgroundDrawList();
    for (std::size_t i = 0; i + 1 < stroke_.size(); ++i) {
      pen.AddLine(at(stroke_[i]), at(stroke_[i + 1]), ink(kTip), 2);
    }
  }

  void take_keys() {
    const auto pressed = [this](int key) { return std::ranges::find(keys_, key) != keys_.end(); };
    if (pressed(GLFW_KEY_SPACE)) live_.pause(!live_.paused());
    if (pressed(GLFW_KEY_S)) single_step();
    if (pressed(GLFW_KEY_Z)) live_.post(input::Undo{});
    if (pressed(GLFW_KEY_Y)) live_.post(input::Redo{});
    if (pressed(GLFW_KEY_R)) reset();
    if (pressed(GLFW_KEY_E)) record();
    if (pressed(GLFW_KEY_W)) look_.wireframe = !look_.wireframe;
    if (pressed(GLFW_KEY_C)) toggle_clip();
    for (int f = 0; f < static_cast<int>(field_names().size()); ++f) {
      if (pressed(GLFW_KEY_1 + f)) colour_by(static_cast<Field>(f));
    }
    if (pressed(GLFW_KEY_ESCAPE)) glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
  }

  void single_step() {
    live_.pause(true);
    live_.post(input::Step{});
  }
  void reset() {
    live_.pause(true);
    live_.post(input::Reset{});
  }
  void record() {
    live_.record([this](const std::string& inputs) {
      std::string said;
      try {
        said = plan_.record(inputs);
      } catch (const std::exception& error) {
        said = error.what();
      }
      const std::lock_guard lock(said_lock_);
      said_ = said;
    });
  }
  void toggle_clip() {
    if (look_.clip.normal) {
      look_.clip = {};
      return;
    }
    const Camera camera(look_.camera, look_.at, shown_points_, size_);
    look_.clip = {camera.eye(), camera.eye().dot(camera.middle())};
  }
  void colour_by(Field field) {
    Inputs one{"", {{0, input::Colour{field, {}}}}};
    try {
      resolve(one, session_->problem());
      look_.colour = std::get<input::Colour>(one.list.front().what);
    } catch (const InputError& error) {
      const std::lock_guard lock(said_lock_);
      said_ = error.what();
    }
  }

  void picture(const Camera& camera) {
    const auto start = std::chrono::steady_clock::now();
    painter_->draw(now_.shown, look_, camera);
    live_.drawn(painter_->version());
    using Milliseconds = std::chrono::duration<double, std::milli>;
    drawing_ms_ = Milliseconds(std::chrono::steady_clock::now() - start).count();
  }

  void panel() {
    ImGui::SetNextWindowPos(
        {static_cast<float>(size_.width) - 8, static_cast<float>(size_.height) - 8},
        ImGuiCond_Always, {1, 1});
    ImGui::SetNextWindowBgAlpha(0.75F);
    ImGui::Begin("sunder", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    buttons();
    numbers();
    colours();
    ImGui::TextDisabled("left: an instrument, or turn; right: cut; middle: shift; wheel: zoom");
    for (const std::string& line : now_.ruptures) ImGui::TextUnformatted(line.c_str());
    if (now_.error) told(*now_.error);
    {
      const std::lock_guard lock(said_lock_);
      if (!said_.empty()) ImGui::TextWrapped("%s", said_.c_str());
    }
    for (const std::string& warning : plan_.warnings) ImGui::TextWrapped("%s", warning.c_str());
    ImGui::End();
  }

  void told(const std::string& error) const {
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.6F, 0.4F, 1));
    ImGui::TextWrapped("paused: %s", error.c_str());
    ImGui::PopStyleColor();
  }

  void buttons() {
    if (ImGui::Button(live_.paused() ? "go (space)" : "pause (space)")) {
      live_.pause(!live_.paused());
    }
    ImGui::SameLine();
    if (ImGui::Button("step (S)")) single_step();
    ImGui::SameLine();
    if (ImGui::Button("reset (R)")) reset();
    if (ImGui::Button("undo (Z)")) live_.post(input::Undo{});
    ImGui::SameLine();
    if (ImGui::Button("redo (Y)")) live_.post(input::Redo{});
    ImGui::SameLine();
    if (ImGui::Button("record (E)")) record();
    ImGui::Text("%d to undo, %d to redo%s", now_.undos, now_.redos,
                now_.done ? "; all steps done (--steps N)" : "");
  }

  void numbers() const {
    const auto& report = now_.shown->report;
    if (!report) {
      ImGui::Text("drawn in %.1f ms", drawing_ms_);
      return;
    }
    const StageTimes& t = report->times;
    ImGui::Text("step %.2f ms: load %.2f  solve %.2f  stress %.2f", t.total, t.load, t.solve,
                t.stress);
    ImGui::Text("  decide %.2f  update %.2f;  drawn in %.1f ms", t.decide, t.update, drawing_ms_);
    ImGui::Text("error %.1e  back-solves %d", report->error, report->back_solves);
    if (!report->deformation) return;
    const bool small = !session_->problem().finite();
    ImGui::Text("strain %.1f %%%s  rotation %.1f deg%s", 100 * report->deformation->strain,
                small ? " (law linear: to 10)" : "", report->deformation->rotation_deg,
                small ? " (to 10)" : "");
  }

  void colours() {
    int field = static_cast<int>(look_.colour->field);
    std::string names;
    for (const std::string& name : field_names()) names += name + '\0';
    ImGui::SetNextItemWidth(140);
    if (ImGui::Combo("colour (1-4)", &field, names.c_str())) colour_by(static_cast<Field>(field));
    ImGui::SameLine();
    bool fixed = look_.colour->maximum.has_value();
    if (ImGui::Checkbox("fixed scale", &fixed)) {
      look_.colour->maximum = fixed ? std::optional(1.0) : std::nullopt;
    }
    if (fixed) {
      ImGui::SameLine();
      double end = *look_.colour->maximum;
      ImGui::SetNextItemWidth(90);
      if (ImGui::InputDouble("end", &end, 0, 0, "%.3g") && end > 0) look_.colour->maximum = end;
    }
    ImGui::Checkbox("wireframe (W)", &look_.wireframe);
    ImGui::SameLine();
    ImGui::Checkbox("arrows", &look_.arrows);
    ImGui::SameLine();
    ImGui::Checkbox("tips", &look_.tips);
    ImGui::SameLine();
    bool clipped = look_.clip.normal.has_value();
    if (ImGui::Checkbox("clip (C)", &clipped)) toggle_clip();
    if (look_.clip.normal) {
      auto offset = static_cast<float>(look_.clip.offset);
      const Camera camera(look_.camera, look_.at, shown_points_, size_);
      const auto middle = static_cast<float>(look_.clip.normal->dot(camera.middle()));
      const auto half = static_cast<float>(camera.depth() / 12);
      ImGui::SliderFloat("clip at [mm]", &offset, middle - half, middle + half);
      look_.clip.offset = offset;
    }
  }

  // In this order they come and, the other way round, go.
  const WindowPlan& plan_;
  Glfw glfw_;
  WindowHandle window_;
  WithSurface surface_;
  Device device_;
  struct Surface {
    WithSurface& of;
    ~Surface() {
      if (of.surface) of.destroy(of.instance, of.surface, nullptr);
    }
  } surface_end_{surface_};
  view::Swapchain chain_;
  std::unique_ptr<Session> session_;
  std::vector<Vec3> shown_points_;
  std::vector<int> keys_;  // pressed since the last frame
  Panels panels_;
  PictureSize size_;
  std::optional<Painter> painter_;
  std::mutex said_lock_;
  std::string said_;
  LiveSession live_;
  LiveSession::Now now_;
  Look look_;
  Holds holds_ = Holds::nothing;
  std::size_t held_ = 0;
  Vec3 value_at_ = Vec3::Zero();
  Vec2 from_ = Vec2::Zero(), last_ = Vec2::Zero();
  std::vector<Vec2> stroke_;
  double drawing_ms_ = 0;
};

}  // namespace
}  // namespace sunder::app

extern "C" __attribute__((visibility("default"))) void sunder_open_window(
    const sunder::app::WindowPlan& plan) {
  sunder::app::Window(plan).run();
}
