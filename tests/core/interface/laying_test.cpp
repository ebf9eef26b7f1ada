// SPDX-License-Identifier: Apache-2.0
// What becomes of a mesh along interfaces: nodes part, layers come, all else stays where it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "body/element.hpp"
#include "body/lay_interfaces.hpp"
#include "body/mesh_findings.hpp"
#include "bonded_blocks.hpp"

namespace sunder::test {
namespace {

double volume_of(const Problem& problem, Index e) { return problem.shape(e).volume; }

Index layer_elements(const Problem& problem) {
  Index count = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) count += problem.in_interface(e);
  return count;
}

/// What must hold of any body with interfaces. `before`: its mesh without.
void expect_laid(const Problem& problem, const Mesh& before) {
  const Mesh& mesh = problem.mesh();
  ASSERT_GE(mesh.tet_count(), before.tet_count());
  double volume = 0, was = 0;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    EXPECT_GT(volume_of(problem, e), 0) << e;
    EXPECT_EQ(problem.in_interface(e), e >= before.tet_count());
    volume += volume_of(problem, e);
  }
  for (Index e = 0; e < before.tet_count(); ++e) {
    const auto& t = before.tets[static_cast<std::size_t>(e)];
    std::array<Vec3, 4> x;
    for (std::size_t a = 0; a < 4; ++a) x[a] = before.nodes[static_cast<std::size_t>(t[a])];
    was += fem::tet_shape(x[0], x[1], x[2], x[3]).volume;
    EXPECT_EQ(mesh.volume_of[static_cast<std::size_t>(e)],
              before.volume_of[static_cast<std::size_t>(e)]);
  }
  // A face has at most two elements, and those with one alone close the body: nothing gapes.
  std::map<std::array<Index, 3>, int> faces;
  for (const auto& tet : mesh.tets) {
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<Index, 3> face{};
      std::size_t k = 0;
      for (std::size_t a = 0; a < 4; ++a) {
        if (a != left_out) face[k++] = tet[a];
      }
      std::ranges::sort(face);
      EXPECT_LE(++faces[face], 2);
    }
  }
  EXPECT_EQ(find_face_parts(mesh).count, find_face_parts(before).count);
  double thickness = 0, area = 0;
  for (const InterfaceLayer& layer : problem.interfaces()->layers()) {
    thickness = std::max(thickness, layer.thickness);
    area += layer.area;
  }
  EXPECT_NEAR(volume, was, 2 * thickness * area);
  for (Index n = 0; n < before.node_count(); ++n) {
    EXPECT_LE((mesh.nodes[static_cast<std::size_t>(n)] - before.nodes[static_cast<std::size_t>(n)])
                  .norm(),
              3 * thickness);
  }
}

TEST(Laying, TwoBlocksGetASpringForEachPairOfNodes) {
  const Scene scene = blocks();
  const Problem problem(scene);
  expect_laid(problem, scene.mesh);
  EXPECT_EQ(problem.node_count(), scene.mesh.node_count() + 9);
  EXPECT_EQ(layer_elements(problem), 3 * 8);
  const Interfaces& of = *problem.interfaces();
  ASSERT_EQ(of.layers().size(), 1u);
  EXPECT_NEAR(of.layers()[0].area, 4, 1e-4);
  EXPECT_EQ(problem.mesh().volumes.back().name, "interface-0");
  EXPECT_EQ(of.pair_count(), 9u);
  std::set<Index> seen;
  double area = 0;
  for (std::size_t p = 0; p < of.pair_count(); ++p) {
    for (Index e : of.elements(p)) {
      EXPECT_TRUE(seen.insert(e).second);
      EXPECT_EQ(of.pair(e), p);
      area += of.area(e);
    }
    const auto [a, b] = of.nodes(of.elements(p).front());
    const Vec3 across = problem.mesh().nodes[static_cast<std::size_t>(b)] -
                        problem.mesh().nodes[static_cast<std::size_t>(a)];
    EXPECT_NEAR((across - Vec3(0, 0, of.layers()[0].thickness)).norm(), 0, 1e-15);
    // In the middle six faces meet, at their edges two or four.
    EXPECT_GE(of.neighbours(p).size(), 2u);
    EXPECT_LE(of.neighbours(p).size(), 6u);
  }
  EXPECT_NEAR(area, 4, 1e-4);
  EXPECT_EQ(seen.size(), 24u);
}

TEST(Laying, TheNodesOfTheFirstVolumeStay) {
  const Scene scene = blocks();
  const Problem problem(scene);
  for (Index n = 0; n < scene.mesh.node_count(); ++n) {
    EXPECT_EQ(problem.mesh().nodes[static_cast<std::size_t>(n)],
              scene.mesh.nodes[static_cast<std::size_t>(n)]);
  }
}

// A cube inside another, bonded all round: at its edges and corners the layer is as thick as
// elsewhere.
TEST(Laying, RoundACornerTheLayerKeepsItsThickness) {
  const auto inner = [](const Vec3& x) {
    return (x.array() > 1).all() && (x.array() < 3).all() ? "stone" : "bed";
  };
  Scene scene = body_of({4, 4, 4, 4, 4, 4}, inner);
  scene.supports.push_back({slab(2, -1, 1e-6), Axes{}});
  scene.interfaces.push_back({{"bed", "stone"}, kStrength, kEnergy, 1});
  const Problem problem(scene);
  expect_laid(problem, scene.mesh);
  EXPECT_EQ(layer_elements(problem), 3 * 6 * 8);
  const Interfaces& of = *problem.interfaces();
  EXPECT_NEAR(of.layers()[0].area, 24, 0.1);
  for (Index e = scene.mesh.tet_count(); e < problem.tet_count(); ++e) {
    EXPECT_NEAR(volume_of(problem, e) / of.area(e), of.layers()[0].thickness,
                1e-2 * of.layers()[0].thickness);
  }
}

