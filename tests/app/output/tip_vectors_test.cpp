// SPDX-License-Identifier: Apache-2.0
// The vectors of Fig. 3 at a tip: which there are, how long, in which direction.
#include "app/figure/tip_vectors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sunder::app {
namespace {

using Kind = TipVector::Kind;

SifTerms terms() {
  SifTerms k;
  k.k = 9;
  k.k_a = 3;
  k.k_b = 2;
  k.k_c = 1;
  k.theta = 30;
  k.at = {7, 8};
  k.d = {-1, 0};
  k.e_a = {-0.6, 0.8};
  k.e_c = {0, 1};
  return k;
}

TEST(TipVectors, PartsAndTheirSum) {
  const auto vectors = tip_vectors(terms(), SifSource::formula);
  ASSERT_EQ(vectors.size(), 4u);
  EXPECT_EQ(vectors[0].kind, Kind::expansion);
  EXPECT_LT((vectors[0].k - Vec2(-1.8, 2.4)).norm(), 1e-12);
  EXPECT_EQ(vectors[1].kind, Kind::balanced);
  EXPECT_EQ(vectors[1].k, Vec2(-2, 0));
  EXPECT_EQ(vectors[2].kind, Kind::one_sided);
  EXPECT_EQ(vectors[2].k, Vec2(0, 1));
  EXPECT_EQ(vectors[3].kind, Kind::sum);
  EXPECT_LT((vectors[3].k - Vec2(-3.8, 3.4)).norm(), 1e-12);
  for (const TipVector& v : vectors) EXPECT_EQ(v.root, Vec2(7, 8));
}

TEST(TipVectors, WithoutPressureOneAndTheSum) {
  SifTerms k = terms();
  k.k_b = k.k_c = 0;
  const auto vectors = tip_vectors(k, SifSource::formula);
  ASSERT_EQ(vectors.size(), 2u);
  EXPECT_EQ(vectors[0].k, vectors[1].k);
}

TEST(TipVectors, OfTheFieldAlongTheGrowth) {
  const auto vectors = tip_vectors(terms(), SifSource::field);
  ASSERT_EQ(vectors.size(), 1u);
  EXPECT_EQ(vectors[0].kind, Kind::field);
  // 30 deg counter-clockwise from (-1, 0).
  EXPECT_LT((vectors[0].k - 9 * Vec2(-std::sqrt(3) / 2, -0.5)).norm(), 1e-12);
}

TEST(TipVectors, KeyNamesWhatIsDrawn) {
  const std::string formula = tip_vector_key({0, 0}, SifSource::formula, true);
  for (const char* name : {"K_a e_a", "K_b d", "K_c e_c", "v, their sum"})
    EXPECT_NE(formula.find(name), std::string::npos) << name;
  EXPECT_EQ(formula.find("field"), std::string::npos);
  EXPECT_NE(tip_vector_key({0, 0}, SifSource::field, true).find("K of the field"),
            std::string::npos);
  EXPECT_EQ(tip_vector_key({0, 0}, SifSource::formula, false), "");
}

/// One tetrahedron with a crack that grew to the right: its arrow starts where the tip was and is
/// drawn to the right, in the undeformed direction.
TEST(TipVectors, DrawnWhereTheTipWas) {
  Scene scene;
  scene.mesh.nodes = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 1}};
  scene.mesh.tets = {{0, 1, 2, 3}};
  scene.mesh.volume_of = {0};
  scene.mesh.volumes = {{"tissue", 1}};
  scene.materials["tissue"] = {5.0, 0.4, 2.0};
  Support support;
  support.nodes = std::vector<Index>{0, 1, 2};
  scene.supports.push_back(support);
  const Problem problem(scene);
  const BoardPlane plane = board_plane(problem.mesh(), std::nullopt);
  State state = undeformed(problem);
  const Pose pose = pose_of(problem, plane, state);
  Bounds bounds;
  bounds.add(plane.outline_min);
  bounds.add(plane.outline_max);
  const Canvas canvas(bounds);
  EXPECT_EQ(draw_tip_vectors(problem, plane, pose, state, canvas), "");
  state.cracks.emplace_back();
  SifTerms k;
  k.k_a = 2;
  k.at = {2, 3};
  k.d = k.e_a = {1, 0};
  state.growths.push_back({0, k});
  const std::string svg = draw_tip_vectors(problem, plane, pose, state, canvas);
  const Vec2 root = canvas.map({2, 3}), head = canvas.map(Vec2(2 + 0.14 * 10, 3));
  const auto text = [](double v) {  // as in the file: two decimals at most
    std::string s = std::to_string(std::round(v * 100) / 100);
    while (s.back() == '0') s.pop_back();
    if (s.back() == '.') s.pop_back();
    return s;
  };
  EXPECT_NE(svg.find("x1=\"" + text(root.x()) + "\" y1=\"" + text(root.y()) + "\""),
            std::string::npos)
      << svg;
  EXPECT_NE(svg.find("x2=\"" + text(head.x()) + "\" y2=\"" + text(head.y()) + "\""),
            std::string::npos)
      << svg;
}

}  // namespace
}  // namespace sunder::app
