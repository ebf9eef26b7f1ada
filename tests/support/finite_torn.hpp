// SPDX-License-Identifier: Apache-2.0
// The paper's board under finite statics, as it is pulled and torn without a scene.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "material/finite_stress.hpp"
#include "solver/finite_statics.hpp"
#include "support/loads.hpp"

namespace sunder::test {

struct FiniteTorn {
  explicit FiniteTorn(const Law& law, solver::FiniteStaticsOptions options = {},
                      Scene scene = held_board())
      : problem(std::move(scene)),
        laws(fem::one_law(problem, law)),
        destroyed(problem.mesh().tets.size(), 0),
        statics(body, options) {}
  [[nodiscard]] Load load(double force) const { return corner_pull(problem, Vec3(0, -force, 0)); }
  solver::FiniteStaticsReport pull(double force) { return statics.solve(load(force)); }
  void tear(std::span<const Index> elements) {
    for (Index e : elements) destroyed[e] = 1;
    statics.destroyed(elements);
  }
  void take_back(std::span<const Index> elements) {
    for (Index e : elements) destroyed[e] = 0;
    statics.body_changed();
  }
  /// Of destroyed elements and of those that hang on nothing 0.
  [[nodiscard]] std::vector<Voigt> stress(std::span<const double> u) const {
    std::vector<Voigt> of(destroyed.size());
    fem::element_stresses({problem, laws, statics.out()}, u, cauchy_stress, of);
    return of;
  }

  Problem problem;
  std::vector<const Law*> laws;
  std::vector<std::uint8_t> destroyed;
  fem::HyperelasticBody body{problem, laws, destroyed};
  solver::FiniteStatics statics;
};

}  // namespace sunder::test
