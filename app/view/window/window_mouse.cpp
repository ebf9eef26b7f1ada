// SPDX-License-Identifier: Apache-2.0
// What the mouse does: takes hold of tissue, pulls instruments, cuts, turns the camera.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "app/view/window/window.hpp"

namespace sunder::app {
namespace {

constexpr double kTurn = 0.4;       // [deg] of the camera, or of a grip, a pixel
constexpr double kZoom = 1.12;      // a notch of the wheel
constexpr double kReach = 60;       // [px] within which an instrument is taken
constexpr double kTouch = 14;       // [px] within which tissue is
constexpr double kForceDrag = 160;  // [px] that a force's whole value is
constexpr double kStrokeStep = 6;   // [px] between points of a stroke

Vec2 mouse() { return {ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y}; }

}  // namespace

std::optional<Vec3> Window::place_of(std::size_t instrument) const {
  const Shown& shown = *now_.shown;
  const auto& nodes = instrument < shown.state.instruments.size()
                          ? shown.state.instruments[instrument].nodes
                          : problem().instrument_nodes()[instrument].nodes;
  if (nodes.empty()) return std::nullopt;
  Vec3 middle = Vec3::Zero();
  for (const Index n : nodes) middle += shown.places[static_cast<std::size_t>(n)];
  return middle / static_cast<double>(nodes.size());
}

std::optional<std::size_t> Window::instrument_near(const Vec2& p, const Camera& camera) {
  std::optional<std::size_t> nearest;
  double least = kReach;
  for (std::size_t i = 0; i < problem().scene().instruments.size(); ++i) {
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

void Window::take_mouse(const Camera& camera) {
  const Vec2 p = mouse();
  const ImGuiIO& io = ImGui::GetIO();
  if (holds_ == Holds::nothing) {
    if (io.MouseWheel != 0) look_.camera.zoom *= std::pow(kZoom, io.MouseWheel);
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) {
      take_hold(p, camera);
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
      look_.camera.elevation = std::clamp(look_.camera.elevation + kTurn * moved.y(), -89.0, 89.0);
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
    case Holds::tissue:
      follow_grasp();
      move_hand(moved, camera);
      if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) end_hold();
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

void Window::pull(const Vec3& way, const Camera& camera) {
  const Instrument& tool = problem().scene().instruments[held_];
  double factor = 1;
  if (!std::holds_alternative<Grip>(tool.action)) {
    const auto* force = std::get_if<Pull>(&tool.action);
    const double most = force ? force->force.norm() : std::get<Press>(tool.action).force.norm();
    factor = (most > 0 ? most : 1) * camera.pixels_per_mm() / kForceDrag;
  }
  live_.post(input::Drive{tool.name, value_at_ + factor * way, false, held_});
  if (live_.paused()) live_.pause(false);
}

/// The node of the surface that is seen there; none: the mouse is beside the body.
std::optional<Index> Window::node_near(const Vec2& p, const Camera& camera) const {
  const Shown& shown = *now_.shown;
  std::optional<Index> nearest;
  double closest = 0;
  for (const SurfaceTriangle& triangle : shown.triangles) {
    for (const Index n : triangle.nodes) {
      const Vec3& place = shown.places[static_cast<std::size_t>(n)];
      const double distance = (camera.project(place) - p).norm();
      if (distance > kTouch) continue;
      // Of those within reach the one in front; a pixel is worth a pixel of depth.
      const double front = place.dot(camera.eye()) * camera.pixels_per_mm() - distance;
      if (nearest && front <= closest) continue;
      nearest = n;
      closest = front;
    }
  }
  return nearest;
}

/// A grip that was pinned, else an instrument of the scene, else tissue, else the camera.
void Window::take_hold(const Vec2& p, const Camera& camera) {
  for (const LiveSession::HeldNodes& grip : now_.grips) {
    if ((camera.project(grip.place) - p).norm() > kTouch) continue;
    holds_ = Holds::tissue;
    asked_ = pinned_ = false;
    grip_ = grip.grip;
    aim_ = grip.place;
    turn_ = turns_.contains(grip_) ? turns_[grip_] : input::Pose().quaternion;
    haptics_.hold({grip_, aim_, turn_}, grip.of_body);
    return;
  }
  if (const auto near = instrument_near(p, camera)) {
    holds_ = Holds::instrument;
    held_ = *near;
    value_at_ = now_.values.at(held_);
    return;
  }
  const auto node = node_near(p, camera);
  holds_ = node ? Holds::tissue : Holds::camera;
  if (node) grasp(*node);
}

void Window::grasp(Index node) {
  input::Grasp grasp;
  grasp.rigid = patch_ > 0;
  if (patch_ > 0) {
    grasp.near = now_.shown->places[static_cast<std::size_t>(node)];
    grasp.radius = patch_;
  } else {
    grasp.nodes = {node};
  }
  asked_ = true;
  pinned_ = false;
  grip_ = kNone;
  grips_before_ = now_.grips.size();
  way_ = Vec3::Zero();
  turn_ = input::Pose().quaternion;
  live_.post(grasp);
}

/// Once the session has the grip, the hand holds it.
void Window::follow_grasp() {
  if (!asked_) return;
  if (now_.error) {  // told in the panel
    asked_ = false;
    return;
  }
  if (now_.grips.size() <= grips_before_) return;
  asked_ = false;
  grip_ = now_.grips.back().grip;
  aim_ = now_.grips.back().place + way_;
  turns_[grip_] = turn_;
  haptics_.hold({grip_, now_.grips.back().place, turn_}, now_.grips.back().of_body);
  haptics_.aim(aim_, turn_);
  if (live_.paused() && !way_.isZero()) live_.pause(false);
}

/// In the plane of the picture; with shift a patch turns about the picture's axes.
void Window::move_hand(const Vec2& moved, const Camera& camera) {
  if (moved.isZero()) return;
  const Vec3 way = (camera.right() * moved.x() - camera.up() * moved.y()) / camera.pixels_per_mm();
  if (ImGui::GetIO().KeyShift) {
    const double angle = kTurn * moved.norm() * EIGEN_PI / 180;
    const Vec3 axis = (camera.up() * moved.x() + camera.right() * moved.y()).normalized();
    const Eigen::Quaterniond was(turn_[3], turn_[0], turn_[1], turn_[2]),
        next = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)) * was).normalized();
    if (patch_ > 0) turn_ = {next.x(), next.y(), next.z(), next.w()};
  } else if (asked_) {
    way_ += way;
  } else {
    aim_ += way;
  }
  if (grip_ == kNone) return;
  turns_[grip_] = turn_;
  haptics_.aim(aim_, turn_);
  if (live_.paused()) live_.pause(false);
}

/// What is pinned stays where it is held; all else is let go.
void Window::end_hold() {
  if (asked_) return;  // the grip is still to come
  haptics_.let_go();
  if (grip_ != kNone && !pinned_) live_.post(input::Release{grip_});
  grip_ = kNone;
  holds_ = Holds::nothing;
}

void Window::pin() {
  if (holds_ == Holds::tissue) pinned_ = !pinned_;
}

/// Grips as dots, and where the hand is.
void Window::draw_hands(const Camera& camera) const {
  ImDrawList& pen = *ImGui::GetBackgroundDrawList();
  constexpr float kDot = 5;
  for (const LiveSession::HeldNodes& grip : now_.grips) {
    pen.AddCircleFilled(at(camera.project(grip.place)), kDot, ink(kTip));
  }
  const HapticLoop::Now hand = haptics_.now();
  if (hand.holds) pen.AddCircle(at(camera.project(hand.place)), 2 * kDot, ink(kInk), 0, 2);
}

void Window::cut(const Camera& camera) {
  if (stroke_.size() > 1) {
    input::Stroke stroke;
    for (const Vec2& p : stroke_) {
      stroke.line.emplace_back(p.x() / size_.width, p.y() / size_.height);
    }
    live_.post(cut_along(stroke, camera));
  }
  stroke_.clear();
}

void Window::draw_stroke() const {
  ImDrawList& pen = *ImGui::GetBackgroundDrawList();
  for (std::size_t i = 0; i + 1 < stroke_.size(); ++i) {
    pen.AddLine(at(stroke_[i]), at(stroke_[i + 1]), ink(kTip), 2);
  }
}

}  // namespace sunder::app
