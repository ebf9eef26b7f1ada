// SPDX-License-Identifier: Apache-2.0
// Interfaces that no body can have are refused, with what is wrong and where.
#include <gtest/gtest.h>

#include <limits>

#include "bonded_blocks.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

void expect_refused(Scene scene, InputFault fault, const std::string& part) {
  scene.source = "scene.toml";
  try {
    const Problem problem(std::move(scene));
    ADD_FAILURE() << "nothing was said of " << part;
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), fault) << error.what();
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(BadInterface, Numbers) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInfinite = std::numeric_limits<double>::infinity();
  for (const double wrong : {0.0, -1.0, kNan, kInfinite}) {
    for (const auto& [member, key] :
         {std::pair(&Interface::strength, "strength"), std::pair(&Interface::energy, "energy"),
          std::pair(&Interface::shear_ratio, "shear_ratio")}) {
      Scene scene = blocks();
      scene.interfaces[0].*member = wrong;
      expect_refused(std::move(scene), InputFault::out_of_range,
                     std::string("interface 0 (between \"low\" and \"high\") has ") + key + " = ");
    }
  }
}

TEST(BadInterface, EnergyThatNoMeshResolves) {
  Scene scene = blocks();
  scene.interfaces[0].energy = 1e-12;
  expect_refused(std::move(scene), InputFault::out_of_range, "nothing beside its shortest edge");
}

TEST(BadInterface, NamesOfLayers) {
  Scene of_layer = blocks();
  of_layer.materials["interface-0"] = tissue();
  expect_refused(std::move(of_layer), InputFault::unknown_name,
                 "material \"interface-0\" names no volume of the mesh");
  Scene taken = body_of({2, 2, 3, 2, 2, 3}, [](const Vec3& x) {
    return x.z() < 1 ? "low" : x.z() < 2 ? "high" : "interface-0";
  });
  taken.supports.push_back({slab(2, -1, 1e-6), Axes{}});
  taken.interfaces.push_back({{"low", "high"}, kStrength, kEnergy, 1});
  expect_refused(std::move(taken), InputFault::duplicate_name,
                 "volume \"interface-0\" has the name of the layer");
}

// Layers are thin: what lies close to each other is looked for in the mesh as it came.
TEST(BadInterface, HidesNoOtherFinding) {
  Scene scene = blocks();
  const Index node = grid_node({2, 2, 2, 2, 2, 2}, 2, 2, 2);
  std::vector<Index> copies(scene.mesh.nodes.size(), kNone);
  for (std::size_t e = 0; e < scene.mesh.tets.size(); ++e) {
    if (e % 12 >= 6) continue;  // every second cell gets nodes of its own, hardly apart
    for (Index& n : scene.mesh.tets[e]) {
      if (n == node) continue;
      if (copies[static_cast<std::size_t>(n)] == kNone) {
        copies[static_cast<std::size_t>(n)] = scene.mesh.node_count();
        scene.mesh.nodes.push_back(scene.mesh.nodes[static_cast<std::size_t>(n)] +
                                   Vec3(1e-5, 0, 0));
      }
      n = copies[static_cast<std::size_t>(n)];
    }
  }
  const Problem problem(scene);
  bool said = false;
  for (const std::string& w : problem.warnings()) {
    said = said || w.find("of faces lie on each other without being joined") != std::string::npos;
  }
  EXPECT_TRUE(said);
}

TEST(BadInterface, Volumes) {
  Scene unknown = blocks();
  unknown.interfaces[0].between[1] = "hihg";
  expect_refused(std::move(unknown), InputFault::unknown_name,
                 "names volume \"hihg\"; the mesh has \"low\", \"high\"");
  Scene same = blocks();
  same.interfaces[0].between[1] = "low";
  expect_refused(std::move(same), InputFault::out_of_range, "the same volume on both sides");
  Scene twice = blocks();
  twice.interfaces.push_back({{"high", "low"}, 1, 1, 1});
  expect_refused(std::move(twice), InputFault::duplicate_name, "lies where interface 0 does");
}

TEST(BadInterface, VolumesThatDoNotTouch) {
  Scene scene = body_of({2, 2, 3, 2, 2, 3}, [](const Vec3& x) {
    return x.z() < 1 ? "low" : x.z() < 2 ? "middle" : "high";
  });
  scene.supports.push_back({slab(2, -1, 1e-6), Axes{}});
  scene.interfaces.push_back({{"low", "high"}, kStrength, kEnergy, 1});
  expect_refused(std::move(scene), InputFault::empty_selection,
                 "lies nowhere: the two volumes share no face");
}

TEST(BadInterface, WhatDoesNotGoTogether) {
  Scene grows = blocks();
  grows.fracture.model = FractureModel::b;
  expect_refused(std::move(grows), InputFault::out_of_range, "does not go with model \"B\"");
  Scene mean = blocks();
  mean.fracture.averaging = 0.5;
  expect_refused(std::move(mean), InputFault::out_of_range, "does not go with fracture.averaging");
}

// In motion a layer has the density of the lighter side, so that it needs none of its own.
TEST(BadInterface, DensityIsAskedOfTheTissueAlone) {
  Scene scene = blocks();
  scene.dynamics = Dynamics{.time_step = 0.001};
  scene.materials["high"].density = 3e-9;
  const Problem problem(scene);
  EXPECT_EQ(problem.material(problem.tet_count() - 1).density, 1e-9);
  scene.materials["low"].density.reset();
  expect_refused(std::move(scene), InputFault::missing_key, "material \"low\" has no density");
}

}  // namespace
}  // namespace sunder::test
