// SPDX-License-Identifier: Apache-2.0
// Where split cracks go: by the largest tangential stress a hole beside the path draws a crack
// near that has come to it, a stiff inclusion drives it away. (Farther off both do a little of the
// opposite: tension gives way to a hole and gathers at what is stiff.)
#include "fracture/field_sif/tangential_stress.hpp"
#include "measured_split.hpp"

namespace sunder {
namespace {

using test::kFar;

constexpr double kSide = 40;
const Vec2 kMiddle(20, 26);  // of what lies beside the path, which begins at y = 20
constexpr double kRadius = 4.6;

bool beside(const Vec3& x) { return (Vec2(x.x(), x.y()) - kMiddle).norm() < kRadius; }

/// Without the elements of one volume, and the nodes that only they have.
Mesh without(const Mesh& mesh, Index volume) {
  Mesh left;
  left.volumes = {mesh.volumes[static_cast<std::size_t>(1 - volume)]};
  std::vector<Index> place(mesh.nodes.size(), kNone);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    if (mesh.volume_of[e] == volume) continue;
    auto tet = mesh.tets[e];
    for (Index& n : tet) {
      Index& at = place[static_cast<std::size_t>(n)];
      if (at == kNone) {
        at = left.node_count();
        left.nodes.push_back(mesh.nodes[static_cast<std::size_t>(n)]);
      }
      n = at;
    }
    left.tets.push_back(tet);
    left.volume_of.push_back(0);
  }
  return left;
}

/// Elements whose centroid lies beside the path make a volume of their own.
void name_inclusion(Mesh& mesh) {
  mesh.volumes.push_back({"inclusion", 2});
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    Vec3 middle = Vec3::Zero();
    for (Index n : mesh.tets[e]) middle += mesh.nodes[static_cast<std::size_t>(n)] / 4;
    if (beside(middle)) mesh.volume_of[e] = 1;
  }
}

enum class Beside { nothing, hole, inclusion };

/// Height of the tip above its beginning where it has passed `x`, or as far as it has come.
double turned_to(Beside what, double x) {
  // By itself the crack's plane is a mirror.
  Mesh mesh =
      test::with_image(test::structured_board({60, 30, 1, kSide, kSide / 2, 1}), 1, kSide / 2);
  if (what != Beside::nothing) name_inclusion(mesh);
  if (what == Beside::hole) mesh = without(mesh, 1);
  Scene scene = test::plane_strain_plate(std::move(mesh), 0.3);
  if (what == Beside::inclusion) scene.materials["inclusion"] = {20.0, 0.3, std::nullopt};
  const auto corner = [](double y) {
    return Box{Vec3(kSide - 1e-9, y - 1e-9, -kFar), Vec3(kFar, y + 1e-9, kFar)};
  };
  scene.supports.push_back({corner(0), Axes{3}});
  scene.supports.push_back({corner(kSide), Axes{1}});
  test::MeasuredSplit plate(std::move(scene));
  plate.load(test::traction_of(
      plate.problem().mesh(), [](const Vec3& at) { return at.y() < 1e-9 || at.y() > kSide - 1e-9; },
      [](const Vec3&) { return Mat3(Vec3(0, 1, 0).asDiagonal()); }));
  test::EdgeSplit& crack = plate.crack();
  plate.follow(crack.begin(0));
  while (crack.tip().x() < x) {
    const auto k = plate.measure().k;
    const auto step = crack.advance(fracture::tangential_angle(k.k_1, k.k_2));
    if (!step.moved()) break;
    plate.follow(step);
    if (step.through) break;
  }
  return crack.tip().y() - kSide / 2;
}

TEST(SplitPaths, AHoleDrawsACrackNearAStiffInclusionDrivesItAway) {
  const double alone = turned_to(Beside::nothing, 22);
  const double hole = turned_to(Beside::hole, 22);
  const double inclusion = turned_to(Beside::inclusion, 22);
  constexpr double kCell = kSide / 60;
  EXPECT_NEAR(alone, 0, 1e-6);
  EXPECT_GT(hole, 1.5 * kCell);  // fronts lie on nodes
  EXPECT_LT(inclusion, -1.5 * kCell);
}

}  // namespace
}  // namespace sunder
