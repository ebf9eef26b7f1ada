// SPDX-License-Identifier: Apache-2.0
// The window: what the mouse and the keys do, and what stands beside the picture. Everything else
// is app/view's, which knows neither GLFW nor Dear ImGui.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/view/haptic_loop.hpp"
#include "app/view/live_session.hpp"
#include "app/view/painter.hpp"
#include "app/view/scene_edit.hpp"
#include "app/view/window/panels.hpp"

namespace sunder::app {

class Window {
 public:
  explicit Window(const WindowPlan& plan);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Until it is closed.
  void run();

 private:
  enum class Holds { nothing, camera, middle, instrument, tissue, blade };

  void frame();
  void recover(const std::string& why);
  [[nodiscard]] std::string keep();
  void take_size();
  void picture(const Camera& camera);
  void take_keys();
  void single_step();
  void size_patch(float by);
  void reset();
  void record();
  void toggle_clip();
  void colour_by(Field field);
  [[nodiscard]] bool computes(Field field) const;
  void say(const std::string& sentence);
  /// Whose body is shown.
  [[nodiscard]] const Problem& problem() const { return *now_.shown->problem; }

  // window_mouse.cpp
  [[nodiscard]] std::optional<Vec3> place_of(std::size_t instrument) const;
  [[nodiscard]] std::optional<std::size_t> instrument_near(const Vec2& p, const Camera& camera);
  [[nodiscard]] std::optional<Index> node_near(const Vec2& p, const Camera& camera) const;
  void take_mouse(const Camera& camera);
  void take_hold(const Vec2& p, const Camera& camera);
  void pull(const Vec3& way, const Camera& camera);
  void grasp(Index node);
  void follow_grasp();
  void move_hand(const Vec2& moved, const Camera& camera);
  void end_hold();
  void drop_lost_grip();
  void pin();
  void cut(const Camera& camera);
  void draw_stroke() const;
  void draw_hands(const Camera& camera) const;

  // window_panel.cpp
  void panel();
  void told(const std::string& error) const;
  void buttons();
  void hands();
  void numbers() const;
  void colours();

  // window_scene.cpp
  void meet_body();
  void take_measure();
  void take_files();
  void preparing() const;
  void scene_panel();
  void scene_fields();
  void apply();

  // In this order they come and, the other way round, go.
  const WindowPlan& plan_;
  Glfw glfw_;
  WindowHandle window_;
  WithSurface surface_;
  view::Devices devices_;
  struct Surface {
    WithSurface& of;
    ~Surface() { of.end(); }
  } surface_end_{surface_};
  std::optional<view::Swapchain> chain_;
  std::unique_ptr<Session> session_;
  std::vector<Vec3> shown_points_;
  WindowEvents events_;  // since the last frame
  Panels panels_;
  PictureSize size_;
  std::optional<Painter> painter_;
  std::mutex said_lock_;
  std::string said_;
  LiveSession live_;
  LiveSession::Now now_;
  int body_ = 0;                     // that is shown, by LiveSession::Now
  std::filesystem::path file_;       // it is of
  std::optional<SceneEdit> edited_;  // none: nothing is, since the body has come
  bool edits_ = false;               // the panel for that is there
  Look look_;
  HapticLoop haptics_;
  Holds holds_ = Holds::nothing;
  bool asked_ = false, pinned_ = false;  // of a grip: it is to come, it is to stay
  int grip_ = kNone;                     // in the hand
  std::size_t grips_before_ = 0;
  float largest_patch_ = 1;                       // [mm]
  float patch_ = 0;                               // radius of a grip [mm], 0: a node
  Vec3 aim_ = Vec3::Zero(), way_ = Vec3::Zero();  // of the hand; its way until the grip has come
  std::array<double, 4> turn_{0, 0, 0, 1};
  std::map<int, std::array<double, 4>> turns_;  // of the grips
  std::size_t held_ = 0;
  Vec3 value_at_ = Vec3::Zero();
  Vec2 from_ = Vec2::Zero(), last_ = Vec2::Zero();
  std::vector<Vec2> stroke_;
  double drawing_ms_ = 0;
  bool shown_on_it_ = false;  // a frame, on the device of now
};

}  // namespace sunder::app
