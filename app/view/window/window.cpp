// SPDX-License-Identifier: Apache-2.0
#include "app/view/window/window.hpp"

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_vulkan.h>

#include <algorithm>
#include <chrono>
#include <future>

#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr double kWaitSeconds = 1.0 / 60;

/// In motion as fast as it is; else as a film.
std::chrono::duration<double> pace_of(const Problem& problem) {
  constexpr double kFilm = 1.0 / 30;  // [s]
  return std::chrono::duration<double>(problem.moves() ? problem.scene().dynamics->time_step
                                                       : kFilm);
}

}  // namespace

Window::Window(const WindowPlan& plan)
    : plan_(plan),
      window_(make_window(plan)),
      devices_(device_options(plan, window_.get(), surface_)),
      chain_(std::in_place, devices_.now(), surface_.surface),
      session_(plan.make_session(devices_)),
      shown_points_(shown_points(session_->problem())),
      panels_(window_.get(), events_),
      live_(*session_, pace_of),
      now_(live_.now()),
      file_(now_.origin.file),
      haptics_(now_.forces, [this](const input::Pose& pose) { live_.post(pose); }) {
  panels_.enter(devices_.now(), *chain_);
  look_.camera = standard_camera(problem().mesh());
  look_.colour = input::Colour{standard_field(problem()), {}};
  take_measure();
}

Window::~Window() { devices_.now().wait_idle(); }

void Window::run() {
  while (!glfwWindowShouldClose(window_.get())) {
    glfwWaitEventsTimeout(kWaitSeconds);
    now_ = live_.now();
    meet_body();
    take_files();
    try {
      frame();
      shown_on_it_ = true;
    } catch (const DeviceLost& error) {
      recover(error.what());
    }
  }
}

void Window::frame() {
  ImGui_ImplVulkan_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  take_size();
  drop_lost_grip();
  const Camera camera(look_.camera, look_.at, shown_points_, size_);
  if (!ImGui::GetIO().WantCaptureMouse || holds_ != Holds::nothing) take_mouse(camera);
  if (!ImGui::GetIO().WantTextInput) take_keys();
  events_.keys.clear();
  picture(camera);
  draw(painter_->over());
  draw_stroke();
  draw_hands(camera);
  panel();
  scene_panel();
  ImGui::Render();
  chain_->show(painter_->renderer().image(),
               {static_cast<std::uint32_t>(size_.width), static_cast<std::uint32_t>(size_.height)},
               [](VkCommandBuffer commands) {
                 ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
               });
}

/// The device was lost: all that was on it is made anew on another, and the body goes on as it was.
/// Where that cannot be, or a device is lost before it has shown anything, what was done is
/// recorded before the end.
void Window::recover(const std::string& why) {
  ImGui::EndFrame();
  try {
    if (!shown_on_it_) throw DeviceError("it is the second one in a row");
    painter_.reset();
    panels_.leave();
    chain_.reset();
    surface_.end();
    try {
      devices_.renew();
    } catch (const DeviceError&) {
      surface_.surface = VK_NULL_HANDLE;  // what was made went with its instance
      throw;
    }
    chain_.emplace(devices_.now(), surface_.surface);
    panels_.enter(devices_.now(), *chain_);
    shown_on_it_ = false;
    live_.drawn(0);
  } catch (const DeviceError& error) {
    throw DeviceError(why + ", and there is no device in its place: " + error.what() + "; " +
                      keep());
  }
  live_.renew(why + "; there is a new one, and the body is as it was");
}

/// Records what was done, and waits for it.
std::string Window::keep() {
  auto said = std::make_shared<std::promise<std::string>>();
  live_.record([this, said](const std::string& inputs, const Origin& origin) {
    try {
      said->set_value("what was done is recorded: " + plan_.record(inputs, origin));
    } catch (const std::exception& error) {
      said->set_value(std::string("what was done is not recorded: ") + error.what());
    }
  });
  return said->get_future().get();
}

