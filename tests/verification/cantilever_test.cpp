// SPDX-License-Identifier: Apache-2.0
// Cantilever 10 x 1 x 1 under end shear against Timoshenko: P L^3/(3 E I) + P L/(k G A), k = 5/6,
// E 5, nu 0, P 1e-3 gives 0.8 + 0.0048. Cubes cut into six tetrahedra (Kuhn).
#include <gtest/gtest.h>

#include "support/body.hpp"
#include "support/structured_board.hpp"
#include "support/traction.hpp"

namespace sunder::test {
namespace {

constexpr double kTimoshenko = 0.8048;  // [mm]

double mean_end_deflection(Index cells, int axis) {
  const BoardShape shape{10 * cells, cells, cells, 10, 1, 1};
  Scene scene;
  scene.mesh = structured_board(shape);
  scene.materials["board"] = {5, 0, std::nullopt};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-9, 2, 2)}, Axes{7}});
  const Body body(std::move(scene), Needs{});
  const Mesh& mesh = body.problem->mesh();
  const auto at_end = [](const Vec3& x) { return x.x() > 10 - 1e-9; };
  const auto force =
      traction_force(mesh, at_end, [&](const Vec3&) { return Vec3(1e-3 * Vec3::Unit(axis)); });
  body.load(force);
  body.backend->solve();
  const auto u = body.displacement();
  double sum = 0;
  Index count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (!at_end(mesh.nodes[n])) continue;
    sum += u[3 * n + static_cast<std::size_t>(axis)];
    ++count;
  }
  return sum / count;
}

// Published deviations of correct linear tetrahedra, in percent; 0.3 points leave room for the
// choice of end point.
TEST(Cantilever, DeviatesFromTimoshenkoAsLinearTetrahedraDo) {
  const std::pair<Index, double> published[] = {{2, -45}, {4, -17.6}, {6, -8.7}};
  for (const auto& [cells, percent] : published) {
    for (int axis : {1, 2}) {
      const double deviation = 100 * (mean_end_deflection(cells, axis) / kTimoshenko - 1);
      EXPECT_NEAR(deviation, percent, 0.3) << 60 * cells * cells * cells << " tets, axis " << axis;
    }
  }
}

}  // namespace
}  // namespace sunder::test
