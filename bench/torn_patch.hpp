// SPDX-License-Identifier: Apache-2.0
// A board of 50 x 50 x 2.5 mm, one layer of cells, of which only a patch can tear, at the middle of
// its right edge: the scene of route `condensed`.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sunder/problem.hpp"
#include "support/structured_board.hpp"

namespace sunder::bench {

constexpr Index kPatch = 12;  // cells along an edge of the patch: about 1,000 unknowns

/// Pulled at the lower right corner.
inline Scene patch_scene(Index cells, Index patch = kPatch) {
  const double h = 50.0 / cells, edge = h * static_cast<double>(patch);
  Scene scene;
  scene.mesh = test::structured_board({cells, cells, 1, 50, 50, 2.5}, [edge](const Vec3& x) {
    return x.x() > 50 - edge && std::abs(x.y() - 25) < 0.5 * edge ? "patch" : "organ";
  });
  scene.materials = {{"patch", {5, 0.4, 2.0}}, {"organ", {5, 0.4, std::nullopt}}};
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
  Instrument forceps;
  forceps.name = "forceps";
  forceps.action = Pull{Box{Vec3(49.999, -0.001, -1), Vec3(50.001, 0.001, 4)}, Vec3(0, -60, 0)};
  scene.instruments.push_back(forceps);
  return scene;
}

/// Elements of a volume, row by row from its middle, from the right edge inwards.
inline std::vector<Index> tear_of(const Problem& problem, std::string_view volume) {
  const Mesh& mesh = problem.mesh();
  std::vector<std::pair<std::pair<double, double>, Index>> keys;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (mesh.volumes[mesh.volume_of[e]].name != volume) continue;
    Vec3 c = Vec3::Zero();
    for (Index n : mesh.tets[e]) c += mesh.nodes[n] / 4;
    keys.push_back({{std::round(std::abs(c.y() - 25.01)), -c.x()}, e});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Index> order;
  for (const auto& k : keys) order.push_back(k.second);
  return order;
}

inline std::vector<Index> patch_tear(const Problem& problem) { return tear_of(problem, "patch"); }

/// What comes after the middle row of the patch: not one of its elements can break by itself.
inline std::vector<Index> tear_beyond_patch(const Problem& problem) {
  return tear_of(problem, "organ");
}

class TornPatch {
 public:
  TornPatch(Index cells, Route route)
      : problem(std::make_shared<Problem>(scene(cells, route))), order_(patch_tear(*problem)) {
    for (Index n : problem->instrument_nodes()[0].nodes) {
      load_dofs.push_back(problem->dof(n, 1));
      load_values.push_back(-30);
    }
  }

  /// The first k elements of the tear.
  [[nodiscard]] std::span<const Index> connected(std::size_t k) const {
    return std::span(order_).first(k);
  }

  std::shared_ptr<const Problem> problem;
  std::vector<Index> load_dofs;
  std::vector<double> load_values;

 private:
  static Scene scene(Index cells, Route route) {
    Scene scene = patch_scene(cells);
    scene.solver.route = route;
    return scene;
  }

  std::vector<Index> order_;
};

}  // namespace sunder::bench
