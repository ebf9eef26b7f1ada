// SPDX-License-Identifier: Apache-2.0
// What a device draws, pixel by pixel: the body where the camera says, colours as the scale has
// them, holes where elements are gone. Whatever Vulkan device there is will do.
#include <gtest/gtest.h>

#include "app/view/painter.hpp"
#include "app/view/session.hpp"
#include "core/frame/strip.hpp"
#include "sunder/backends.hpp"

namespace sunder::test {
namespace {

using namespace app;

constexpr PictureSize kSize{480, 360};

/// A strip of 4 x 8 x 1 cells seen from the front.
struct Seen {
  explicit Seen(Scene scene = strip(0.6, 0.2, 8), bool goes_back = true) {
    scene.live = true;
    problem = std::make_shared<const Problem>(std::move(scene));
    session.emplace(
        problem, [p = problem] { return create_backend(p, needs_of(*p)).backend; }, goes_back,
        kSize);
    session->look().camera = {0, 0, 1};
    painter.emplace(device, kSize);
  }

  void draw() {
    painter->draw(session->show(painter->version()), session->look(), session->camera());
    pixels = painter->pixels();
  }
  [[nodiscard]] Color at(const Vec2& pixel) const {
    const auto x = static_cast<std::size_t>(pixel.x()), y = static_cast<std::size_t>(pixel.y());
    const std::uint8_t* p = &pixels.rgba.at(4 * (y * kSize.width + x));
    return {p[0], p[1], p[2]};
  }
  /// Where a point of space is seen.
  [[nodiscard]] Color at(const Vec3& point) const { return at(session->camera().project(point)); }