// Where three volumes meet and two of their surfaces are interfaces, or all three.
TEST(Laying, ThreeVolumesThatMeetInALine) {
  const auto three = [](const Vec3& x) { return x.z() < 1 ? "bed" : x.x() < 1 ? "left" : "right"; };
  Scene scene = body_of({2, 2, 2, 2, 2, 2}, three);
  scene.supports.push_back({slab(2, -1, 1e-6), Axes{}});
  const Mesh before = scene.mesh;
  scene.interfaces.push_back({{"bed", "left"}, kStrength, kEnergy, 1});
  {  // ends inside: along the line nothing parts
    const Problem problem(scene);
    expect_laid(problem, before);
    EXPECT_EQ(problem.node_count(), before.node_count() + 3);
  }
  scene.interfaces.push_back({{"right", "bed"}, 2 * kStrength, kEnergy, 1});
  {
    const Problem problem(scene);
    expect_laid(problem, before);
    EXPECT_EQ(problem.node_count(), before.node_count() + 9);
  }
  scene.interfaces.push_back({{"left", "right"}, kStrength, kEnergy, 1});
  const Problem problem(scene);
  expect_laid(problem, before);
  EXPECT_EQ(problem.node_count(), before.node_count() + 9 + 6);  // a third copy along the line
  ASSERT_EQ(problem.interfaces()->layers().size(), 3u);
  // Two of one strength and one of twice that have one thickness, along the line too.
  const double thickness = problem.interfaces()->layers()[0].thickness;
  for (Index e = before.tet_count(); e < problem.tet_count(); ++e) {
    EXPECT_NEAR(volume_of(problem, e) / problem.interfaces()->area(e), thickness, 1e-6 * thickness);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const InterfaceLayer& layer = problem.interfaces()->layers()[i];
    EXPECT_NEAR(layer.opening, 2 * kEnergy / layer.strength, 0.02 * layer.opening);
  }
  EXPECT_NEAR(problem.interfaces()->layers()[2].area, 2, 0.05);
}

TEST(Laying, SurfacesAndFieldsOfTheMeshFollow) {
  Scene scene = blocks();
  const Index low = grid_node({2, 2, 2, 2, 2, 2}, 0, 0, 1), far = low + 3;
  scene.mesh.fields["grain"].assign(scene.mesh.tets.size(), Vec3(1, 0, 0));
  scene.mesh.surfaces.push_back({"side", 9, {}});
  const Index up = grid_node({2, 2, 2, 2, 2, 2}, 0, 0, 2), up_far = up + 3;
  // Of the face x = 0 of the upper block: whichever two triangles its elements have.
  for (const FreeFace& face : free_faces(scene.mesh)) {
    std::array<Index, 3> nodes = face.nodes;
    std::ranges::sort(nodes);
    const std::set<Index> corner{low, far, up, up_far};
    if (std::ranges::all_of(nodes, [&](Index n) { return corner.contains(n); })) {
      scene.mesh.surfaces[0].triangles.push_back(face.nodes);
    }
  }
  ASSERT_EQ(scene.mesh.surfaces[0].triangles.size(), 2u);
  const Problem problem(scene);
  EXPECT_EQ(problem.mesh().fields.at("grain").size(), problem.mesh().tets.size());
  for (const auto& triangle : problem.mesh().surfaces[0].triangles) {
    for (Index n : triangle) {
      EXPECT_NE(n, low) << "the lower block's";
      EXPECT_NE(n, far);
    }
  }
}

// result.vtu has the layers in it: the same scene reads it as a mesh.
TEST(Laying, AMeshThatHasItsLayersStaysAsItIs) {
  const Problem first(blocks());
  Scene again = blocks();
  again.mesh = first.mesh();
  const Problem second(std::move(again));
  EXPECT_EQ(second.mesh().tets, first.mesh().tets);
  EXPECT_TRUE(second.mesh().nodes == first.mesh().nodes);
  EXPECT_NEAR(second.interfaces()->layers()[0].mu, first.interfaces()->layers()[0].mu,
              1e-9 * first.interfaces()->layers()[0].mu);
  EXPECT_EQ(second.interfaces()->pair_count(), 9u);
}

// Strength and energy are exact however thick the layer is against its opening.
TEST(LayerLaw, BearsTheStrengthAndTakesTheEnergy) {
  for (const double thickness : {1e-7, 1e-4, 1e-2, 1.0, 50.0}) {
    const fem::LayerLaw law = fem::layer_law(kStrength, kEnergy, thickness);
    const auto traction = [&](double opening) {
      const double s = 1 + opening / thickness;
      return law.mu * (s - 1 / s);
    };
    EXPECT_NEAR(traction(law.opening), kStrength, 1e-12 * kStrength) << thickness;
    constexpr int kParts = 20000;
    double area = 0;  // Simpson's rule
    for (int i = 0; i <= kParts; ++i) {
      const double weight = i == 0 || i == kParts ? 1 : i % 2 == 1 ? 4 : 2;
      area += weight * traction(law.opening * i / kParts);
    }
    area *= law.opening / kParts / 3;
    EXPECT_NEAR(area, kEnergy, (thickness < 1e-3 ? 1e-3 : 1e-6) * kEnergy) << thickness;
  }
}

}  // namespace
}  // namespace sunder::test
