// SPDX-License-Identifier: Apache-2.0
// What elements are coloured by: values by hand, the scale, and what cannot break.
#include "app/view/colours.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/view/overlay.hpp"
#include "core/frame/strip.hpp"

namespace sunder::test {
namespace {

using namespace app;

Scene by_law(MaterialLaw law) {
  Scene scene = strip(0.6, 3, 8);
  for (auto& [name, material] : scene.materials) material.law = law;
  return scene;
}

/// All nodes moved by a linear map.
State mapped(const Problem& problem, const Mat3& gradient) {
  State state = undeformed(problem);
  for (std::size_t n = 0; n < state.displacement.size(); ++n) {
    state.displacement[n] = gradient * problem.mesh().nodes[n];
  }
  return state;
}

std::vector<SurfaceTriangle> triangles_of(const std::vector<Index>& elements) {
  std::vector<SurfaceTriangle> triangles;
  for (const Index e : elements) triangles.push_back({{}, e, kNone, false});
  return triangles;
}

TEST(Colours, StrainOfALinearLawIsThatOfTheSymmetricGradient) {
  const Problem problem(by_law(MaterialLaw::linear));
  Mat3 gradient = Mat3::Zero();
  gradient(0, 1) = 0.2;  // shear: principal strains +-.1
  EXPECT_NEAR(largest_strain(problem, mapped(problem, gradient), 3), 0.1, 1e-12);
  gradient.setZero();
  gradient(1, 1) = -0.3;
  EXPECT_NEAR(largest_strain(problem, mapped(problem, gradient), 3), 0.3, 1e-12);
}

TEST(Colours, StrainOfOtherLawsDoesNotSeeARotation) {
  const Problem problem(by_law(MaterialLaw::neo_hookean));
  const double a = std::numbers::pi / 5;
  Mat3 turn;
  turn << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1;
  EXPECT_NEAR(largest_strain(problem, mapped(problem, turn - Mat3::Identity()), 3), 0, 1e-7);
  const Mat3 drawn_out = turn * Vec3(1.5, 1, 1).asDiagonal();
  EXPECT_NEAR(largest_strain(problem, mapped(problem, drawn_out - Mat3::Identity()), 3), 0.5, 1e-9);
}

TEST(Colours, FollowTheScale) {
  const Problem problem(by_law(MaterialLaw::linear));
  State state = undeformed(problem);
  state.stress.assign(problem.mesh().tets.size(), Voigt::Zero());
  state.stress[5][3] = 0.15;  // maximum shear .15, a quarter of yield
  state.stress[6][3] = 9;
  const auto triangles = triangles_of({4, 5, 6});
  const Paint ratio = paint(problem, state, triangles, {Field::yield, {}});
  EXPECT_EQ(ratio.maximum, 1);
  EXPECT_EQ(ratio.values, (std::vector<float>{0, 0.25F, 15}));
  const Paint fixed = paint(problem, state, triangles, {Field::stress, 0.3});
  EXPECT_EQ(fixed.maximum, 0.3);
  EXPECT_EQ(fixed.values[1], 0.15F);
  EXPECT_NE(fixed.label.find("MPa"), std::string::npos);
}

TEST(Colours, OfADeviceTakeTheScaleAlone) {
  const Problem problem(by_law(MaterialLaw::linear));
  State state = undeformed(problem);
  state.stress.assign(problem.mesh().tets.size(), Voigt::Zero());
  state.stress[5][3] = 0.15;
  const auto triangles = triangles_of({4, 5, 6});
  for (const input::Colour& colour : {input::Colour{Field::yield, {}},
                                      {Field::stress, 0.3},
                                      {Field::stress, {}},
                                      {Field::strain, {}}}) {
    const Paint here = paint(problem, state, triangles, colour);
    const Paint there = paint(problem, state, triangles, colour, Values::on_device);
    EXPECT_EQ(there.maximum, here.maximum);
    EXPECT_EQ(there.label, here.label);
    EXPECT_EQ(here.values.size(), triangles.size());
    EXPECT_TRUE(there.values.empty());
  }
}

TEST(Colours, WhatCannotBreakIsGreyAndWithoutStressNothingIsSaid) {
  Scene scene = by_law(MaterialLaw::linear);
  scene.mesh = structured_board({4, 8, 1, 4, 8, 1}, [](const Vec3& at) {
    return std::string(at.y() > 4 ? "frame" : "board");
  });
  scene.materials["frame"] = {500, 0.3, {}};
  const Problem problem(scene);
  State state = undeformed(problem);
  const Index last = problem.tet_count() - 1;
  const auto triangles = triangles_of({0, last});
  const Paint none = paint(problem, state, triangles, {Field::yield, {}});
  EXPECT_TRUE(none.label.empty());
  EXPECT_TRUE(none.values.empty());
  state.stress.assign(problem.mesh().tets.size(), Voigt::Zero());
  state.stress[static_cast<std::size_t>(last)][3] = 9;
  const Paint known = paint(problem, state, triangles, {Field::stress, {}});
  EXPECT_EQ(known.values[0], 0);
  EXPECT_EQ(known.maximum, 1) << "the frame's stress is not on the scale";
  const auto grey = unbreakable(problem);
  EXPECT_EQ(grey.front(), 0);
  EXPECT_EQ(grey.back(), 1);
  scene.materials["board"].yield.reset();
  EXPECT_TRUE(unbreakable(Problem(scene)).empty()) << "nothing can break";
}

/// The undeformed strip, without a simulation.
Shown resting(const Problem& problem) {
  Shown shown;
  shown.state = undeformed(problem);
  shown.places = problem.mesh().nodes;
  return shown;
}

TEST(Overlay, SaysWhatTheColoursMeanUnlessToldNotTo) {
  const Problem problem(strip(0.6, 3, 8));
  Shown shown = resting(problem);
  shown.words = {"A <title>", {"step 1"}};
  Paint paint;
  paint.label = "max. shear / yield";
  const PictureSize size;
  const Camera camera({}, {}, shown_points(problem), size);
  Look look;
  const std::string svg = svg_of(overlay(problem, shown, paint, look, camera), size);
  EXPECT_NE(svg.find("max. shear / yield"), std::string::npos);
  EXPECT_NE(svg.find("A &lt;title&gt;"), std::string::npos);
  EXPECT_NE(svg.find(" mm<"), std::string::npos);
  look.text = false;
  EXPECT_EQ(svg_of(overlay(problem, shown, paint, look, camera), size).find("<text"),
            std::string::npos);
}

TEST(Overlay, ArrowsAreAsLongAsTheirForces) {
  const Problem problem(strip(0.6, 3, 8));
  Shown shown = resting(problem);
  shown.state.instruments.push_back({"a", {0}, Vec3(0, -4, 0), false});
  shown.state.instruments.push_back({"b", {1}, Vec3(2, 0, 0), false});
  const Camera camera({}, {}, shown_points(problem), {});
  Look look;
  look.text = false;
  const Overlay out = overlay(problem, shown, {}, look, camera);
  ASSERT_EQ(out.polygons.size(), 2U);  // their heads
  const auto length = [&](std::size_t i) {
    return (out.polygons[i].corners[0] - camera.project(shown.places[i])).norm();
  };
  EXPECT_NEAR(length(0), 2 * length(1), 1e-6);
  EXPECT_GT(out.polygons[0].corners[0].y(), camera.project(shown.places[0]).y());  // down
}

TEST(Lips, LieBetweenWhatATearLaysOpenAndTheRest) {
  SceneRun run(strip(0.6, 0.2, 8));
  Showing showing(run.simulation);
  EXPECT_TRUE(showing.show(0)->lips.empty());
  const std::vector<SurfaceTriangle> triangles{{{0, 1, 2}, 0, kNone, false},
                                               {{2, 1, 3}, 1, kNone, true}};
  EXPECT_EQ(lips_of(triangles), (std::vector<std::array<Index, 2>>{{1, 2}}));
}

TEST(Normals, PointOutwardsAndAreZeroWhereNothingEnds) {
  const std::vector<Vec3> places{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {5, 5, 5}};
  const std::vector<SurfaceTriangle> triangles{{{0, 1, 2}, 0, kNone, false}};
  const auto normals = normals_of(triangles, places);
  EXPECT_EQ(normals[1], Vec3(0, 0, 1));
  EXPECT_EQ(normals[3], Vec3(0, 0, 0));
}

}  // namespace
}  // namespace sunder::test
