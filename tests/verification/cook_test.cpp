// SPDX-License-Identifier: Apache-2.0
// Cook's membrane: a tapered panel, clamped at x = 0, sheared at x = 48. One layer of cells of
// thickness 1, each cut into six tetrahedra (Kuhn): the diagonals run from the lower left to the
// upper right corner. The other diagonal gives -4.1 % instead of -13.4 % on 16 x 16.
#include <gtest/gtest.h>

#include "support/body.hpp"
#include "support/structured_board.hpp"
#include "support/traction.hpp"

namespace sunder::test {
namespace {

enum class Plane { strain, stress };

Mesh membrane(Index cells) {
  Mesh mesh = structured_board({cells, cells, 1, 48, 44, 1});
  for (Vec3& x : mesh.nodes) {
    const double xi = x.x() / 48, eta = x.y() / 44;
    x.y() = 44 * xi + (44 - 28 * xi) * eta;  // from (0, 44) at the left to (44, 60) at the right
  }
  return mesh;
}

void hold(Scene& scene, Plane plane) {
  const auto column = [](double x, double low, double high) {
    return Box{Vec3(x - 1e-6, low - 1e-6, -1), Vec3(x + 1e-6, high + 1e-6, 1e-6)};
  };
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 100, 2)}, Axes{3}});
  if (plane == Plane::strain) {
    scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(100, 100, 2)}, Axes{4}});
    return;
  }
  // Free to change its thickness: z is held at three nodes only.
  scene.supports.push_back({column(0, 0, 0), Axes{4}});
  scene.supports.push_back({column(0, 44, 44), Axes{4}});
  scene.supports.push_back({column(48, 60, 60), Axes{4}});
}

/// Vertical displacement at (48, y), mean over the thickness.
double deflection(Plane plane, Index cells, const Material& material, double load, double y) {
  Scene scene;
  scene.mesh = membrane(cells);
  scene.materials["board"] = material;
  hold(scene, plane);
  const Body body(std::move(scene), Needs{});
  const Mesh& mesh = body.problem->mesh();
  body.load(traction_force(
      mesh, [](const Vec3& x) { return x.x() > 48 - 1e-6; },
      [&](const Vec3&) { return Vec3(0, load, 0); }));
  body.backend->solve();
  const auto u = body.displacement();
  double sum = 0;
  int count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3& x = mesh.nodes[n];
    if (std::abs(x.x() - 48) > 1e-6 || std::abs(x.y() - y) > 1e-6) continue;
    sum += u[3 * n + 1];
    ++count;
  }
  EXPECT_EQ(count, 2);
  return sum / count;
}

// Reference values 32.27 (plane strain, E 70, nu 1/3, shear 6.25 per unit area) at (48, 60) and
// 23.96 (plane stress, E 1, nu 1/3, total force 1) at (48, 52); published deviations in percent.
TEST(Cook, PlaneStrainDeviatesAsLinearTetrahedraDo) {
  const std::pair<Index, double> published[] = {{16, -13.4}, {32, -4.8}, {64, -1.7}, {96, -0.9}};
  for (const auto& [cells, percent] : published) {
    const double v = deflection(Plane::strain, cells, {70, 1.0 / 3, std::nullopt}, 6.25, 60);
    EXPECT_NEAR(100 * (v / 32.27 - 1), percent, 0.3) << cells << " x " << cells;
  }
}

TEST(Cook, PlaneStressDeviatesAsLinearTetrahedraDo) {
  const std::pair<Index, double> published[] = {{16, -11.5}, {32, -3.3}, {64, -0.9}};
  for (const auto& [cells, percent] : published) {
    const double v = deflection(Plane::stress, cells, {1, 1.0 / 3, std::nullopt}, 1.0 / 16, 52);
    EXPECT_NEAR(100 * (v / 23.96 - 1), percent, 0.3) << cells << " x " << cells;
  }
}

}  // namespace
}  // namespace sunder::test