/// An undo, or what has gone wrong, may have taken the grip that is in the hand.
void Window::drop_lost_grip() {
  const auto is_it = [this](const auto& grip) { return grip.grip == grip_; };
  if (grip_ == kNone || std::ranges::any_of(now_.grips, is_it)) return;
  haptics_.let_go();
  grip_ = kNone;
  holds_ = Holds::nothing;
}

void Window::take_size() {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_.get(), &width, &height);
  if (width < 64 || height < 64) {
    if (painter_) return;
    width = plan_.size.width;
    height = plan_.size.height;
  }
  if (painter_ && width == size_.width && height == size_.height) return;
  size_ = {width, height};
  painter_.emplace(devices_.now(), size_);
  live_.drawn(0);
}

void Window::picture(const Camera& camera) {
  const auto start = std::chrono::steady_clock::now();
  painter_->draw(now_.shown, look_, camera);
  live_.drawn(painter_->version());
  using Milliseconds = std::chrono::duration<double, std::milli>;
  drawing_ms_ = Milliseconds(std::chrono::steady_clock::now() - start).count();
}

void Window::take_keys() {
  const auto pressed = [this](int key) {
    return std::ranges::find(events_.keys, key) != events_.keys.end();
  };
  if (pressed(GLFW_KEY_SPACE)) live_.pause(!live_.paused());
  if (pressed(GLFW_KEY_S)) single_step();
  if (pressed(GLFW_KEY_Z)) live_.post(input::Undo{});
  if (pressed(GLFW_KEY_Y)) live_.post(input::Redo{});
  if (pressed(GLFW_KEY_R)) reset();
  if (pressed(GLFW_KEY_E)) record();
  if (pressed(GLFW_KEY_P)) pin();
  if (pressed(GLFW_KEY_W)) look_.wireframe = !look_.wireframe;
  if (pressed(GLFW_KEY_C)) toggle_clip();
  constexpr float kPatches = 10;  // sizes of a patch
  if (pressed(GLFW_KEY_EQUAL) || pressed(GLFW_KEY_KP_ADD)) size_patch(largest_patch_ / kPatches);
  if (pressed(GLFW_KEY_MINUS) || pressed(GLFW_KEY_KP_SUBTRACT)) {
    size_patch(-largest_patch_ / kPatches);
  }
  if (pressed(GLFW_KEY_M)) edits_ = !edits_;
  if (pressed(GLFW_KEY_A)) apply();
  for (int f = 0; f < static_cast<int>(field_names().size()); ++f) {
    if (pressed(GLFW_KEY_1 + f)) colour_by(static_cast<Field>(f));
  }
  if (pressed(GLFW_KEY_ESCAPE)) glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
}

void Window::size_patch(float by) { patch_ = std::clamp(patch_ + by, 0.0F, largest_patch_); }

void Window::single_step() {
  live_.pause(true);
  live_.post(input::Step{});
}

void Window::reset() {
  live_.pause(true);
  live_.post(input::Reset{});
}

void Window::record() {
  live_.record([this](const std::string& inputs, const Origin& origin) {
    try {
      say(plan_.record(inputs, origin));
    } catch (const std::exception& error) {
      say(error.what());
    }
  });
}

/// Beside the picture, until something else is said.
void Window::say(const std::string& sentence) {
  const std::lock_guard lock(said_lock_);
  said_ = sentence;
}

void Window::toggle_clip() {
  if (look_.clip.normal) {
    look_.clip = {};
    return;
  }
  const Camera camera(look_.camera, look_.at, shown_points_, size_);
  look_.clip = {camera.eye(), camera.eye().dot(camera.middle())};
}

void Window::colour_by(Field field) {
  Inputs one{"", {{0, input::Colour{field, {}}}}};
  try {
    resolve(one, problem());
    look_.colour = std::get<input::Colour>(one.list.front().what);
  } catch (const InputError& error) {
    say(error.what());
  }
}

bool Window::computes(Field field) const {
  Inputs one{"", {{0, input::Colour{field, {}}}}};
  try {
    resolve(one, problem());
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace sunder::app

extern "C" __attribute__((visibility("default"))) void sunder_open_window(
    const sunder::app::WindowPlan& plan) {
  sunder::app::Window(plan).run();
}
