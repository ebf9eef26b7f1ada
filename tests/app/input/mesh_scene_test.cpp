// SPDX-License-Identifier: Apache-2.0
// The scene of a mesh that has none.
#include "app/input/mesh_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "app/input/mesh_import.hpp"
#include "app/input/scene_toml.hpp"
#include "input_support.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

TEST(MeshScene, HoldsOneEndOfTheLongestWayAndPullsTheOther) {
  const auto problem = app::read_problem(std::filesystem::path(SUNDER_SCENES "/meshes/liver.msh"));
  EXPECT_EQ(problem->scene().title, "liver");
  ASSERT_EQ(problem->instrument_nodes().size(), 1u);
  for (Index n : problem->instrument_nodes()[0].nodes) {
    EXPECT_GE(problem->mesh().nodes[static_cast<std::size_t>(n)].x(), 57);
  }
  const auto& grip = std::get<Grip>(problem->scene().instruments[0].action);
  EXPECT_EQ(grip.displacement, Vec3(36, 0, 0));  // of 60 mm
  EXPECT_TRUE(problem->scene().fracture.model == FractureModel::a);
}

TEST(MeshScene, GivesEveryVolumeTissueThatTears) {
  const auto problem =
      app::read_problem(std::filesystem::path(SUNDER_SCENES "/meshes/board1954.msh"));
  EXPECT_GE(problem->mesh().volumes.size(), 4u);
  for (const auto& [name, material] : problem->scene().materials) {
    EXPECT_TRUE(material.yield) << name;
  }
}

/// A double cone, one node at each end: what is held and gripped is more than that.
TEST(MeshScene, TakesEndsThatHoldABody) {
  const TemporaryFolder folder;
  std::string nodes = "0 0 0\n0 0 20\n", tets;
  constexpr int kSides = 6, kRings = 9;
  for (int ring = 0; ring < kRings; ++ring) {
    const double z = 2.0 * (ring + 1), r = 0.5 * std::min(ring + 1, kRings - ring);
    for (int k = 0; k < kSides; ++k) {
      const double at = 2 * 3.141592653589793 * k / kSides;
      nodes += std::to_string(r * std::cos(at)) + " " + std::to_string(r * std::sin(at)) + " " +
               std::to_string(z) + "\n";
    }
  }
  const auto ring_node = [&](int ring, int k) { return 2 + kSides * ring + k % kSides; };
  int count = 0;
  const auto add = [&](int a, int b, int c, int d) {
    tets += "4 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + " " +
            std::to_string(d) + "\n";
    ++count;
  };
  for (int k = 1; k + 1 < kSides; ++k) {
    add(0, ring_node(0, 0), ring_node(0, k), ring_node(0, k + 1));
    add(1, ring_node(kRings - 1, 0), ring_node(kRings - 1, k + 1), ring_node(kRings - 1, k));
    for (int ring = 0; ring + 1 < kRings; ++ring) {  // prisms of three tetrahedra
      const int a = ring_node(ring, 0), b = ring_node(ring, k), c = ring_node(ring, k + 1);
      const int d = ring_node(ring + 1, 0), e = ring_node(ring + 1, k),
                f = ring_node(ring + 1, k + 1);
      add(a, b, c, f);
      add(a, b, f, e);
      add(a, e, f, d);
    }
  }
  std::string types;
  for (int i = 0; i < count; ++i) types += "10\n";
  const auto file = folder.write(
      "spindle.vtk",
      "# vtk DataFile Version 3.0\nspindle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
          std::to_string(2 + kSides * kRings) + " double\n" + nodes + "CELLS " +
          std::to_string(count) + " " + std::to_string(5 * count) + "\n" + tets + "CELL_TYPES " +
          std::to_string(count) + "\n" + types);
  const auto problem = app::read_problem(file);
  EXPECT_GE(problem->instrument_nodes()[0].nodes.size(), 4u);
  int held = 0;
  for (Index n = 0; n < problem->node_count(); ++n) held += problem->dof(n, 0) == kNone ? 1 : 0;
  EXPECT_GE(held, 4);
}

TEST(MeshScene, IsOfAFileThatCanBeRead) {
  EXPECT_TRUE(app::is_mesh_file("a/b.MSH"));
  EXPECT_FALSE(app::is_mesh_file("a/b.toml"));
  EXPECT_FALSE(app::is_mesh_file("msh"));
  EXPECT_THROW(static_cast<void>(app::mesh_scene_text("there-is-none.msh")), InputError);
}

}  // namespace
}  // namespace sunder::test
