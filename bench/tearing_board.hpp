// SPDX-License-Identifier: Apache-2.0
// The board of the engine's benchmarks: 50 x 50 x 2.5 mm, one layer of cells of six tetrahedra,
// held at the top, pulled at the lower right corner, torn from the middle of its right edge. A
// block is the same with another depth.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "body/event_factor.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/problem.hpp"
#include "support/structured_board.hpp"

namespace sunder::bench {

class TearingBoard {
 public:
  explicit TearingBoard(Index cells) : TearingBoard({cells, cells, 1, 50, 50, 2.5}) {}
  explicit TearingBoard(const test::BoardShape& shape)
      : problem(std::make_shared<Problem>(scene(shape))) {
    for (Index n = 0; n < problem->node_count(); ++n) {
      const Vec3& x = problem->mesh().nodes[n];
      if (x.x() > 49.99 && x.y() < 0.01) load_dofs.push_back(problem->dof(n, 1));
    }
    load_values.assign(load_dofs.size(), -60.0 / static_cast<double>(load_dofs.size()));
    find_order();
  }

  /// The first k elements of a growing tear: each shares a node with those before it.
  [[nodiscard]] std::span<const Index> connected(std::size_t k) const {
    return std::span(order_).first(k);
  }

  static Scene scene(const test::BoardShape& shape) {
    Scene scene;
    scene.mesh = test::structured_board(shape, [](const Vec3& x) {
      return x.y() > 45 ? "top-frame" : x.y() < 5 ? "bottom-frame" : x.y() > 25 ? "upper" : "lower";
    });
    scene.materials = {{"upper", {5, 0.4, 2.0}},
                       {"lower", {8, 0.4, 4.0}},
                       {"top-frame", {500, 0.4, std::nullopt}},
                       {"bottom-frame", {500, 0.4, std::nullopt}}};
    scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 51)}, Axes{7}});
    return scene;
  }

  std::shared_ptr<const Problem> problem;
  std::vector<Index> load_dofs;
  std::vector<double> load_values;

 private:
  // A tear goes along the row at mid-height first, then its neighbours.
  void find_order() {
    const Mesh& mesh = problem->mesh();
    const auto key = [&](Index e) {
      Vec3 c = Vec3::Zero();
      for (Index n : mesh.tets[e]) c += mesh.nodes[n] / 4;
      const double row = std::floor(std::abs(c.y() - 25.01) / 1.5);
      return std::pair(c.x() < 12 ? 1e3 : row, -c.x());
    };
    std::vector<std::pair<std::pair<double, double>, Index>> keys;
    for (Index e = 0; e < problem->tet_count(); ++e) {
      if (problem->breakable(e)) keys.emplace_back(key(e), e);
    }
    std::sort(keys.begin(), keys.end());
    for (const auto& k : keys) order_.push_back(k.second);
  }

  std::vector<Index> order_;
};

}  // namespace sunder::bench
