// SPDX-License-Identifier: Apache-2.0
// Where the eye sees a point, by hand values.
#include "app/view/camera.hpp"

#include <gtest/gtest.h>

#include "core/frame/strip.hpp"

namespace sunder::test {
namespace {

using namespace app;

constexpr PictureSize kSize{800, 600};
const std::vector<Vec3> kCube{{0, 0, 0}, {10, 10, 10}};

Camera camera(double azimuth, double elevation, double zoom = 1) {
  return {{azimuth, elevation, zoom}, {}, kCube, kSize};
}

TEST(Camera, FromTheFrontHasXToTheRightAndYUp) {
  const Camera front = camera(0, 0);
  const Vec2 middle = front.project({5, 5, 5});
  const double scale = front.pixels_per_mm();
  EXPECT_NEAR((front.project({6, 5, 5}) - middle - Vec2(scale, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((front.project({5, 6, 5}) - middle - Vec2(0, -scale)).norm(), 0, 1e-9);
  EXPECT_NEAR((front.project({5, 5, 9}) - middle).norm(), 0, 1e-9);
  EXPECT_NEAR((front.eye() - Vec3(0, 0, 1)).norm(), 0, 1e-12);
}

TEST(Camera, TurnsToTheRightAndUpwards) {
  EXPECT_NEAR((camera(90, 0).eye() - Vec3(1, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((camera(0, 90).eye() - Vec3(0, 1, 0)).norm(), 0, 1e-12);
  // From the right z runs to the left.
  const Camera right = camera(90, 0);
  EXPECT_LT(right.project({5, 5, 6}).x(), right.project({5, 5, 5}).x());
}

TEST(Camera, ShowsAllOfTheBodyAndZoomsAboutItsMiddle) {
  for (const double azimuth : {0.0, 30.0, 200.0}) {
    const Camera from = camera(azimuth, 25);
    for (const Vec3& p : kCube) {
      const Vec2 at = from.project(p);
      EXPECT_GT(at.x(), 0);
      EXPECT_LT(at.x(), kSize.width);
      EXPECT_GT(at.y(), 0);
      EXPECT_LT(at.y(), kSize.height);
    }
  }
  EXPECT_NEAR(camera(10, 20, 3).pixels_per_mm(), 3 * camera(10, 20).pixels_per_mm(), 1e-9);
  EXPECT_NEAR((camera(10, 20, 3).project({5, 5, 5}) - camera(10, 20).project({5, 5, 5})).norm(), 0,
              1e-9);
}

TEST(Camera, LiftsWhatItProjects) {
  const Camera from = camera(33, -12, 1.7);
  for (const Vec3& p : {Vec3(1, 2, 3), Vec3(-4, 0, 9)}) {
    const Vec3 back = from.lift(from.project(p));
    EXPECT_NEAR((back - p).cross(from.eye()).norm(), 0, 1e-9);  // on the same ray
  }
}

TEST(Camera, ItsMatrixIsItsProjection) {
  const Camera from = camera(33, -12, 1.7);
  const auto m = from.matrix();
  for (const Vec3& p : {Vec3(1, 2, 3), Vec3(8, 0, 9)}) {
    const auto row = [&](std::size_t r) {
      return m[r] * p.x() + m[4 + r] * p.y() + m[8 + r] * p.z() + m[12 + r];
    };
    const Vec2 pixel = from.project(p);
    EXPECT_NEAR((row(0) + 1) / 2 * kSize.width, pixel.x(), 1e-3);
    EXPECT_NEAR((row(1) + 1) / 2 * kSize.height, pixel.y(), 1e-3);
    EXPECT_GT(row(2), 0);
    EXPECT_LT(row(2), 1);
  }
  const auto depth = [&](const Vec3& p) { return m[2] * p.x() + m[6] * p.y() + m[10] * p.z(); };
  EXPECT_LT(depth(from.eye()), depth(-from.eye()));  // nearer is smaller
}

TEST(Camera, AStrokeCutsThroughAllOfTheBody) {
  const Camera front = camera(0, 0);
  const input::Cut cut = cut_along({{{0.25, 0.5}, {0.75, 0.5}}}, front);
  ASSERT_EQ(cut.edge.size(), 4U);
  for (std::size_t i = 0; i < 4; i += 2) {
    EXPECT_GT(cut.edge[i].z(), 10);
    EXPECT_LT(cut.edge[i + 1].z(), 0);
    EXPECT_NEAR(cut.edge[i].x(), cut.edge[i + 1].x(), 1e-9);
  }
  EXPECT_NEAR(front.project(cut.edge[0]).x(), 200, 1e-9);
  EXPECT_NEAR(front.project(cut.edge[2]).x(), 600, 1e-9);
  EXPECT_NEAR(front.project(cut.edge[0]).y(), 300, 1e-9);
}

TEST(Camera, HasRoomForWhereGripsWillBe) {
  Scene scene = strip(0.6, 3, 8);
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -7, 0), Axes{7}};
  const Problem problem(scene);
  double lowest = 0;
  for (const Vec3& p : shown_points(problem)) lowest = std::min(lowest, p.y());
  EXPECT_EQ(lowest, -7);
}

}  // namespace
}  // namespace sunder::test