  view::Device device;
  std::shared_ptr<const Problem> problem;
  std::optional<Session> session;
  std::optional<Painter> painter;
  Pixels pixels;
};

void expect_near(Color a, Color b) {
  EXPECT_NEAR(a.r, b.r, 1);
  EXPECT_NEAR(a.g, b.g, 1);
  EXPECT_NEAR(a.b, b.b, 1);
}

std::vector<Index> cell(Index i, Index j) {
  std::vector<Index> elements;
  for (Index e = 0; e < 6; ++e) elements.push_back(6 * (i + 4 * j) + e);
  return elements;
}

TEST(Pixels, TheBodyIsWhereTheCameraSays) {
  Seen seen;
  seen.draw();
  const Vec3 margin(0.1, 0.1, 0);
  for (const Vec3& corner : {Vec3(0, 0, 1), Vec3(4, 0, 1), Vec3(0, 8, 1), Vec3(4, 8, 1)}) {
    const Vec3 inwards = (Vec3(2, 4, 1) - corner).cwiseSign().cwiseProduct(margin);
    EXPECT_NE(seen.at(Vec3(corner + inwards)), kBackground);
    EXPECT_EQ(seen.at(Vec3(corner - inwards)), kBackground);
  }
  // Turned to its narrow side.
  seen.session->look().camera = {90, 0, 1};
  seen.draw();
  EXPECT_NE(seen.at(Vec3(4, 4, 0.5)), kBackground);
  EXPECT_EQ(seen.at(Vec3(4, 4, 1.1)), kBackground);
}

TEST(Pixels, ADeformedBodyIsAtTrueScale) {
  Scene scene = strip(0.6, 0.2, 1);
  scene.fracture.model = FractureModel::none;
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(0, -2, 0), Axes{7}};
  Seen seen(std::move(scene));
  seen.session->step();
  seen.draw();
  EXPECT_NE(seen.at(Vec3(2, -1.9, 1)), kBackground);
  EXPECT_EQ(seen.at(Vec3(2, -2.1, 1)), kBackground);
}

TEST(Pixels, AFaceThatLooksAtTheEyeHasTheColourOfItsElement) {
  Scene scene = strip(0.6, 0.2, 1);
  scene.fracture.model = FractureModel::none;
  Seen seen(std::move(scene));
  seen.session->step();
  const input::Colour colour{Field::stress, 0.1};
  seen.session->look().colour = colour;
  seen.draw();
  // The strip is pulled in its plane: its front stays flat.
  const auto shown = seen.session->show(0);
  const Paint paint = app::paint(*seen.problem, shown->state, shown->triangles, colour);
  int looked_at = 0;
  for (std::size_t t = 0; t < shown->triangles.size(); ++t) {
    const auto& nodes = shown->triangles[t].nodes;
    Vec3 middle = Vec3::Zero();
    double lowest = 1e9;
    for (const Index n : nodes) {
      middle += shown->places[static_cast<std::size_t>(n)] / 3;
      lowest = std::min(lowest, seen.problem->mesh().nodes[static_cast<std::size_t>(n)].z());
    }
    if (lowest < 0.99) continue;
    const Color seen_there = seen.at(middle), meant = red(paint.values[t] / paint.maximum);
    EXPECT_NEAR(seen_there.r, meant.r, 4);  // the front is curved by some thousandths
    EXPECT_NEAR(seen_there.g, meant.g, 4);
    EXPECT_NEAR(seen_there.b, meant.b, 4);
    ++looked_at;
  }
  EXPECT_EQ(looked_at, 64);  // two a cell
}

TEST(Pixels, AHoleShowsTheBackgroundAndUndoClosesItToTheByte) {
  Seen seen;
  seen.session->step();
  seen.draw();
  const std::string before = seen.painter->png();
  const Vec3 middle(1.5, 3.4, 1);
  ASSERT_NE(seen.at(middle), kBackground);
  seen.session->hand().remove(cell(1, 3));
  seen.draw();
  EXPECT_EQ(seen.at(middle), kBackground);
  EXPECT_NE(seen.painter->png(), before);
  seen.session->hand().undo(1);
  seen.draw();
  EXPECT_EQ(seen.painter->png(), before);
  seen.session->hand().redo(1);
  seen.draw();
  EXPECT_EQ(seen.at(middle), kBackground);
}

TEST(Pixels, AStrokeOnThePictureCutsWhatLiesUnderIt) {
  Seen seen;
  seen.session->step();
  const Camera camera = seen.session->camera();
  const auto share = [&](const Vec3& p) {
    const Vec2 pixel = camera.project(p);
    return Vec2(pixel.x() / kSize.width, pixel.y() / kSize.height);
  };
  Inputs inputs;
  inputs.list.push_back({1, input::Stroke{{share({-0.5, 4.6, 1}), share({2.4, 4.6, 1})}}});
  seen.session->take(inputs, inputs.list[0]);
  seen.draw();
  EXPECT_EQ(seen.at(Vec3(1, 4.6, 1)), kBackground);
  EXPECT_NE(seen.at(Vec3(3.6, 4.6, 1)), kBackground);
  EXPECT_NE(seen.at(Vec3(1, 2, 1)), kBackground);
}

TEST(Pixels, WhatAClipLeavesOutIsNotThereAndItsInsideIsDarker) {
  Seen seen;
  seen.draw();
  const Color whole = seen.at(Vec3(2, 6, 1));
  seen.session->look().clip = {Vec3(0, 1, 0), 4};
  seen.draw();
  EXPECT_EQ(seen.at(Vec3(2, 6, 1)), kBackground);
  expect_near(seen.at(Vec3(2, 2, 1)), whole);
  // The front half left out: the back from within.
  seen.session->look().clip = {Vec3(0, 0, 1), 0.5};
  seen.draw();
  const Color inside = seen.at(Vec3(2, 6, 1));
  EXPECT_NE(inside, kBackground);
  EXPECT_LT(inside.g, whole.g - 20);
}

TEST(Pixels, AWireframeDarkensEdges) {
  Seen seen;
  seen.draw();
  const Vec3 on_edge(2, 6.3, 1), within(2.3, 6.1, 1);
  expect_near(seen.at(on_edge), seen.at(within));
  seen.session->look().wireframe = true;
  seen.draw();
  EXPECT_LT(seen.at(on_edge).g, seen.at(within).g - 40);
}

TEST(Pixels, TheSameSessionTwiceGivesTheSameBytes) {
  const auto picture = [] {
    Seen seen;
    for (int i = 0; i < 3; ++i) seen.session->step();
    seen.draw();
    return seen.painter->png();
  };
  EXPECT_EQ(picture(), picture());
}

TEST(Pixels, ASimulationOnTheSameDeviceDrawsAsOneOnTheProcessor) {
  Scene scene = strip(0.6, 0.2, 2);
  scene.solver.backend = "vulkan";
  scene.solver.precision = Precision::fp64;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  view::Device device;
  Session session(
      problem,
      [&] { return create_backend_on(problem, needs_of(*problem), device.lend()).backend; }, false,
      kSize);
  session.look().camera = {0, 0, 1};
  Painter painter(device, kSize);
  Seen other(strip(0.6, 0.2, 2));
  for (int i = 0; i < 2; ++i) {
    session.step();
    painter.draw(session.show(painter.version()), session.look(), session.camera());
    other.session->step();
    other.draw();
    const Pixels pixels = painter.pixels();
    ASSERT_EQ(pixels.rgba.size(), other.pixels.rgba.size());
    std::size_t far = 0;
    for (std::size_t b = 0; b < pixels.rgba.size(); ++b) {
      if (std::abs(pixels.rgba[b] - other.pixels.rgba[b]) > 2) ++far;
    }
    EXPECT_LT(far, pixels.rgba.size() / 1000);  // a rim whose sample falls otherwise
  }
  EXPECT_EQ(session.simulation().backend().info().backend, "vulkan");
}

}  // namespace
}  // namespace sunder::test
