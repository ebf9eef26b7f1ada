// SPDX-License-Identifier: Apache-2.0
// Strokes along fibres: their direction as the body is drawn, what hides them, where there are
// none.
#include "app/figure/fibre_strokes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "app/figure/figure.hpp"
#include "app/figure/shading.hpp"
#include "app/view/overlay.hpp"
#include "core/frame/strip.hpp"

namespace sunder::test {
namespace {

using namespace app;

/// The strip (4 x 8 x 1 mm) of a tissue with a family along each direction.
Problem with_fibres(std::initializer_list<Vec3> directions) {
  Scene scene = strip(1e9, 0.01, 1);
  Material& tissue = scene.materials["board"];
  tissue.law = MaterialLaw::neo_hookean;
  for (const Vec3& direction : directions) {
    Fibres family;
    family.direction = direction;
    family.k1 = 1;
    family.k2 = 1;
    tissue.fibres.push_back(family);
  }
  return Problem(std::move(scene));
}

/// x to the right, y up, ten pixels a millimetre.
Vec2 flat(const Vec3& direction) { return {10 * direction.x(), -10 * direction.y()}; }

/// One triangle far larger than the grid's step.
DrawnTriangle large(Index element, double nearness) {
  return {{Vec2(0, 0), Vec2(200, 0), Vec2(0, 200)}, {nearness, nearness, nearness}, element};
}

std::vector<FibreStroke> strokes(const Problem& problem, const std::vector<Vec3>& places,
                                 const std::vector<DrawnTriangle>& drawn) {
  State state = undeformed(problem);
  for (std::size_t n = 0; n < places.size(); ++n) {
    state.displacement[n] = places[n] - problem.mesh().nodes[n];
  }
  return fibre_strokes(problem, state, places, 1, drawn, 10, flat);
}

TEST(FibreStrokes, RunAsFibresDoAndTurnWithTheBody) {
  const Problem problem = with_fibres({Vec3(3, 4, 0)});
  auto places = problem.mesh().nodes;
  const auto rest = strokes(problem, places, {large(0, 0)});
  ASSERT_GT(rest.size(), 50U);
  for (const FibreStroke& s : rest) {
    const Vec2 along = s.to - s.from;
    EXPECT_NEAR(along.y() / along.x(), -4.0 / 3, 1e-9);
    EXPECT_NEAR(along.norm(), 11, 1e-9);
  }
  for (Vec3& x : places) x = Vec3(-x.y(), x.x(), x.z());  // by 90 degrees, anticlockwise
  const auto turned = strokes(problem, places, {large(0, 0)});
  ASSERT_EQ(turned.size(), rest.size());
  const Vec2 along = turned[0].to - turned[0].from;
  EXPECT_NEAR(along.y() / along.x(), 3.0 / 4, 1e-9);
}

// A piece that nothing holds may be displaced as far as numbers go: its places tell.
TEST(FibreStrokes, OfALoosePieceAreThoseOfWhereItIsDrawn) {
  const Problem problem = with_fibres({Vec3(3, 4, 0)});
  State state = undeformed(problem);
  for (std::size_t n = 0; n < state.displacement.size(); ++n) {
    const Vec3& x = problem.mesh().nodes[n];
    state.displacement[n] = 1e6 * Vec3(x.y(), -x.x(), x.z());
  }
  const auto found =
      fibre_strokes(problem, state, problem.mesh().nodes, 1, std::vector{large(0, 0)}, 10, flat);
  ASSERT_FALSE(found.empty());
  const Vec2 along = found[0].to - found[0].from;
  EXPECT_NEAR(along.y() / along.x(), -4.0 / 3, 1e-9);
}

TEST(FibreStrokes, ThatPointAtTheEyeAreShort) {
  const Problem problem = with_fibres({Vec3(0, 0, 1), Vec3(1, 0, 1)});
  for (const FibreStroke& s : strokes(problem, problem.mesh().nodes, {large(0, 0)})) {
    EXPECT_NEAR((s.to - s.from).norm(), s.family == 0 ? 0 : 11 / std::sqrt(2.0), 1e-9);
  }
}

TEST(FibreStrokes, AreThoseOfWhatHidesTheRest) {
  Scene scene = strip(1e9, 0.01, 1);
  scene.mesh.fields["grain"].assign(scene.mesh.tets.size(), Vec3(1, 0, 0));
  scene.mesh.fields["grain"][7] = Vec3(0, 1, 0);
  Fibres family;
  family.direction = FieldName{"grain"};
  family.k1 = family.k2 = 1;
  scene.materials["board"].law = MaterialLaw::neo_hookean;
  scene.materials["board"].fibres = {family};
  const Problem problem(std::move(scene));
  for (const double nearness : {1.0, -1.0}) {
    const auto found = strokes(problem, problem.mesh().nodes, {large(3, 0), large(7, nearness)});
    ASSERT_FALSE(found.empty());
    for (const FibreStroke& s : found) {
      EXPECT_NEAR((s.to - s.from)[nearness > 0 ? 0 : 1], 0, 1e-9);
    }
  }
}

TEST(FibreStrokes, NoneWithoutFibresNorOfWhatIsNoTriangle) {
  const Problem plain(strip(1e9, 0.01, 1));
  EXPECT_TRUE(strokes(plain, plain.mesh().nodes, {large(0, 0)}).empty());
  const Problem problem = with_fibres({Vec3(1, 0, 0)});
  EXPECT_TRUE(strokes(problem, problem.mesh().nodes, {}).empty());
  DrawnTriangle odd = large(0, 0);
  odd.corners[2] = odd.corners[1];
  EXPECT_TRUE(strokes(problem, problem.mesh().nodes, {odd}).empty());
  odd.corners[2].x() = NAN;
  EXPECT_TRUE(strokes(problem, problem.mesh().nodes, {odd}).empty());
}

TEST(FibreStrokes, AreOverPicturesAndInFigures) {
  const Problem problem = with_fibres({Vec3(1, 1, 0)});
  Shown shown;
  shown.state = undeformed(problem);
  shown.places = problem.mesh().nodes;
  const PictureSize size;
  const Camera camera({}, {}, shown_points(problem), size);
  // A wall across the view, one side and the other.
  shown.triangles = {{{0, 4, 20}, 0, kNone, false}};
  Look look;
  look.text = look.arrows = false;
  std::size_t lines = 0;
  for (const auto& nodes : {std::array<Index, 3>{0, 4, 44}, {0, 44, 4}}) {
    shown.triangles[0].nodes = nodes;
    lines += overlay(problem, shown, {}, look, camera).lines.size();
  }
  EXPECT_GT(lines, 5U) << "one side is seen";
  look.fibres = false;
  for (const auto& nodes : {std::array<Index, 3>{0, 4, 44}, {0, 44, 4}}) {
    shown.triangles[0].nodes = nodes;
    EXPECT_TRUE(overlay(problem, shown, {}, look, camera).lines.empty());
  }
  const std::string colour = hex(kFibres[0]);
  EXPECT_NE(FigurePainter(problem).svg(shown.state).find(colour), std::string::npos);
  const Problem plain(strip(1e9, 0.01, 1));
  EXPECT_EQ(FigurePainter(plain).svg(undeformed(plain)).find(colour), std::string::npos);
}

}  // namespace
}  // namespace sunder::test
