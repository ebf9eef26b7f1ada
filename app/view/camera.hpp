// SPDX-License-Identifier: Apache-2.0
// Where the eye is, and where it sees a point: without perspective, so that a picture has one
// scale.
#pragma once

#include <array>
#include <span>

#include "app/inputs/inputs.hpp"

namespace sunder::app {

/// The body has its place between the text above and the scales at the sides.
class Camera {
 public:
  /// `shown` [mm]: what fits the picture at zoom 1, seen from there; at least one point. `at`: what
  /// is in the middle, none: the middle of them.
  Camera(const input::Camera& from, const std::optional<Vec3>& at, std::span<const Vec3> shown,
         const PictureSize& size);

  /// On the picture [px, y down].
  [[nodiscard]] Vec2 project(const Vec3& point) const;
  /// Of a direction, x and y as of a point, z towards the eye [px].
  [[nodiscard]] Vec3 turn(const Vec3& direction) const;
  /// The point of space that is seen there, `towards` [mm] nearer to the eye than the middle.
  [[nodiscard]] Vec3 lift(const Vec2& pixel, double towards = 0) const;
  [[nodiscard]] double pixels_per_mm() const { return scale_; }
  /// Half the depth that is drawn [mm]: nothing of the body lies beyond it.
  [[nodiscard]] double depth() const { return depth_; }
  [[nodiscard]] const PictureSize& size() const { return size_; }
  /// The point of space in the middle.
  [[nodiscard]] const Vec3& middle() const { return at_; }
  /// Unit vectors of space: to the right, upwards, to the eye.
  [[nodiscard]] const Vec3& right() const { return right_; }
  [[nodiscard]] const Vec3& up() const { return up_; }
  [[nodiscard]] const Vec3& eye() const { return eye_; }
  /// From space to Vulkan's clip space, by columns.
  [[nodiscard]] std::array<float, 16> matrix() const;

 private:
  PictureSize size_;
  Vec3 right_, up_, eye_, at_;
  Vec2 middle_;  // on the picture
  double scale_ = 1, depth_ = 1;
};

/// Looks at a body's broad side, a little from the right and from above.
[[nodiscard]] input::Camera standard_camera(const Mesh& mesh);

/// What a picture of a run is to have room for: the body and where its grips will be.
[[nodiscard]] std::vector<Vec3> shown_points(const Problem& problem);

/// Through all of the body along a line on the picture (input::Stroke).
[[nodiscard]] input::Cut cut_along(const input::Stroke& stroke, const Camera& camera);

}  // namespace sunder::app
