// SPDX-License-Identifier: Apache-2.0
#include "app/view/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/figure/canvas.hpp"

namespace sunder::app {
namespace {

// Room for text above, the scale of lengths below and that of colours at the right [px].
constexpr double kAbove = 90, kBelow = 84, kLeft = 56, kRight = 150;
// Depth over the radius of what is shown: a body that is drawn out stays within.
constexpr double kDepth = 6;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace

Camera::Camera(const input::Camera& from, const std::optional<Vec3>& at,
               std::span<const Vec3> shown, const PictureSize& size)
    : size_(size) {
  const double a = radians(from.azimuth), e = radians(from.elevation);
  eye_ = {std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
  right_ = {std::cos(a), 0, -std::sin(a)};
  up_ = eye_.cross(right_);
  Bounds bounds;
  double near = -std::numeric_limits<double>::infinity(), far = -near;
  for (const Vec3& p : shown) {
    bounds.add({p.dot(right_), p.dot(up_)});
    near = std::max(near, p.dot(eye_));
    far = std::min(far, p.dot(eye_));
  }
  const Vec2 extent = (bounds.max - bounds.min).cwiseMax(1e-9);
  const Vec2 room(std::max(size.width - kLeft - kRight, 1.0),
                  std::max(size.height - kAbove - kBelow, 1.0));
  scale_ = from.zoom * std::min(room.x() / extent.x(), room.y() / extent.y());
  middle_ = {kLeft + room.x() / 2, kAbove + room.y() / 2};
  const Vec2 mean = (bounds.min + bounds.max) / 2;
  at_ = at ? *at : Vec3(mean.x() * right_ + mean.y() * up_ + (near + far) / 2 * eye_);
  depth_ = kDepth * (extent.norm() + near - far);
}

Vec2 Camera::project(const Vec3& point) const {
  const Vec3 d = turn(point - at_);
  return middle_ + Vec2(d.x(), d.y());
}

Vec3 Camera::turn(const Vec3& direction) const {
  return {scale_ * direction.dot(right_), -scale_ * direction.dot(up_),
          scale_ * direction.dot(eye_)};
}

Vec3 Camera::lift(const Vec2& pixel, double towards) const {
  const Vec2 d = (pixel - middle_) / scale_;
  return at_ + d.x() * right_ - d.y() * up_ + towards * eye_;
}

std::array<float, 16> Camera::matrix() const {
  const Vec2 half(size_.width / 2.0, size_.height / 2.0);
  const Vec3 x = scale_ / half.x() * right_, y = -scale_ / half.y() * up_, z = -0.5 / depth_ * eye_;
  const Vec3 shift(middle_.x() / half.x() - 1 - x.dot(at_), middle_.y() / half.y() - 1 - y.dot(at_),
                   0.5 - z.dot(at_));
  std::array<float, 16> m{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto axis = static_cast<Eigen::Index>(c);
    m[4 * c] = static_cast<float>(x[axis]);
    m[4 * c + 1] = static_cast<float>(y[axis]);
    m[4 * c + 2] = static_cast<float>(z[axis]);
    m[12 + c] = static_cast<float>(shift[axis]);
  }
  m[15] = 1;
  return m;
}

input::Camera standard_camera(const Mesh& mesh) {
  Vec3 low = mesh.nodes.front(), high = low;
  for (const Vec3& x : mesh.nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  Eigen::Index thin = 2;
  const Vec3 extent = high - low;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (extent[axis] < extent[thin]) thin = axis;
  }
  constexpr double kAside = 25, kAbove_deg = 18, kFromAbove = 60;
  if (thin == 0) return {90 - kAside, kAbove_deg, 1};
  if (thin == 1) return {kAside, kFromAbove, 1};
  return {kAside, kAbove_deg, 1};
}

std::vector<Vec3> shown_points(const Problem& problem) {
  std::vector<Vec3> points = problem.mesh().nodes;
  const auto& tools = problem.scene().instruments;
  for (std::size_t i = 0; i < tools.size(); ++i) {
    const auto* grip = std::get_if<Grip>(&tools[i].action);
    if (!grip) continue;
    for (const Index n : problem.instrument_nodes()[i].nodes) {
      points.push_back(problem.mesh().nodes[static_cast<std::size_t>(n)] + grip->displacement);
    }
  }
  return points;
}

input::Cut cut_along(const input::Stroke& stroke, const Camera& camera) {
  input::Cut cut;
  for (const Vec2& share : stroke.line) {
    const Vec2 pixel(share.x() * camera.size().width, share.y() * camera.size().height);
    cut.edge.push_back(camera.lift(pixel, camera.depth()));
    cut.edge.push_back(camera.lift(pixel, -camera.depth()));
  }
  return cut;
}

}  // namespace sunder::app
