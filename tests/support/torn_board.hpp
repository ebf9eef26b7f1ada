// SPDX-License-Identifier: Apache-2.0
// The notch board torn by its criterion, step after step.
#pragma once

#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "support/notch_board.hpp"

namespace sunder::test {

struct TornBoard {
  std::vector<DestroyedElement> elements;
  std::vector<Voigt> stress;
  std::vector<Vec3> displacement;
  PreparationReport preparation;
};

/// Until so many elements are destroyed, or its last step.
inline TornBoard torn_board(FractureModel model, const SolverOptions& solver, std::size_t count) {
  Scene scene = notch_board(model);
  scene.solver = solver;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!simulation.done() && simulation.destroyed().size() < count) simulation.step();
  return {simulation.destroyed(), simulation.stress(), simulation.displacement(),
          simulation.backend().preparation()};
}

}  // namespace sunder::test
