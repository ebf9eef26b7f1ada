// SPDX-License-Identifier: Apache-2.0
// scenes/finite/skin-wounds.toml: one sheet of skin, one wound across its fibres and one along
// them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "app/input/scene_toml.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

constexpr double kHalf = 8, kMiddle = 40;  // half a wound's length, how far its middle is off [mm]
constexpr double kLip = 0.02;              // thicker than the interface's layer [mm]

struct Gapes {
  double along_x = 0;  ///< of the cut along y, which opens along x
  double along_y = 0;  ///< of the one along x
};

/// How far apart the lips of a cut are, at most: nodes of both at one place of the undeformed body.
double gape(const Mesh& mesh, const std::vector<Vec3>& u, double middle, int along, int across) {
  std::vector<Index> lips;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    Vec3 x = mesh.nodes[n];
    x.x() -= middle;
    if (std::abs(x[across]) < kLip && std::abs(x[along]) < kHalf) lips.push_back(n);
  }
  double most = 0;
  for (Index a : lips) {
    for (Index b : lips) {
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      if ((mesh.nodes[a] - mesh.nodes[b]).norm() < 2 * kLip)
        most = std::max(most, std::abs(u[i][across] - u[j][across]));
    }
  }
  return most;
}

/// The scene in two steps: stretched, with the cuts already made in the second one.
Gapes wounds(std::vector<std::string> changes) {
  changes.push_back("time.steps=2");
  for (int cut = 0; cut < 6; ++cut) changes.push_back("destroy." + std::to_string(cut) + ".step=1");
  const auto problem = app::read_problem(SUNDER_SOURCE "/scenes/finite/skin-wounds.toml", changes);
  Simulation run(problem, std::move(create_backend(problem, needs_of(*problem)).backend));
  while (!run.done()) run.step();
  const auto& u = run.displacement();
  // The blade takes the layer between the lips, all of it and nothing else.
  std::size_t layer = 0;
  for (Index e = 0; e < problem->tet_count(); ++e) {
    const auto volume = static_cast<std::size_t>(problem->mesh().volume_of[e]);
    layer += problem->mesh().volumes[volume].name == "interface-0";
  }
  EXPECT_EQ(run.destroyed().size(), layer);
  for (const DestroyedElement& gone : run.destroyed()) {
    const auto volume = static_cast<std::size_t>(problem->mesh().volume_of[gone.element]);
    EXPECT_EQ(problem->mesh().volumes[volume].name, "interface-0");
  }
  return {gape(problem->mesh(), u, -kMiddle, 1, 0), gape(problem->mesh(), u, kMiddle, 0, 1)};
}

std::vector<std::string> fibres(const std::string& key, const std::string& value) {
  std::vector<std::string> changes;
  for (const char* volume : {"skin", "left", "right"})
    changes.push_back(std::string("material.") + volume + ".fibres." + key + "=" + value);
  return changes;
}

TEST(SkinWounds, GapeMoreAcrossTheFibresThanAlongThem) {
  const Gapes found = wounds({});
  std::printf("across the fibres %.2f mm, along them %.2f mm\n", found.along_x, found.along_y);
  EXPECT_GT(found.along_x, 1.5 * found.along_y);
  // The same two cuts, fibres the other way: what was across them is along them now.
  const Gapes turned = wounds(fibres("direction", "[0,1,0]"));
  std::printf("fibres along y: %.2f mm, %.2f mm\n", turned.along_y, turned.along_x);
  EXPECT_GT(turned.along_y, 1.5 * turned.along_x);
}

TEST(SkinWounds, DifferMoreTheStifferTheFibresAre) {
  double before = 1;
  for (const char* k1 : {"1", "10"}) {
    const Gapes found = wounds(fibres("k1", k1));
    const double ratio = found.along_x / found.along_y;
    std::printf("k1 %s MPa: across the fibres %.2f mm, along them %.2f mm\n", k1, found.along_x,
                found.along_y);
    EXPECT_GT(ratio, 1.2 * before);
    before = ratio;
  }
}

// A cut of length 2a in a large sheet of one modulus, under the stress s, opens by 4 s a/E in its
// middle (Tada, Paris and Irwin, The Stress Analysis of Cracks Handbook). One between linear
// tetrahedra is as one that ends half an edge earlier (method.md "Split cracks", nu .45), and hands
// at five times its length hold the sheet: together 10 %.
TEST(SkinWounds, WithoutFibresGapeAsCracksInASheet) {
  constexpr double kStrain = 0.005, kPoisson = 0.45, kEdge = 1;
  std::vector<std::string> changes = fibres("k1", "1e-9");
  const char* const pulls[] = {"[-0.4,0,0]", "[0.4,0,0]", "[0,-0.2,0]", "[0,0.2,0]"};
  for (int i = 0; i < 4; ++i)
    changes.push_back("instrument." + std::to_string(i) + ".displacement=" + pulls[i]);
  const Gapes found = wounds(changes);
  const double theory = 4 * (kHalf - 0.51 * kEdge) * kStrain / (1 - kPoisson);
  std::printf("without fibres: %.4f mm, %.4f mm, in a large sheet %.4f mm\n", found.along_x,
              found.along_y, theory);
  EXPECT_NEAR(found.along_y / theory, 1, 0.1);
  EXPECT_NEAR(found.along_x / theory, 1, 0.1);
  EXPECT_NEAR(found.along_x / found.along_y, 1, 0.05);  // the meshes of the two differ
}

}  // namespace
}  // namespace sunder::test
